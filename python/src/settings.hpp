// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "fields.hpp"
#include "parts.hpp"

namespace posemix::python {

/// Binds a struct of settings as a class like a Python dataclass: keyword arguments with the
/// defaults of C++, attributes, repr, equality, copy and pickle.
template <class T>
class Settings {
 public:
  /// @param defaults makes the object that the keyword arguments change, if T has no default of its
  /// own
  Settings(nb::module_& m, const char* name, std::string summary,
           std::function<T()> defaults = default_of())
      : summary_(std::move(summary)),
        defaults_(std::move(defaults)),
        fields_(std::make_shared<Fields<T>>(name)),
        class_(m, name) {}

  /// Adds a field; `type` is the Python annotation, `text` the description with its unit. An array
  /// can be set from any value that numpy can convert to one.
  template <class Value>
  Settings& field(const char* name, Value T::*member, const char* type, const char* text) {
    fields_->template add<SettingValue<Value>>(name, member, type, text);
    class_.def_prop_rw(
        name,
        [member](nb::handle_t<T> self) { return part_of(self, nb::inst_ptr<T>(self)->*member); },
        [fields = fields_, name](nb::handle_t<T> self, nb::handle value) {
          fields->assign(*nb::inst_ptr<T>(self), name, value);
        },
        nb::for_getter(
            nb::sig(kept(fmt::format("def {}(self, /) -> {}", name, attribute_type(type))))),
        nb::for_setter(nb::sig(
            kept(fmt::format("def {}(self, value: {}, /) -> None", name, argument_type(type))))),
        nb::for_setter(nb::arg("value").none()), text);
    return *this;
  }

  /// The last field has no default: who makes an object must say it.
  Settings& required() {
    required_.emplace_back(std::prev(fields_->end())->name);
    return *this;
  }

  nb::class_<T>& done() {
    const auto fields = fields_;
    class_.def(
        "__init__",
        [fields, defaults = defaults_, required = required_](T* self, const nb::kwargs& values) {
          for (const std::string& name : required) {
            if (values.contains(name.c_str())) continue;
            const std::string text =
                fmt::format("{}: expected a value of {}", fields->name(), name);
            throw nb::type_error(text.c_str());
          }
          auto* made = new (self) T(defaults());
          fields->assign(*made, values);
        },
        nb::sig(kept(signature())));
    Fields<T>::define(class_, fields);
    class_.def("__setstate__", [fields, defaults = defaults_](T& self, const nb::dict& state) {
      auto* made = new (&self) T(defaults());
      fields->assign(*made, state);
    });
    const T defaults = defaults_();
    class_.attr("__doc__") = summary_ + fields->document([&](const Field<T>& field) {
      return is_required(field) ? "" : fmt::format(" Default {}.", field.shown(defaults));
    });
    return class_;
  }

 private:
  static std::function<T()> default_of() {
    if constexpr (std::default_initializable<T>) return [] { return T(); };
    return {};
  }

  std::string signature() const {
    std::string text = "def __init__(self";
    if (fields_->begin() != fields_->end()) text += ", *";
    for (const Field<T>& field : *fields_) {
      text += fmt::format(", {}: {}", field.name, argument_type(field.type));
      if (!is_required(field)) text += " = ...";
    }
    return text + ") -> None";
  }

  bool is_required(const Field<T>& field) const {
    return std::find(required_.begin(), required_.end(), field.name) != required_.end();
  }

  std::string summary_;
  std::function<T()> defaults_;
  std::shared_ptr<Fields<T>> fields_;
  std::vector<std::string> required_;
  nb::class_<T> class_;
};

}  // namespace posemix::python
