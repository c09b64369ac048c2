// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <concepts>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

namespace posemix::python {

namespace nb = nanobind;

/// A struct of settings as a class like a Python dataclass: keyword arguments with the defaults of
/// C++, attributes, repr, equality, copy and pickle.
template <class T>
class Settings {
 public:
  Settings(nb::module_& m, const char* name, std::string summary)
      : name_(name),
        summary_(std::move(summary)),
        fields_(std::make_shared<Fields>()),
        class_(m, name) {}

  /// `type` is the Python annotation, `text` says what it is and its unit.
  template <class Value>
  Settings& field(const char* name, Value T::*member, const char* type, const char* text) {
    fields_->push_back({name, type, text,
                        [member](const T& t) { return nb::cast(t.*member, nb::rv_policy::copy); },
                        [member](T& t, nb::handle value) { t.*member = nb::cast<Value>(value); }});
    class_.def_rw(name, member, kept(fmt::format("{}", text)));
    return *this;
  }

  nb::class_<T>& done() {
    const auto fields = fields_;
    const auto set = [fields, name = name_](T& self, const nb::dict& values) {
      for (auto [key, value] : values)
        assign(*fields, name, self, nb::cast<std::string>(key), value);
    };
    class_.def(
        "__init__",
        [set](T* self, const nb::kwargs& values) {
          auto* made = new (self) T();
          set(*made, values);
        },
        nb::sig(kept(signature())));
    class_.def("__repr__", [fields, name = name_](const T& self) {
      std::string text = name + "(";
      for (const Field& field : *fields)
        text += fmt::format("{}{}={}", text.back() == '(' ? "" : ", ", field.name,
                            nb::repr(field.get(self)).c_str());
      return text + ")";
    });
    class_.def(
        "__eq__",
        [](const nb::object& a, const nb::object& b) {
          return a.type().is(b.type()) && nb::repr(a).equal(nb::repr(b));
        },
        nb::sig("def __eq__(self, other: object, /) -> bool"));
    class_.def("__getstate__", [fields](const T& self) {
      nb::dict state;
      for (const Field& field : *fields) state[field.name] = field.get(self);
      return state;
    });
    class_.def("__setstate__", [set](T& self, const nb::dict& state) {
      auto* made = new (&self) T();
      set(*made, state);
    });
    class_.attr("__hash__") = nb::none();
    class_.attr("__doc__") = document();
    return class_;
  }

 private:
  struct Field {
    const char* name;
    const char* type;
    const char* text;
    std::function<nb::object(const T&)> get;
    std::function<void(T&, nb::handle)> set;
  };
  using Fields = std::vector<Field>;

  static void assign(const Fields& fields, const std::string& name, T& self, const std::string& key,
                     nb::handle value) {
    for (const Field& field : fields) {
      if (key != field.name) continue;
      try {
        field.set(self, value);
      } catch (const nb::cast_error&) {
        throw nb::type_error(
            fmt::format("{}: {} is {}; expected {}", name, key, nb::repr(value).c_str(), field.type)
                .c_str());
      }
      return;
    }
    throw nb::type_error(fmt::format("{} has no setting '{}'", name, key).c_str());
  }

  /// Text that lives as long as the module.
  static const char* kept(std::string text) {
    static std::deque<std::string> texts;
    return texts.emplace_back(std::move(text)).c_str();
  }

  std::string signature() const {
    std::string text = "def __init__(self";
    if (!fields_->empty()) text += ", *";
    for (const Field& field : *fields_)
      text += fmt::format(", {}: {} = ...", field.name, field.type);
    return text + ") -> None";
  }

  std::string document() const {
    const T defaults{};
    std::string text = summary_ + "\n\nAttributes\n----------\n";
    for (const Field& field : *fields_) {
      text += fmt::format("{} : {}\n    {} Default {}.\n", field.name, field.type, field.text,
                          nb::repr(field.get(defaults)).c_str());
    }
    return text;
  }

  std::string name_;
  std::string summary_;
  std::shared_ptr<Fields> fields_;
  nb::class_<T> class_;
};

}  // namespace posemix::python
