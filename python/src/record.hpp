// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include "fields.hpp"

namespace posemix::python {

/// Binds a struct of results as a class like a frozen Python dataclass: attributes that cannot be
/// assigned, repr, equality, copy and pickle. Python code cannot construct an object.
template <class T>
class Record {
 public:
  /// @param extra attributes of nanobind's class, such as nb::is_generic
  template <class... Extra>
  Record(nb::module_& m, const char* name, std::string summary, const Extra&... extra)
      : summary_(std::move(summary)),
        fields_(std::make_shared<Fields<T>>(name)),
        class_(m, name, extra...) {}

  /// Adds a field; `type` is the Python annotation, `text` the description with its unit.
  template <class Value>
  Record& field(const char* name, Value T::*member, const char* type, const char* text) {
    return field(name, member, type, text, &SettingValue<Value>::get);
  }

  /// Adds a field whose value in Python is `get(value)`.
  template <class Value, class Get>
  Record& field(const char* name, Value T::*member, const char* type, const char* text, Get get) {
    fields_->add(name, member, type, text);
    class_.def_prop_ro(
        name, [member, get](const T& self) { return get(self.*member); },
        nb::for_getter(nb::sig(kept(fmt::format("def {}(self, /) -> {}", name, type)))), text);
    return *this;
  }

  /// Sets the repr, which by default has all fields.
  Record& shown_as(std::function<std::string(const T&)> text) {
    fields_->show_as(std::move(text));
    return *this;
  }

  nb::class_<T>& done() {
    static_assert(std::default_initializable<T>);
    Fields<T>::define(class_, fields_);
    class_.def("__setstate__", [fields = fields_](T& self, const nb::dict& state) {
      auto* made = new (&self) T{};
      fields->assign(*made, state);
    });
    class_.attr("__doc__") = summary_ + fields_->document([](const Field<T>&) { return ""; });
    return class_;
  }

 private:
  std::string summary_;
  std::shared_ptr<Fields<T>> fields_;
  nb::class_<T> class_;
};

}  // namespace posemix::python
