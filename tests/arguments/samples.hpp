// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
//
// Values of every type that the public interface takes: one that is fine, and those that nobody
// should give. Samples<T> has `count()` of them, and `make(i)` makes one; the first is fine.
// Structs are taken apart field by field (generate.py).
#pragma once

#include <array>
#include <concepts>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>

#include <fmt/format.h>
#include <Eigen/Core>

namespace posemix::arguments {

template <class T>
struct Samples;

/// The fields of a struct, as pointers to members.
template <class T>
struct Fields;

/// Names a type for the overloads of `good`.
template <class T>
struct Type {};

/// A value that is fine where the default constructor makes none: `T good(Type<T>)`.
template <class T>
T good() {
  return good(Type<T>());
}

/// What `make` makes, which takes its time, made once.
template <class Make>
auto once(const Make& make) {
  static const auto kept = make();
  return kept;
}

template <class T>
concept Sampled = requires {
  { Samples<T>::count() } -> std::convertible_to<std::size_t>;
};

template <class T>
concept HasGood = requires {
  good(Type<T>());
};

template <class T>
concept HasFields = requires {
  Fields<T>::all();
};

/// What the value `i` is, for messages.
template <class T>
std::string word_of_sample(std::size_t i) {
  if constexpr (requires { Samples<T>::word(i); }) {
    return Samples<T>::word(i);
  } else {
    return "sample " + std::to_string(i);
  }
}

/// A value that is fine.
template <class T>
T fine() {
  return Samples<T>::make(0);
}

inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

template <>
struct Samples<double> {
  static constexpr std::array kValues{0.5, kNaN, kInfinity, -kInfinity, 0.0,   -1.0,
                                      1.0, 3.2,  1e300,     -1e300,     1e-310};
  static std::size_t count() { return kValues.size(); }
  static double make(std::size_t i) { return kValues[i]; }
  static std::string word(std::size_t i) { return fmt::format("{}", kValues[i]); }
};

template <class T>
requires(std::integral<T> && !std::same_as<T, bool> && !std::same_as<T, char>) struct Samples<T> {
  static std::size_t count() { return 6; }
  static T make(std::size_t i) {
    const std::array<T, 6> values{
        1,
        0,
        2,
        77,
        std::numeric_limits<T>::max(),
        static_cast<T>(std::is_signed_v<T> ? -1 : std::numeric_limits<T>::max() / 2)};
    return values[i];
  }
  static std::string word(std::size_t i) { return fmt::format("{}", make(i)); }
};

template <>
struct Samples<bool> {
  static std::size_t count() { return 2; }
  static bool make(std::size_t i) { return i == 1; }
};

template <>
struct Samples<char> {
  static std::size_t count() { return 2; }
  static char make(std::size_t i) { return i == 0 ? ',' : '\0'; }
};

template <auto First, auto... Others>
struct Enumerators {
  static std::size_t count() { return 1 + sizeof...(Others); }
  static decltype(First) make(std::size_t i) { return std::array{First, Others...}[i]; }
};

template <>
struct Samples<std::string> {
  static std::size_t count() { return 14; }
  static std::string make(std::size_t i) {
    const std::array<std::string, 14> values{"cup", "", std::string(1, '\0'), "nan", "a\nb\x1b[31m",
                                             "0 1 2 3 nan", "{\"a\": [", std::string(70'000, '9'),
                                             "../../\xff\xfe",
                                             // Keys of the table of settings, and a camera.
                                             "a", "b", "c", "d", "left"};
    return values[i];
  }
};

template <>
struct Samples<std::filesystem::path> {
  static std::size_t count() { return 6; }
  static std::filesystem::path make(std::size_t i) {
    const std::array<std::filesystem::path, 6> values{"some_file",
                                                      "",
                                                      ".",
                                                      "no_such_folder/file",
                                                      std::string(5'000, 'a'),
                                                      std::string("zero\0byte", 9)};
    return values[i];
  }
};

/// A function that returns a value that is fine, and none.
template <class R, class... A>
struct Samples<std::function<R(A...)>> {
  static std::size_t count() { return 2; }
  static std::function<R(A...)> make(std::size_t i) {
    if (i == 1) return {};
    return [](A...) {
      if constexpr (!std::is_void_v<R>) return fine<R>();
    };
  }
};

/// Vectors and matrices: what is fine is small and, of a square one, positive definite.
template <int Rows, int Columns, int Options>
struct Samples<Eigen::Matrix<double, Rows, Columns, Options>> {
  using Matrix = Eigen::Matrix<double, Rows, Columns, Options>;
  static constexpr bool kDynamic = Rows == Eigen::Dynamic || Columns == Eigen::Dynamic;
  static constexpr bool kSquare = Rows == Columns;
  static std::size_t count() { return kDynamic ? 11 : 8; }
  static Matrix make(std::size_t i) {
    Matrix good(Rows == Eigen::Dynamic ? 12 : Rows, Columns == Eigen::Dynamic ? 12 : Columns);
    if constexpr (kSquare) {
      good = 0.01 * Matrix::Identity(good.rows(), good.cols());
    } else {
      good.setConstant(0.1);
    }
    Matrix bad = good;
    switch (i) {
      case 1:
        bad(0, 0) = kNaN;
        break;
      case 2:
        bad(bad.rows() - 1, bad.cols() - 1) = kInfinity;
        break;
      case 3:
        bad = -good;
        break;
      case 4:
        bad.setZero();
        break;
      case 5:
        bad *= 1e300;
        break;
      case 6:
        bad(0, bad.cols() - 1) = 5;
        break;
      case 7:
        bad *= 1e-310;
        break;
      default:
        break;
    }
    if constexpr (kDynamic) {
      if (i == 8)
        bad.resize(Rows == Eigen::Dynamic ? 0 : Rows, Columns == Eigen::Dynamic ? 0 : Columns);
      if (i == 9)
        bad = good.topLeftCorner(Rows == Eigen::Dynamic ? 5 : Rows,
                                 Columns == Eigen::Dynamic ? 5 : Columns)
                  .eval();
      if (i == 10)
        bad = good.topLeftCorner(Rows == Eigen::Dynamic ? 6 : Rows,
                                 Columns == Eigen::Dynamic ? 3 : Columns)
                  .eval();
    }
    return bad;
  }
};

/// What is not taken apart: a value that is fine, and no other.
template <class T>
requires(HasGood<T> && !HasFields<T>) struct Samples<T> {
  static std::size_t count() { return 1; }
  static T make(std::size_t) { return good<T>(); }
};

/// Structs: one field after the other is bad.
template <class T>
requires(HasFields<T> && (HasGood<T> || std::default_initializable<T>)) struct Samples<T> {
  template <class Field>
  static constexpr bool kTaken = Sampled<Field>&& std::assignable_from<Field&, Field>;

  static std::size_t count() {
    return std::apply([](auto... field) { return (std::size_t{1} + ... + more(field)); },
                      Fields<T>::all());
  }
  static T make(std::size_t i) {
    T value = base();
    std::apply([&](auto... field) { (set(value, field, i), ...); }, Fields<T>::all());
    return value;
  }
  static std::string word(std::size_t i) {
    std::string word = "fine";
    std::size_t field_number = 0;
    std::apply([&](auto... field) { (name(field, i, field_number++, word), ...); },
               Fields<T>::all());
    return word;
  }

 private:
  template <class C, class F>
  static void name(F C::*, std::size_t& i, std::size_t field, std::string& word) {
    if constexpr (kTaken<F>) {
      if (i >= 1 && i <= Samples<F>::count()) {
        word = std::string(Fields<T>::kNames[field]) + " = " + word_of_sample<F>(i - 1);
        i = 0;
      } else if (i > Samples<F>::count()) {
        i -= Samples<F>::count();
      }
    }
  }
  static T base() {
    if constexpr (HasGood<T>) {
      return good<T>();
    } else {
      return T{};
    }
  }
  template <class C, class F>
  static std::size_t more(F C::*) {
    if constexpr (kTaken<F>) {
      return Samples<F>::count();
    } else {
      return 0;
    }
  }
  // Where `i` counts down to zero within a field, that field is set; it ends beyond all counts.
  template <class C, class F>
  static void set(T& value, F C::*field, std::size_t& i) {
    if constexpr (kTaken<F>) {
      if (i >= 1 && i <= Samples<F>::count()) {
        value.*field = Samples<F>::make(i - 1);
        i = 0;
      } else if (i > Samples<F>::count()) {
        i -= Samples<F>::count();
      }
    }
  }
};

}  // namespace posemix::arguments
