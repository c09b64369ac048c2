// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include <nanobind/nanobind.h>

#include "setting_value.hpp"

/// The fields of bound structs. There are hundreds, so that what happens with them is compiled
/// once, for objects by their addresses, and only the conversion of a value once for each type of
/// value.
namespace posemix::python {

/// The annotation of an array among the attributes of a class.
inline constexpr const char* kFloatArray = "numpy.typing.NDArray[numpy.float64]";

/// A text that lives as long as the module.
const char* kept(std::string text);

/// What can be done with the values of one type, by their addresses.
struct Conversion {
  nb::object (*get)(const void* value);
  void (*set)(void* value, nb::handle given, const std::string& name);
  bool (*same)(const void* a, const void* b);
  std::string (*text)(const void* value);
  nb::object (*seen)(nb::handle self, void* value);  ///< as an attribute of `self`
};

/// The functions of `Convert`, as SettingValue<Value>, and `Seen::of(self, value)`.
template <class Value, class Convert, class Seen>
struct ConversionOf {
  static const Value& value_at(const void* value) { return *static_cast<const Value*>(value); }

  static nb::object get(const void* value) { return Convert::get(value_at(value)); }
  static void set(void* value, nb::handle given, const std::string& name) {
    *static_cast<Value*>(value) = Convert::set(given, name);
  }
  static bool same(const void* a, const void* b) { return Convert::same(value_at(a), value_at(b)); }
  static std::string text(const void* value) { return Convert::text(value_at(value)); }
  static nb::object seen(nb::handle self, void* value) {
    return Seen::of(self, *static_cast<Value*>(value));
  }

  static constexpr Conversion kAll{&get, &set, &same, &text, &seen};
};

/// Distance of a member from the beginning of its object [bytes].
template <class T, class Value>
std::ptrdiff_t offset_of(Value T::*member) {
  alignas(T) std::byte storage[sizeof(T)];  // the address of a part needs no object
  const auto* object = reinterpret_cast<const T*>(storage);
  return reinterpret_cast<const std::byte*>(std::addressof(object->*member)) - storage;
}

/// A field of a bound struct.
struct Field {
  const char* name;
  const char* type;  ///< the Python annotation
  const char* text;  ///< description of the field with its unit
  std::ptrdiff_t offset;
  const Conversion* conversion;
  /// What Python sees of the field of an object, where it is not what the conversion says.
  std::function<nb::object(const void* object)> seen = {};
  bool is_required = false;  ///< it has no default

  const void* of(const void* object) const { return static_cast<const char*>(object) + offset; }
  void* of(void* object) const { return static_cast<char*>(object) + offset; }

  std::string shown(const void* object) const;
  bool same(const void* a, const void* b) const { return conversion->same(of(a), of(b)); }
};

/// The type of an argument that becomes a field of this type.
std::string argument_type(const std::string& type);

/// The type of an attribute to which a value of this type can be assigned.
std::string attribute_type(const std::string& type);

/// The fields of a bound struct, from which its class gets attributes, constructor, repr, equality,
/// pickling and docstring. What is given as an address is an object of that struct.
class Fields {
 public:
  using Make = std::function<void(void* place)>;
  using Move = void (*)(void* place, void* object);
  using Copy = void (*)(void* place, const void* object);
  using Check = std::function<void(const void* object)>;
  using Show = std::function<std::string(const void* object)>;

  /// Those of a class, without any so far, which live as long as the module.
  template <class T>
  static Fields& of(const nb::class_<T>& made, const char* name) {
    return kept_fields(made, name, [](void* place, void* object) {
      new (place) T(std::move(*static_cast<T*>(object)));
    });
  }

  Fields(nb::handle made, const char* name, Move move) : class_(made), name_(name), move_(move) {}
  Fields(const Fields&) = delete;
  Fields& operator=(const Fields&) = delete;

  Field& last() { return fields_.back(); }

  /// How an object is made to which fields are assigned.
  void made_by(Make make) { make_ = std::move(make); }
  /// Sets the text of an object in place of the names and values of its fields.
  void show_as(Show text) { text_ = std::move(text); }

  /// Adds a field as an attribute that can be assigned.
  void add_setting(Field field);
  /// Adds a field as an attribute that cannot be assigned.
  void add_result(Field field);

  /// Gives the class a constructor from keywords.
  void define_keywords() const;
  /// Gives the class a constructor from values by position or name, of which the first `required`
  /// have no default, and `replace`; `check` refuses what does not fit together. Lists, dicts and
  /// arrays among the attributes can then not be changed.
  void define_arguments(std::size_t required, Copy copy, const Check& check);
  /// Gives the class repr, equality and pickling.
  void define_values() const;
  /// Sets the docstring of the class, whose defaults are those of a new object.
  void document(const std::string& summary, bool with_defaults, const char* more = "") const;

 private:
  template <class Function, class... Extra>
  void define(const char* name, Function function, const Extra&... extra) const {
    nb::cpp_function_def(function, nb::scope(class_), nb::name(name), nb::is_method(), extra...);
  }
  /// The last field as an attribute, with a setter or None.
  void add_attribute(const std::string& type, const nb::object& set) const;
  nb::object attribute(const Field& field, nb::handle self) const;

  static Fields& kept_fields(nb::handle made, const char* name, Move move);

  bool is_of_class(nb::handle self) const;
  /// The object of `self`.
  /// @throws nb::next_overload, which becomes a TypeError, where it is none of the class, and
  /// TypeError where it was not made
  void* object_of(nb::handle self) const;
  /// @throws the same as object_of where `self` is none of the class or has its object already;
  /// `function` is what would make it
  void require_unmade(nb::handle self, const char* function) const;
  /// A new object, to which nothing was assigned.
  nb::object blank() const;
  /// Makes the object of `self`, which has none, of a new one that is filled first: what is
  /// assigned may run code that knows `self`. `function` as in require_unmade.
  void make(nb::handle self, const char* function,
            const std::function<void(void* object)>& fill) const;

  /// @throws TypeError or ValueError naming the field, where the value does not fit it
  void assign(void* object, const Field& field, nb::handle value) const;
  /// Assigns the values of a dict, whose keys are names of fields.
  void assign(void* object, const nb::dict& values) const;
  /// Values by position, then by name; each of the first `required` fields needs one.
  nb::dict named(const nb::args& values, const nb::kwargs& others, std::size_t required) const;
  /// @throws TypeError where a field that is required has no value
  void require(const nb::kwargs& values) const;

  /// What pickles have, by names that are one object each.
  nb::dict state_of(const void* object) const;
  /// @throws TypeError where a state lacks a field of a class that Python does not fill itself
  void require_whole(const nb::dict& state) const;
  std::string repr(const void* object) const;
  /// The parameters of a signature, each after a comma.
  std::string parameters(const std::function<bool(std::size_t field)>& has_default) const;

  nb::handle class_;  ///< which lives as long as the module
  std::string name_;
  Move move_;
  std::vector<Field> fields_;
  Make make_;
  Check check_;
  Show text_;
  bool is_input_ = false;
  bool has_results_ = false;  ///< its fields cannot be assigned
};

}  // namespace posemix::python
