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

#include "objects.hpp"

namespace posemix::arguments {

/// What came of the calls of a function.
struct Report {
  std::size_t first = 0;  ///< Calls before it are left out.
  std::size_t calls = 0;
  std::size_t returned = 0;
  std::size_t refused = 0;
  bool is_called = true;     ///< All of its arguments have values.
  std::string fine_message;  ///< Of the refusal of values that are fine.
  std::vector<std::string> errors;
  std::function<void(const std::string&)>
      begins;  ///< Called before every call, with what is bad in it.
};

/// A function of the listing and its calls.
struct Callee {
  std::string_view signature;
  std::function<void(Report&)> attack;

  Callee(std::string_view signature, std::function<void(Report&)> attack);
};

/// All of them.
std::vector<const Callee*>& callees();

/// What came of all calls of a function in processes of their own.
struct Outcome {
  std::size_t calls = 0;
  bool is_called = true;
  std::string refuses_what_is_fine;
  std::vector<std::string> errors;  ///< what was neither refused as it should be nor done
};

/// Calls the function in a folder, for what it writes. A call of more than `seconds` is an error,
/// unless it `may_be_endless`.
Outcome outcome_of(const Callee& callee, const std::string& folder, unsigned seconds,
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

std::string word_of(const std::exception& error);
bool is_refusal(const std::exception& error);

template <class Call, class... P>
void attack(Report& report, const Call& call, TypeList<P...>) {
  if constexpr ((Sampled<typename Kept<P>::Value> && ...)) {
    constexpr std::size_t kParameters = sizeof...(P);
    const std::array<std::size_t, kParameters> counts{Samples<typename Kept<P>::Value>::count()...};
    const auto run = [&](const std::array<std::size_t, kParameters>& chosen,
                         const std::string& what) {
      if (report.calls++ < report.first) return;
      if (report.begins) report.begins(what);
      try {
        [&]<std::size_t... I>(std::index_sequence<I...>) {
          std::tuple<typename Kept<P>::Value...> values{
              Samples<typename Kept<P>::Value>::make(chosen[I])...};
          call(Kept<P>::pass(std::get<I>(values))...);
        }
        (std::index_sequence_for<P...>{});
        ++report.returned;
      } catch (const std::exception& error) {
        if (is_refusal(error)) {
          ++report.refused;
          if (what == "fine") report.fine_message = error.what();
        } else {
          report.errors.push_back(what + ": " + word_of(error));
        }
      }
    };
    const std::array<std::string (*)(std::size_t), kParameters> words{
        &word_of_sample<typename Kept<P>::Value>...};
    std::array<std::size_t, kParameters> chosen{};
    run(chosen, "fine");
    for (std::size_t p = 0; p < kParameters; ++p) {
      for (std::size_t i = 1; i < counts[p]; ++i) {
        chosen[p] = i;
        run(chosen, fmt::format("argument {}: {}", p + 1, words[p](i)));
      }
      chosen[p] = 0;
    }
  } else {
    report.is_called = false;
  }
}

template <class Class, class... P>
void attack_constructor(Report& report) {
  attack(
      report,
      [](auto&&... a) { [[maybe_unused]] const Class made(std::forward<decltype(a)>(a)...); },
      TypeList<P...>{});
}

}  // namespace posemix::arguments
