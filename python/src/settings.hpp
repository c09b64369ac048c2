// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <algorithm>
#include <concepts>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "setting_value.hpp"

namespace posemix::python {

/// A struct of settings as a class like a Python dataclass: keyword arguments with the defaults of
/// C++, attributes, repr, equality, copy and pickle.
template <class T>
class Settings {
 public:
  /// `defaults` is what the keyword arguments change, where T has no default of its own.
  Settings(nb::module_& m, const char* name, std::string summary,
           std::function<T()> defaults = default_of())
      : name_(name),
        summary_(std::move(summary)),
        defaults_(std::move(defaults)),
        fields_(std::make_shared<Fields>()),
        class_(m, name) {}

  /// `type` is the Python annotation, `text` says what it is and its unit. Arrays take anything
  /// that numpy makes an array of.
  template <class Value>
  Settings& field(const char* name, Value T::*member, const char* type, const char* text) {
    using Convert = SettingValue<Value>;
    const auto set = [member, what = name_ + "." + name](T& t, nb::handle value) {
      t.*member = Convert::set(value, what);
    };
    fields_->push_back(
        {name, type, text, [member](const T& t) { return Convert::get(t.*member); }, set,
         [member](const T& t) { return Convert::text(t.*member); },
         [member](const T& a, const T& b) { return Convert::same(a.*member, b.*member); }});
    if constexpr (Convert::kIsArray) {
      class_.def_prop_rw(
          name, [member](T& t) -> Value& { return t.*member; }, set,
          nb::for_getter(nb::rv_policy::reference_internal), kept(text));
    } else if constexpr (kIsVariant<Value>) {
      class_.def_prop_rw(
          name, [member](const T& t) { return t.*member; },
          [member](T& t, Value value) { t.*member = std::move(value); }, kept(text));
    } else {
      class_.def_rw(name, member, kept(text));
    }
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
        [set, defaults = defaults_](T* self, const nb::kwargs& values) {
          auto* made = new (self) T(defaults());
          set(*made, values);
        },
        nb::sig(kept(signature())));
    class_.def("__repr__", [fields, name = name_](const T& self) {
      std::string text = name + "(";
      for (const Field& field : *fields)
        text +=
            fmt::format("{}{}={}", text.back() == '(' ? "" : ", ", field.name, field.shown(self));
      return text + ")";
    });
    class_.def(
        "__eq__",
        [fields](const T& self, nb::handle other) {
          if (!nb::isinstance<T>(other)) return false;
          const T& that = *nb::inst_ptr<T>(other);
          return std::ranges::all_of(*fields,
                                     [&](const Field& field) { return field.same(self, that); });
        },
        nb::sig("def __eq__(self, other: object, /) -> bool"));
    class_.def("__getstate__", [fields](const T& self) {
      nb::dict state;
      for (const Field& field : *fields) state[field.name] = field.get(self);
      return state;
    });
    class_.def("__setstate__", [set, defaults = defaults_](T& self, const nb::dict& state) {
      auto* made = new (&self) T(defaults());
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
    std::function<std::string(const T&)> shown;
    std::function<bool(const T&, const T&)> same;
  };
  using Fields = std::vector<Field>;

  static std::function<T()> default_of() {
    if constexpr (std::default_initializable<T>) return [] { return T(); };
    return {};
  }

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
    const T defaults = defaults_();
    std::string text = summary_ + "\n\nAttributes\n----------\n";
    for (const Field& field : *fields_) {
      text += fmt::format("{} : {}\n    {} Default {}.\n", field.name, field.type, field.text,
                          field.shown(defaults));
    }
    return text;
  }

  std::string name_;
  std::string summary_;
  std::function<T()> defaults_;
  std::shared_ptr<Fields> fields_;
  nb::class_<T> class_;
};

}  // namespace posemix::python
