// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <type_traits>

#include "fields.hpp"
#include "parts.hpp"

namespace posemix::python {

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
      : summary_(std::move(summary)),
        fields_(std::make_shared<Fields<T>>(name)),
        class_(m, name, extra...) {
    if constexpr (std::default_initializable<T>) blank_ = [] { return T{}; };
  }

  /// `type` is the Python annotation, `text` says what the field is and its unit.
  template <class Convert = void, class Value>
  Record& field(const char* name, Value T::*member, const char* type, const char* text) {
    using Used = std::conditional_t<std::is_void_v<Convert>, SettingValue<Value>, Convert>;
    return add<Used>(name, member, type, text, [](const Value& value) {
      if constexpr (std::is_void_v<Convert>)
        return frozen(value);
      else
        return Used::get(value);
    });
  }

  /// The same where Python sees `get(value)` or `get(object)`.
  template <class Value, class Get>
  Record& field(const char* name, Value T::*member, const char* type, const char* text, Get get) {
    add<SettingValue<Value>>(name, member, type, text, get);
    fields_->show_last_as([member, get](const T& self) {
      return std::string(nb::repr(seen(self, member, get)).c_str());
    });
    return *this;
  }

  /// Sets the repr, which by default has all fields.
  Record& shown_as(std::function<std::string(const T&)> text) {
    fields_->show_as(std::move(text));
    return *this;
  }

  /// What the fields of a new object are assigned to, where T has no default of its own.
  Record& made_from(std::function<T()> blank) {
    blank_ = std::move(blank);
    return *this;
  }

  /// Python makes one too, from values by position or name, of which the first `required` have no
  /// default, as of a dataclass; `check` refuses what does not fit together.
  Record& constructible(
      std::size_t required, Check check = [](const T&) {}) {
    fields_->set_input();
    const auto make = [fields = fields_, blank = blank_, required, check](
                          T* self, const nb::args& values, const nb::kwargs& named) {
      T made = blank();
      fields->assign(made, values, named, required);
      check(made);
      new (self) T(std::move(made));
    };
    const auto replace = [fields = fields_, check](const T& self, const nb::kwargs& changes) {
      T other = self;
      fields->assign(other, changes);
      check(other);
      return other;
    };
    std::string needed;
    std::string optional;
    nb::list names;
    for (const Field<T>& field : *fields_) {
      const std::string argument = fmt::format(", {}: {}", field.name, argument_type(field.type));
      needed += argument + (nb::len(names) < required ? "" : " = ...");
      optional += argument + " = ...";
      names.append(field.name);
    }
    class_.def("__init__", make,
               nb::sig(kept(fmt::format("def __init__(self{}) -> None", needed))));
    class_.def(
        "replace", replace,
        nb::sig(kept(fmt::format("def replace(self, /, *{}) -> {}", optional, fields_->name()))),
        "The same with other values of some fields.");
    // The functions of the module dataclasses take it too.
    const nb::module_ dataclasses = nb::module_::import_("dataclasses");
    const nb::object like = dataclasses.attr("make_dataclass")(fields_->name(), names);
    class_.attr("__dataclass_fields__") = like.attr("__dataclass_fields__");
    return *this;
  }

  /// `more` are further sections of the docstring.
  nb::class_<T>& done(const char* more = "") {
    Fields<T>::define(class_, fields_);
    class_.def("__setstate__", [fields = fields_, blank = blank_](T& self, const nb::dict& state) {
      T made = blank();
      fields->assign(made, state);
      new (&self) T(std::move(made));
    });
    class_.attr("__doc__") =
        summary_ + fields_->document([](const Field<T>&) { return ""; }) + more;
    return class_;
  }

 private:
  template <class Value, class Get>
  static nb::object seen(const T& self, Value T::*member, const Get& get) {
    if constexpr (std::is_invocable_v<Get, const T&>)
      return get(self);
    else
      return get(self.*member);
  }

  template <class Convert, class Value, class Get>
  Record& add(const char* name, Value T::*member, const char* type, const char* text, Get get) {
    fields_->template add<Convert>(name, member, type, text);
    class_.def_prop_ro(
        name,
        [member, get, fields = fields_](const T& self) {
          const nb::object value = seen(self, member, get);
          return fields->is_input() ? unchangeable(value) : value;
        },
        nb::for_getter(nb::sig(kept(fmt::format("def {}(self, /) -> {}", name, type)))), text);
    return *this;
  }

  std::string summary_;
  std::shared_ptr<Fields<T>> fields_;
  std::function<T()> blank_;
  nb::class_<T> class_;
};

}  // namespace posemix::python
