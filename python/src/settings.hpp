// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <concepts>
#include <functional>
#include <new>
#include <string>
#include <utility>

#include "fields.hpp"
#include "parts.hpp"

namespace posemix::python {

/// What Python sees of a value in settings.
struct SeenInSettings {
  template <class Value>
  static nb::object of(nb::handle self, Value& value) {
    return part_of(self, value);
  }
};

/// Binds a struct of settings as a class like a Python dataclass: keyword arguments with the
/// defaults of C++, attributes, repr, equality, copy and pickle.
template <class T>
class Settings {
 public:
  Settings(nb::module_& m, const char* name,
           std::string summary) requires std::default_initializable<T>
      : Settings(m, name, std::move(summary), Fields::Make([](void* place) { new (place) T(); })) {}

  /// @param defaults makes the object that the keyword arguments change, where T has no default of
  /// its own
  Settings(nb::module_& m, const char* name, std::string summary, std::function<T()> defaults)
      : Settings(m, name, std::move(summary),
                 Fields::Make([defaults = std::move(defaults)](void* place) {
                   new (place) T(defaults());
                 })) {}

  /// Adds a field; `type` is the Python annotation, `text` the description with its unit. An array
  /// can be set from any value that numpy can convert to one.
  template <class Value>
  Settings& field(const char* name, Value T::*member, const char* type, const char* text) {
    fields_.add_setting({name, type, text, offset_of(member),
                         &ConversionOf<Value, SettingValue<Value>, SeenInSettings>::kAll});
    return *this;
  }

  /// The last field has no default: who makes an object must say it.
  Settings& required() {
    fields_.last().is_required = true;
    return *this;
  }

  nb::class_<T>& done() {
    fields_.define_keywords();
    fields_.define_values();
    fields_.document(summary_, true);
    return class_;
  }

 private:
  Settings(nb::module_& m, const char* name, std::string summary, Fields::Make make)
      : summary_(std::move(summary)), class_(m, name), fields_(Fields::of(class_, name)) {
    fields_.made_by(std::move(make));
  }

  std::string summary_;
  nb::class_<T> class_;
  Fields& fields_;
};

}  // namespace posemix::python
