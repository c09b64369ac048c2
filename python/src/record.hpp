// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <concepts>
#include <functional>
#include <new>
#include <string>
#include <type_traits>
#include <utility>

#include "fields.hpp"
#include "parts.hpp"

namespace posemix::python {

/// What Python sees of a value in a record: a copy that is frozen, or what `Convert` says.
template <class Convert>
struct SeenInRecord {
  template <class Value>
  static nb::object of(nb::handle /*self*/, const Value& value) {
    if constexpr (std::is_void_v<Convert>)
      return frozen(value);
    else
      return Convert::get(value);
  }
};

/// A struct as a class like a frozen Python dataclass: attributes that cannot be assigned, repr,
/// equality, copy and pickle. Only C++ makes one, unless it is `constructible`; then lists, dicts
/// and arrays among its attributes cannot be changed either.
template <class T>
class Record {
 public:
  using Check = void (*)(const T&);

  /// `extra` are attributes of nanobind's class, as nb::is_generic.
  template <class... Extra>
  Record(nb::module_& m, const char* name, std::string summary, const Extra&... extra)
      : summary_(std::move(summary)), class_(m, name, extra...), fields_(Fields::of(class_, name)) {
    if constexpr (std::default_initializable<T>)
      fields_.made_by([](void* place) { new (place) T{}; });
  }

  /// `type` is the Python annotation, `text` says what the field is and its unit.
  template <class Convert = void, class Value>
  Record& field(const char* name, Value T::*member, const char* type, const char* text) {
    using Used = std::conditional_t<std::is_void_v<Convert>, SettingValue<Value>, Convert>;
    fields_.add_result({name, type, text, offset_of(member),
                        &ConversionOf<Value, Used, SeenInRecord<Convert>>::kAll});
    return *this;
  }

  /// The same where Python sees `get(value)` or `get(object)`.
  template <class Value, class Get>
  Record& field(const char* name, Value T::*member, const char* type, const char* text, Get get) {
    fields_.add_result({name, type, text, offset_of(member),
                        &ConversionOf<Value, SettingValue<Value>, SeenInRecord<void>>::kAll,
                        seen_by(member, get)});
    return *this;
  }

  /// Sets the repr, which by default has all fields.
  Record& shown_as(std::function<std::string(const T&)> text) {
    fields_.show_as([text = std::move(text)](const void* object) {
      return text(*static_cast<const T*>(object));
    });
    return *this;
  }

  /// What the fields of a new object are assigned to, where T has no default of its own.
  Record& made_from(std::function<T()> blank) {
    fields_.made_by([blank = std::move(blank)](void* place) { new (place) T(blank()); });
    return *this;
  }

  /// Python makes one too, from values by position or name, of which the first `required` have no
  /// default, as of a dataclass; `check` refuses what does not fit together.
  Record& constructible(std::size_t required, Check check = nullptr) {
    Fields::Check checked;
    if (check != nullptr)
      checked = [check](const void* object) { check(*static_cast<const T*>(object)); };
    const auto copy = [](void* place, const void* object) {
      new (place) T(*static_cast<const T*>(object));
    };
    fields_.define_arguments(required, copy, checked);
    return *this;
  }

  /// `more` are further sections of the docstring.
  nb::class_<T>& done(const char* more = "") {
    fields_.define_values();
    fields_.document(summary_, false, more);
    return class_;
  }

 private:
  template <class Value, class Get>
  static std::function<nb::object(const void*)> seen_by(Value T::*member, Get get) {
    if constexpr (std::is_invocable_v<Get, const T&>)
      return [get](const void* object) { return get(*static_cast<const T*>(object)); };
    else
      return
          [member, get](const void* object) { return get(static_cast<const T*>(object)->*member); };
  }

  std::string summary_;
  nb::class_<T> class_;
  Fields& fields_;
};

}  // namespace posemix::python
