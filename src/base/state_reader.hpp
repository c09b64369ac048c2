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
#include <typeinfo>
#include <utility>
#include <variant>
#include <vector>

#include "base/state_parts.hpp"

namespace posemix::internal {

/// Reads a state. No number in it makes it take more memory than in proportion to the bytes that
/// there are.
class StateReader {
 public:
  explicit StateReader(std::string_view bytes) : bytes_(bytes) {}

  template <class... T>
  void operator()(T&... parts) {
    (read(parts), ...);
  }
  template <class T>
  T take() {
    T x = blank_state<T>();
    read(x);
    return x;
  }
  /// @throws InvalidInput when something is left
  void finish() const {
    if (!bytes_.empty())
      refuse_state(fmt::format("{} bytes are left, expected none", bytes_.size()));
  }

 private:
  template <StateNumber T>
  void read(T& x) {
    if constexpr (std::is_enum_v<T>) {
      const auto value = next<std::uint64_t>();
      x = static_cast<T>(value);
      if (!(value < 256 && is_known(x)))
        refuse_state(fmt::format("{} is no value of the choice that is expected", value));
    } else if constexpr (std::same_as<T, bool>) {
      const auto value = next<std::uint8_t>();
      if (value > 1) refuse_state(fmt::format("found {}, expected a 0 or a 1", value));
      x = value == 1;
    } else if constexpr (std::is_integral_v<T> && sizeof(T) > 1) {
      x = static_cast<T>(next<std::uint64_t>());
    } else {
      x = next<T>();
    }
  }
  template <TiedState T>
  void read(T& x) {
    std::apply(*this, StateFields<T>::tie(x));
    if constexpr (requires { StateFields<T>::validate(x); }) StateFields<T>::validate(x);
  }
  template <ConvertedState T>
  void read(T& x) {
    x = StateFields<T>::of_stored(take<typename StateFields<T>::Stored>());
  }
  template <StateMatrix T>
  void read(T& x) {
    const auto rows = next<std::uint64_t>();
    const auto columns = next<std::uint64_t>();
    const auto fits = [](std::uint64_t size, int fixed, int most) {
      return (fixed == Eigen::Dynamic || size == static_cast<std::uint64_t>(fixed)) &&
             (most == Eigen::Dynamic || size <= static_cast<std::uint64_t>(most));
    };
    const std::size_t most = bytes_.size() / sizeof(typename T::Scalar);
    if (!fits(rows, T::RowsAtCompileTime, T::MaxRowsAtCompileTime) ||
        !fits(columns, T::ColsAtCompileTime, T::MaxColsAtCompileTime) ||
        (rows > 0 && columns > most / rows) || rows > bytes_.size() || columns > bytes_.size()) {
      refuse_state(fmt::format("a matrix of {} x {} does not fit", rows, columns));
    }
    x.resize(static_cast<Eigen::Index>(rows), static_cast<Eigen::Index>(columns));
    for (Eigen::Index j = 0; j < x.cols(); ++j)
      for (Eigen::Index i = 0; i < x.rows(); ++i) x(i, j) = next<typename T::Scalar>();
  }
  void read(std::string& x) { x = part(count()); }
  template <class T>
  void read(std::optional<T>& x) {
    bool has_value = false;
    read(has_value);
    x.reset();
    if (has_value) x.emplace(take<T>());
  }
  template <class T>
  void read(std::shared_ptr<const T>& x) {
    const auto number = next<std::uint64_t>();
    if (number > shared_.size() + 1) refuse_state("a reference to what comes later");
    x.reset();
    if (number == 0) return;
    if (number == shared_.size() + 1) {
      // Its number comes before those of what it holds.
      shared_.emplace_back(nullptr, &typeid(T));
      x = std::make_shared<const T>(take<T>());
      shared_[number - 1].first = x;
      return;
    }
    const auto& [known, type] = shared_[number - 1];
    if (!known || *type != typeid(T)) refuse_state("a reference to something else");
    x = std::static_pointer_cast<const T>(known);
  }
  template <class T>
  void read(std::unique_ptr<T>& x) {
    x.reset(new T(blank_state<T>()));  // which may be one that cannot be moved
    read(*x);
  }
  template <class A, class B>
  void read(std::pair<A, B>& x) {
    read(x.first);
    read(x.second);
  }
  template <class... T>
  void read(std::variant<T...>& x) {
    const auto index = next<std::uint64_t>();
    std::uint64_t k = 0;
    const bool is_one = ((index == k++ ? (x = take<T>(), true) : false) || ...);
    if (!is_one) refuse_state(fmt::format("{} is no kind that is expected", index));
  }
  void read(std::vector<bool>& x) {
    x.assign(count(), false);
    for (auto&& one : x) one = take<bool>();
  }
  template <class T, class Allocator>
  void read(std::vector<T, Allocator>& x) {
    x.clear();
    for (std::size_t n = count(); n > 0; --n) x.push_back(take<T>());
  }
  template <class T>
  void read(std::deque<T>& x) {
    x.clear();
    for (std::size_t n = count(); n > 0; --n) x.push_back(take<T>());
  }
  template <class T>
  void read(std::set<T>& x) {
    x.clear();
    for (std::size_t n = count(); n > 0; --n)
      if (!x.insert(take<T>()).second) refuse_state("a set holds a value twice");
  }
  template <class K, class T, class Less>
  void read(std::map<K, T, Less>& x) {
    x.clear();
    for (std::size_t n = count(); n > 0; --n) {
      K key = take<K>();
      if (!x.emplace(std::move(key), take<T>()).second) refuse_state("a map holds a key twice");
    }
  }

  /// Number of elements that follow, each of which has a byte at least.
  std::size_t count() {
    const auto n = next<std::uint64_t>();
    if (n > bytes_.size())
      refuse_state(
          fmt::format("{} elements are announced where {} bytes follow", n, bytes_.size()));
    return static_cast<std::size_t>(n);
  }
  template <class T>
  T next() {
    return number_of<T>(part(sizeof(T)));
  }
  std::string_view part(std::size_t size) {
    if (size > bytes_.size()) refuse_state("it ends too soon");
    const std::string_view begin = bytes_.substr(0, size);
    bytes_.remove_prefix(size);
    return begin;
  }
  template <class T>
  static bool is_known(T value) {
    if constexpr (Spelled<T>) {
      return !word_of(value).empty();
    } else {
      return StateFields<T>::is_value(value);
    }
  }

  std::string_view bytes_;
  std::vector<std::pair<std::shared_ptr<const void>, const std::type_info*>> shared_;
};

}  // namespace posemix::internal
