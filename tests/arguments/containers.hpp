// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
//
// Values of the containers of the standard library, of anything that has values.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "samples.hpp"

namespace posemix::arguments {

/// Sequences: three that are fine, none, one, twenty, and one bad one among three.
template <class T>
requires Sampled<T>
struct Samples<std::vector<T>> {
  static constexpr std::array<std::size_t, 4> kSizes{3, 0, 1, 20};
  static std::size_t count() { return kSizes.size() + Samples<T>::count() - 1; }
  static std::vector<T> make(std::size_t i) {
    std::vector<T> values;
    for (std::size_t k = 0; k < (i < kSizes.size() ? kSizes[i] : kSizes[0]); ++k)
      values.push_back(Samples<T>::make(k == 1 && i >= kSizes.size() ? i - kSizes.size() + 1 : 0));
    return values;
  }
  static std::string word(std::size_t i) {
    if (i < kSizes.size()) return std::to_string(kSizes[i]);
    return "three, of which one is " + word_of_sample<T>(i - kSizes.size() + 1);
  }
};

template <class T, std::size_t Size>
requires Sampled<T>
struct Samples<std::array<T, Size>> {
  static std::size_t count() { return Samples<T>::count(); }
  static std::array<T, Size> make(std::size_t i) {
    std::array<T, Size> values;
    values.fill(fine<T>());
    values.back() = Samples<T>::make(i);
    return values;
  }
};

template <class T>
requires Sampled<T>
struct Samples<std::optional<T>> {
  static std::size_t count() { return 1 + Samples<T>::count(); }
  static std::optional<T> make(std::size_t i) {
    if (i == 0) return std::nullopt;
    return std::optional<T>(Samples<T>::make(i - 1));
  }
  static std::string word(std::size_t i) { return i == 0 ? "empty" : word_of_sample<T>(i - 1); }
};

template <class T>
requires Sampled<std::remove_const_t<T>>
struct Samples<std::shared_ptr<T>> {
  using Value = std::remove_const_t<T>;
  static std::size_t count() { return Samples<Value>::count(); }
  static std::shared_ptr<T> make(std::size_t i) {
    return std::make_shared<Value>(Samples<Value>::make(i));
  }
};

template <class A, class B>
requires(Sampled<A>&& Sampled<B>) struct Samples<std::pair<A, B>> {
  static std::size_t count() { return Samples<A>::count() + Samples<B>::count() - 1; }
  static std::pair<A, B> make(std::size_t i) {
    const std::size_t first = Samples<A>::count();
    return i < first ? std::pair<A, B>(Samples<A>::make(i), fine<B>())
                     : std::pair<A, B>(fine<A>(), Samples<B>::make(i - first + 1));
  }
};

template <class K, class V>
requires Sampled<std::pair<K, V>>
struct Samples<std::map<K, V>> {
  using Pair = Samples<std::pair<K, V>>;
  static std::size_t count() { return 1 + Pair::count(); }
  static std::map<K, V> make(std::size_t i) {
    std::map<K, V> values;
    if (i != 1) values.insert(Pair::make(i == 0 ? 0 : i - 1));
    return values;
  }
};

/// All alternatives.
template <class... T>
requires(Sampled<T>&&...) struct Samples<std::variant<T...>> {
  static std::size_t count() { return (Samples<T>::count() + ...); }
  static std::variant<T...> make(std::size_t i) {
    std::optional<std::variant<T...>> value;
    const auto look = [&]<class A>() {
      if (value) return;
      if (i < Samples<A>::count()) {
        value = std::variant<T...>(Samples<A>::make(i));
      } else {
        i -= Samples<A>::count();
      }
    };
    (look.template operator()<T>(), ...);
    return *value;
  }
};

}  // namespace posemix::arguments
