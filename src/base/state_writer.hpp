// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <unordered_map>
#include <utility>
#include <variant>
#include <vector>

#include "base/state_parts.hpp"

namespace posemix::internal {

/// Writes a state. What is shared by pointers is written once.
class StateWriter {
 public:
  template <class... T>
  void operator()(const T&... parts) {
    (write(parts), ...);
  }
  std::string take() && { return std::move(bytes_); }

 private:
  template <StateNumber T>
  void write(const T& x) {
    if constexpr (std::is_enum_v<T> || (std::is_integral_v<T> && sizeof(T) > 1)) {
      append(static_cast<std::uint64_t>(x));
    } else {
      append(x);
    }
  }
  template <TiedState T>
  void write(const T& x) {
    std::apply(*this, StateFields<T>::tie(x));
  }
  template <ConvertedState T>
  void write(const T& x) {
    write(typename StateFields<T>::Stored(StateFields<T>::to_stored(x)));
  }
  template <StateMatrix T>
  void write(const T& x) {
    append(static_cast<std::uint64_t>(x.rows()));
    append(static_cast<std::uint64_t>(x.cols()));
    for (Eigen::Index j = 0; j < x.cols(); ++j)
      for (Eigen::Index i = 0; i < x.rows(); ++i) append(x(i, j));
  }
  void write(const std::string& x) {
    append(static_cast<std::uint64_t>(x.size()));
    bytes_ += x;
  }
  template <class T>
  void write(const std::optional<T>& x) {
    write(x.has_value());
    if (x) write(*x);
  }
  template <class T>
  void write(const std::shared_ptr<const T>& x) {
    if (!x) return append(std::uint64_t{0});
    const auto [known, is_new] = shared_.try_emplace(x.get(), shared_.size() + 1);
    append(static_cast<std::uint64_t>(known->second));
    if (is_new) write(*x);
  }
  template <class T>
  void write(const std::unique_ptr<T>& x) {
    require(x != nullptr, "the filter was moved from, expected one with a state");
    write(*x);
  }
  template <class A, class B>
  void write(const std::pair<A, B>& x) {
    write(x.first);
    write(x.second);
  }
  template <class... T>
  void write(const std::variant<T...>& x) {
    append(static_cast<std::uint64_t>(x.index()));
    std::visit([&](const auto& held) { this->write(held); }, x);
  }
  void write(const std::vector<bool>& x) {
    append(static_cast<std::uint64_t>(x.size()));
    for (const bool one : x) write(one);
  }
  template <class T, class Allocator>
  void write(const std::vector<T, Allocator>& x) {
    write_all(x);
  }
  template <class T>
  void write(const std::deque<T>& x) {
    write_all(x);
  }
  template <class T>
  void write(const std::set<T>& x) {
    write_all(x);
  }
  template <class K, class T, class Less>
  void write(const std::map<K, T, Less>& x) {
    write_all(x);
  }
  void write_all(const auto& x) {
    append(static_cast<std::uint64_t>(x.size()));
    for (const auto& one : x) write(one);
  }
  template <class T>
  void append(const T& number) {
    const auto bytes = bytes_of(number);
    bytes_.append(bytes.data(), bytes.size());
  }

  std::string bytes_;
  std::unordered_map<const void*, std::size_t> shared_;
};

}  // namespace posemix::internal
