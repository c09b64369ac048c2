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
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "base/state_parts.hpp"

/// The layout of a state: the types of its numbers in their order. Where it changes, and the
/// version of the format does not, a state would be misread.
namespace posemix::internal {

/// Appends a word for every part of a type.
class LayoutWriter {
 public:
  template <class T>
  static std::string of() {
    LayoutWriter writer;
    writer.add(std::type_identity<T>());
    return std::move(writer.text_);
  }

 private:
  template <StateNumber T>
  void add(std::type_identity<T> /*type*/) {
    if constexpr (std::is_enum_v<T>) {
      text_ += 'e';
    } else if constexpr (std::is_same_v<T, bool>) {
      text_ += 'b';
    } else {
      text_ += std::is_integral_v<T> ? 'i' : 'd';
    }
  }
  template <TiedState T>
  void add(std::type_identity<T> /*type*/) {
    add_parts('{', std::type_identity<decltype(StateFields<T>::tie(std::declval<T&>()))>(), '}');
  }
  template <ConvertedState T>
  void add(std::type_identity<T> /*type*/) {
    add(std::type_identity<typename StateFields<T>::Stored>());
  }
  template <StateMatrix T>
  void add(std::type_identity<T> /*type*/) {
    text_ += fmt::format("m{},{}", int{T::RowsAtCompileTime}, int{T::ColsAtCompileTime});
    add(std::type_identity<typename T::Scalar>());
  }
  void add(std::type_identity<std::string> /*type*/) { text_ += 's'; }
  template <class T>
  void add(std::type_identity<std::optional<T>> /*type*/) {
    add_parts('?', std::type_identity<std::tuple<T>>(), ' ');
  }
  template <class T>
  void add(std::type_identity<std::shared_ptr<const T>> /*type*/) {
    add_parts('*', std::type_identity<std::tuple<T>>(), ' ');
  }
  template <class T>
  void add(std::type_identity<std::unique_ptr<T>> /*type*/) {
    add(std::type_identity<T>());
  }
  template <class A, class B>
  void add(std::type_identity<std::pair<A, B>> /*type*/) {
    add_parts('(', std::type_identity<std::tuple<A, B>>(), ')');
  }
  template <class... T>
  void add(std::type_identity<std::variant<T...>> /*type*/) {
    add_parts('<', std::type_identity<std::tuple<T...>>(), '>');
  }
  template <class T, class Allocator>
  void add(std::type_identity<std::vector<T, Allocator>> /*type*/) {
    add_parts('[', std::type_identity<std::tuple<T>>(), ']');
  }
  template <class T>
  void add(std::type_identity<std::deque<T>> /*type*/) {
    add_parts('[', std::type_identity<std::tuple<T>>(), ']');
  }
  template <class T>
  void add(std::type_identity<std::set<T>> /*type*/) {
    add_parts('[', std::type_identity<std::tuple<T>>(), ']');
  }
  template <class K, class T, class Less>
  void add(std::type_identity<std::map<K, T, Less>> /*type*/) {
    add_parts('[', std::type_identity<std::tuple<K, T>>(), ']');
  }
  template <class... T>
  void add_parts(char open, std::type_identity<std::tuple<T...>> /*parts*/, char close) {
    text_ += open;
    (add(std::type_identity<std::remove_cvref_t<T>>()), ...);
    text_ += close;
  }

  std::string text_;
};

}  // namespace posemix::internal
