// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
//
// Calls a function with a bad value for each of its arguments in turn.
#pragma once

#include <cstddef>
#include <exception>
#include <functional>
#include <string>
#include <string_view>
#include <tuple>
#include <typeinfo>
#include <utility>
#include <vector>

#include "recordings.hpp"

namespace posemix::arguments {

/// A value of every parameter, by its number among their samples.
using SampleNumbers = std::vector<std::size_t>;

/// How a function is called.
struct Calls {
  SampleNumbers counts;                             ///< of samples
  std::vector<std::string (*)(std::size_t)> words;  ///< what a sample is
  std::function<void(const SampleNumbers&)> call;
};

/// A function of the listing.
struct Callee {
  std::string_view signature;
  std::function<std::optional<Calls>()> calls;  ///< none where a parameter has no samples

  Callee(std::string_view signature, std::function<std::optional<Calls>()> calls);
};

/// All of them.
std::vector<const Callee*>& callees();

/// What came of all calls of a function.
struct Outcome {
  bool is_called = true;
  /// Why the first arguments were refused, which are fine for others, and so were all that were
  /// tried in their place.
  std::string refuses_what_is_fine;
  std::vector<std::string> errors;  ///< what was neither refused as it should be nor done
};

/// Calls the function in processes of their own, which write into a folder: with arguments that it
/// takes, and with a bad one in place of each. A call of more than `seconds` is an error, unless it
/// `may_be_endless`.
Outcome outcome_of(const Callee& callee, const std::filesystem::path& folder, unsigned seconds,
                   bool may_be_endless);

template <class... P>
struct TypeList {};

/// How the value of a parameter is kept, and handed on.
template <class P>
struct Kept {
  using Value = std::remove_cvref_t<P>;
  static decltype(auto) pass(Value& value) {
    if constexpr (std::is_lvalue_reference_v<P>) {
      return static_cast<P>(value);
    } else {
      return std::move(value);
    }
  }
};
template <class T>
struct Kept<std::span<T>> {
  using Value = std::vector<std::remove_const_t<T>>;
  static std::span<T> pass(Value& value) { return value; }
};
template <>
struct Kept<std::string_view> {
  using Value = std::string;
  static std::string_view pass(Value& value) { return value; }
};
template <>
struct Kept<const char*> {
  using Value = std::string;
  static const char* pass(Value& value) { return value.c_str(); }
};
template <class T>
struct Kept<Eigen::Ref<T>> {
  using Value = T;
  static T& pass(Value& value) { return value; }
};
template <class T>
struct Kept<T*> {
  using Value = std::optional<std::remove_const_t<T>>;
  static T* pass(Value& value) { return value ? &*value : nullptr; }
};

template <class Call, class... P>
std::optional<Calls> calls_of(const Call& call, TypeList<P...>) {
  if constexpr ((Sampled<typename Kept<P>::Value> && ...)) {
    return Calls{.counts = {Samples<typename Kept<P>::Value>::count()...},
                 .words = {&word_of_sample<typename Kept<P>::Value>...},
                 .call = [call](const SampleNumbers& arguments) {
                   [&]<std::size_t... I>(std::index_sequence<I...>) {
                     std::tuple<typename Kept<P>::Value...> values{
                         Samples<typename Kept<P>::Value>::make(arguments[I])...};
                     call(Kept<P>::pass(std::get<I>(values))...);
                   }
                   (std::index_sequence_for<P...>{});
                 }};
  } else {
    return std::nullopt;
  }
}

template <class Class, class... P>
std::optional<Calls> constructor_calls() {
  return calls_of(
      [](auto&&... a) { [[maybe_unused]] const Class made(std::forward<decltype(a)>(a)...); },
      TypeList<P...>{});
}

}  // namespace posemix::arguments
