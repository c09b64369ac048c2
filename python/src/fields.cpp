// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "fields.hpp"

#include <algorithm>
#include <deque>

#include <fmt/format.h>

#include "parts.hpp"

namespace posemix::python {
namespace {

std::string replaced(std::string text, const std::string& old, const std::string& by) {
  const auto at = text.find(old);
  if (at != std::string::npos) text.replace(at, old.size(), by);
  return text;
}

[[noreturn]] void refuse(const std::string& why) { throw nb::type_error(why.c_str()); }

}  // namespace

const char* kept(std::string text) {
  static std::deque<std::string> texts;
  return texts.emplace_back(std::move(text)).c_str();
}

std::string argument_type(const std::string& type) {
  // The group of a density is no pose.
  if (type.find("[posemix.lie.SE3]") != std::string::npos) return type;
  return replaced(type, "posemix.lie.SE3", "posemix.lie.SE3 | numpy.typing.ArrayLike");
}

std::string attribute_type(const std::string& type) {
  return replaced(type, "numpy.typing.ArrayLike", kFloatArray);
}

std::string Field::shown(const void* object) const {
  return seen ? std::string(nb::repr(seen(object)).c_str()) : conversion->text(of(object));
}

Fields& Fields::kept_fields(nb::handle made, const char* name, Move move) {
  static std::deque<Fields> all;
  return all.emplace_back(made, name, move);
}

// --- objects

bool Fields::is_of_class(nb::handle self) const {
  return PyObject_TypeCheck(self.ptr(), reinterpret_cast<PyTypeObject*>(class_.ptr())) != 0;
}

void* Fields::object_of(nb::handle self) const {
  if (!is_of_class(self)) throw nb::next_overload();
  if (!nb::inst_ready(self))
    refuse(fmt::format("{}: the object was not made; a subclass calls super().__init__()", name_));
  return nb::inst_ptr<void>(self);
}

void Fields::require_unmade(nb::handle self, const char* function) const {
  if (!is_of_class(self)) throw nb::next_overload();
  if (nb::inst_ready(self))
    refuse(fmt::format("{}.{}(): the object is made already; make another one", name_, function));
}

nb::object Fields::blank() const {
  if (!make_) refuse(fmt::format("{}: only the library makes one", name_));
  const nb::object made = nb::inst_alloc(class_);
  make_(nb::inst_ptr<void>(made));
  nb::inst_mark_ready(made);
  return made;
}

void Fields::make(nb::handle self, const char* function,
                  const std::function<void(void* object)>& fill) const {
  const nb::object made = blank();
  fill(nb::inst_ptr<void>(made));
  require_unmade(self, function);
  move_(nb::inst_ptr<void>(self), nb::inst_ptr<void>(made));
  nb::inst_mark_ready(self);
}

void Fields::assign(void* object, const Field& field, nb::handle value) const {
  try {
    field.conversion->set(field.of(object), value, name_ + "." + field.name);
  } catch (const nb::cast_error&) {
    refuse(fmt::format("{}: {} is {}; expected {}", name_, field.name, nb::repr(value).c_str(),
                       field.type));
  }
}

void Fields::assign(void* object, const nb::dict& values) const {
  for (auto [key, value] : values) {
    std::string name;
    const bool is_text = nb::try_cast<std::string>(key, name);
    const auto field = std::ranges::find_if(
        fields_, [&](const Field& candidate) { return is_text && candidate.name == name; });
    if (field == fields_.end())
      refuse(fmt::format("{} has no setting {}", name_, nb::repr(key).c_str()));
    assign(object, *field, value);
  }
}

nb::dict Fields::named(const nb::args& values, const nb::kwargs& others,
                       std::size_t required) const {
  nb::dict all;
  if (values.size() > fields_.size())
    refuse(fmt::format("{} takes {} values; got {}", name_, fields_.size(), values.size()));
  for (std::size_t i = 0; i < values.size(); ++i) all[fields_[i].name] = values[i];
  for (auto [key, value] : others) {
    if (all.contains(key))
      refuse(fmt::format("{} got two values of {}", name_, nb::repr(key).c_str()));
    all[key] = value;
  }
  for (std::size_t i = 0; i < required; ++i)
    if (!all.contains(fields_[i].name))
      refuse(fmt::format("{} needs '{}'", name_, fields_[i].name));
  return all;
}

void Fields::require(const nb::kwargs& values) const {
  for (const Field& field : fields_) {
    if (field.is_required && !values.contains(field.name))
      refuse(fmt::format("{}: expected a value of {}", name_, field.name));
  }
}

// --- attributes

nb::object Fields::attribute(const Field& field, nb::handle self) const {
  void* const object = object_of(self);
  const nb::object value =
      field.seen ? field.seen(object) : field.conversion->seen(self, field.of(object));
  return is_input_ ? unchangeable(value) : value;
}

void Fields::add_attribute(const std::string& type, const nb::object& set) const {
  const Field& field = fields_.back();
  const nb::object get = nb::cpp_function(
      [this, i = fields_.size() - 1](nb::handle self) { return attribute(fields_[i], self); },
      nb::is_method(), nb::is_getter(),
      nb::sig(kept(fmt::format("def {}(self, /) -> {}", field.name, type))), field.text);
  const nb::object property = nb::module_::import_("builtins").attr("property");
  class_.attr(field.name) = property(get, set, nb::none(), field.text);
}

void Fields::add_result(Field field) {
  has_results_ = true;
  fields_.push_back(std::move(field));
  add_attribute(last().type, nb::none());
}

void Fields::add_setting(Field field) {
  fields_.push_back(std::move(field));
  const nb::object set = nb::cpp_function(
      [this, i = fields_.size() - 1](nb::handle self, nb::handle value) {
        assign(object_of(self), fields_[i], value);
      },
      nb::is_method(), nb::arg("value").none(),
      nb::sig(kept(fmt::format("def {}(self, value: {}, /) -> None", last().name,
                               argument_type(last().type)))),
      last().text);
  add_attribute(attribute_type(last().type), set);
}

// --- constructors

std::string Fields::parameters(const std::function<bool(std::size_t)>& has_default) const {
  std::string text;
  for (std::size_t i = 0; i < fields_.size(); ++i) {
    const Field& field = fields_[i];
    text += fmt::format(", {}: {}{}", field.name, argument_type(field.type),
                        has_default(i) ? " = ..." : "");
  }
  return text;
}

void Fields::define_keywords() const {
  const std::string all = parameters([&](std::size_t i) { return !fields_[i].is_required; });
  define(
      "__init__",
      [this](nb::handle self, const nb::kwargs& values) {
        require_unmade(self, "__init__");
        require(values);
        make(self, "__init__", [&](void* object) { assign(object, values); });
      },
      nb::sig(
          kept(fmt::format("def __init__(self{}{}) -> None", fields_.empty() ? "" : ", *", all))));
}

void Fields::define_arguments(std::size_t required, Copy copy, const Check& check) {
  is_input_ = true;
  check_ = check;
  const std::string needed = parameters([&](std::size_t i) { return i >= required; });
  define(
      "__init__",
      [this, required](nb::handle self, const nb::args& values, const nb::kwargs& others) {
        require_unmade(self, "__init__");
        const nb::dict all = named(values, others, required);
        make(self, "__init__", [&](void* object) {
          assign(object, all);
          if (check_) check_(object);
        });
      },
      nb::sig(kept(fmt::format("def __init__(self{}) -> None", needed))));
  const std::string optional = parameters([](std::size_t) { return true; });
  define(
      "replace",
      [this, copy](nb::handle self, const nb::kwargs& changes) {
        const void* const object = object_of(self);
        const nb::object other = nb::inst_alloc(class_);
        copy(nb::inst_ptr<void>(other), object);
        nb::inst_mark_ready(other);
        assign(nb::inst_ptr<void>(other), changes);
        if (check_) check_(nb::inst_ptr<void>(other));
        return other;
      },
      nb::sig(kept(fmt::format("def replace(self, /, *{}) -> {}", optional, name_))),
      "The same with other values of some fields.");
  // The functions of the module dataclasses take it too.
  nb::list names;
  for (const Field& field : fields_) names.append(field.name);
  const nb::module_ dataclasses = nb::module_::import_("dataclasses");
  const nb::object like = dataclasses.attr("make_dataclass")(name_, names);
  class_.attr("__dataclass_fields__") = like.attr("__dataclass_fields__");
}

// --- values

std::string Fields::repr(const void* object) const {
  if (text_) return text_(object);
  std::string text = name_ + "(";
  for (const Field& field : fields_)
    text += fmt::format("{}{}={}", text.back() == '(' ? "" : ", ", field.name, field.shown(object));
  return text + ")";
}

nb::dict Fields::state_of(const void* object) const {
  nb::dict state;
  for (const Field& field : fields_) {
    const auto key = nb::steal(PyUnicode_InternFromString(field.name));
    state[key] = field.conversion->get(field.of(object));
  }
  return state;
}

void Fields::require_whole(const nb::dict& state) const {
  if (!has_results_) return;
  for (const Field& field : fields_)
    if (!state.contains(field.name))
      refuse(fmt::format("{}: a state without '{}'", name_, field.name));
}

void Fields::define_values() const {
  define(
      "__repr__", [this](nb::handle self) { return repr(object_of(self)); },
      nb::sig("def __repr__(self) -> str"));
  define(
      "__eq__",
      [this](nb::handle self, nb::handle other) {
        const void* const object = object_of(self);
        if (!is_of_class(other) || !nb::inst_ready(other)) return false;
        const void* const that = nb::inst_ptr<void>(other);
        return std::ranges::all_of(fields_,
                                   [&](const Field& field) { return field.same(object, that); });
      },
      nb::sig("def __eq__(self, other: object, /) -> bool"));
  define(
      "__getstate__", [this](nb::handle self) { return state_of(object_of(self)); },
      nb::sig("def __getstate__(self) -> dict"));
  class_.attr("__hash__") = nb::none();
  define(
      "__setstate__",
      [this](nb::handle self, const nb::dict& state) {
        require_unmade(self, "__setstate__");
        require_whole(state);
        make(self, "__setstate__", [&](void* object) { assign(object, state); });
      },
      nb::sig("def __setstate__(self, arg: dict, /) -> None"));
}

void Fields::document(const std::string& summary, bool with_defaults, const char* more) const {
  const nb::object like = with_defaults ? blank() : nb::none();
  std::string text = summary + "\n\nAttributes\n----------\n";
  for (const Field& field : fields_) {
    const std::string value = with_defaults && !field.is_required
                                  ? fmt::format(" Default {}.", field.shown(object_of(like)))
                                  : "";
    text += fmt::format("{} : {}\n    {}{}\n", field.name, field.type, field.text, value);
  }
  class_.attr("__doc__") = text + more;
}

}  // namespace posemix::python
