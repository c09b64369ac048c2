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

/// The annotation of an array among the attributes of a class.
inline constexpr const char* kFloatArray = "numpy.typing.NDArray[numpy.float64]";

/// A text that lives as long as the module.
inline const char* kept(std::string text) {
  static std::deque<std::string> texts;
  return texts.emplace_back(std::move(text)).c_str();
}

/// A field of a bound struct T.
template <class T>
struct Field {
  const char* name;
  const char* type;  ///< the Python annotation
  const char* text;  ///< description of the field with its unit
  std::function<nb::object(const T&)> get;
  std::function<void(T&, nb::handle)> set;
  std::function<std::string(const T&)> shown;
  std::function<bool(const T&, const T&)> same;
};

/// The type of an argument that becomes a field of this type.
std::string argument_type(const std::string& type);

/// The type of an attribute to which a value of this type can be assigned.
std::string attribute_type(const std::string& type);

/// The fields of a bound struct T, from which its class gets repr, equality, pickling and
/// docstring.
template <class T>
class Fields {
 public:
  explicit Fields(std::string name) : name_(std::move(name)) {}

  const std::string& name() const { return name_; }
  auto begin() const { return fields_.begin(); }
  auto end() const { return fields_.end(); }

  template <class Convert, class Value>
  void add(const char* name, Value T::*member, const char* type, const char* text) {
    const auto set = [member, what = name_ + "." + name](T& t, nb::handle value) {
      t.*member = Convert::set(value, what);
    };
    fields_.push_back(
        {name, type, text, [member](const T& t) { return Convert::get(t.*member); }, set,
         [member](const T& t) { return Convert::text(t.*member); },
         [member](const T& a, const T& b) { return Convert::same(a.*member, b.*member); }});
  }

  /// Assigns the values of a dict, whose keys are names of fields.
  void assign(T& self, const nb::dict& values) const {
    for (auto [key, value] : values) assign(self, nb::cast<std::string>(key), value);
  }

  /// @throws TypeError or ValueError naming the field, where the value does not fit it
  void assign(T& self, const std::string& key, nb::handle value) const {
    for (const Field<T>& field : fields_) {
      if (key != field.name) continue;
      try {
        field.set(self, value);
      } catch (const nb::cast_error&) {
        throw nb::type_error(fmt::format("{}: {} is {}; expected {}", name_, key,
                                         nb::repr(value).c_str(), field.type)
                                 .c_str());
      }
      return;
    }
    throw nb::type_error(fmt::format("{} has no setting '{}'", name_, key).c_str());
  }

  /// Assigns values by position, then by name; each of the first `required` fields needs one.
  void assign(T& self, const nb::args& values, const nb::kwargs& named,
              std::size_t required) const {
    nb::dict all;
    const auto refuse = [this](const std::string& why) {
      throw nb::type_error((name_ + " " + why).c_str());
    };
    if (values.size() > fields_.size())
      refuse(fmt::format("takes {} values; got {}", fields_.size(), values.size()));
    for (std::size_t i = 0; i < values.size(); ++i) all[fields_[i].name] = values[i];
    for (auto [key, value] : named) {
      if (all.contains(key)) refuse(fmt::format("got two values of {}", nb::repr(key).c_str()));
      all[key] = value;
    }
    for (std::size_t i = 0; i < required; ++i)
      if (!all.contains(fields_[i].name)) refuse(fmt::format("needs '{}'", fields_[i].name));
    assign(self, all);
  }

  /// The section `Attributes` of a numpydoc docstring; `after` is what follows a field's text.
  std::string document(const std::function<std::string(const Field<T>&)>& after) const {
    std::string text = "\n\nAttributes\n----------\n";
    for (const Field<T>& field : fields_)
      text += fmt::format("{} : {}\n    {}{}\n", field.name, field.type, field.text, after(field));
    return text;
  }

  /// Sets the text of the last field in place of that of its conversion.
  void show_last_as(std::function<std::string(const T&)> shown) {
    fields_.back().shown = std::move(shown);
  }

  /// Python makes the object from values of its own, which cannot be changed in place.
  void set_input() { is_input_ = true; }
  bool is_input() const { return is_input_; }

  /// Sets the text of an object in place of the names and values of its fields.
  void show_as(std::function<std::string(const T&)> text) { text_ = std::move(text); }

  /// Gives the class repr, equality and pickling.
  static void define(nb::class_<T>& made, const std::shared_ptr<Fields>& fields) {
    made.def("__repr__", [fields](const T& self) {
      if (fields->text_) return fields->text_(self);
      std::string text = fields->name_ + "(";
      for (const Field<T>& field : *fields)
        text +=
            fmt::format("{}{}={}", text.back() == '(' ? "" : ", ", field.name, field.shown(self));
      return text + ")";
    });
    made.def(
        "__eq__",
        [fields](const T& self, nb::handle other) {
          if (!nb::isinstance<T>(other)) return false;
          const T& that = *nb::inst_ptr<T>(other);
          return std::ranges::all_of(*fields,
                                     [&](const Field<T>& field) { return field.same(self, that); });
        },
        nb::sig("def __eq__(self, other: object, /) -> bool"));
    made.def("__getstate__", [fields](const T& self) {
      nb::dict state;
      for (const Field<T>& field : *fields) state[field.name] = field.get(self);
      return state;
    });
    made.attr("__hash__") = nb::none();
  }

 private:
  std::string name_;
  std::vector<Field<T>> fields_;
  std::function<std::string(const T&)> text_;
  bool is_input_ = false;
};

}  // namespace posemix::python
