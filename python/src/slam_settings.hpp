// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <optional>
#include <utility>
#include <variant>

#include "parts.hpp"
#include "posemix/slam/object_slam.hpp"

namespace posemix::python {

/// The settings of a tracker as the Python object that they are: a reference to it stays valid when
/// another tracker is chosen, as it would not in a std::variant.
struct TrackerObject {
  nb::object settings = nb::cast(TrackerSettings());
};

template <>
struct SettingValue<TrackerObject> {
  using Value = TrackerObject;
  static TrackerSettings held(const Value& value) {
    return nb::cast<TrackerSettings>(value.settings);
  }
  static nb::object get(const Value& value) { return nb::cast(held(value)); }
  static Value set(nb::handle value, const std::string& /*name*/) {
    return {nb::cast(nb::cast<TrackerSettings>(value))};
  }
  static bool same(const Value& a, const Value& b) { return a.settings.equal(b.settings); }
  static std::string text(const Value& value) { return nb::repr(value.settings).c_str(); }
  static nb::object frozen(const Value& value) { return python::frozen(held(value)); }
  static nb::object part(nb::handle self, const Value& value) {
    return is_frozen(self) ? frozen(value) : value.settings;
  }
};

/// `ObjectSlamSettings` as Python has it.
struct NamedSlamSettings {
  MotionSettings motion = {};
  TrackerObject tracker = {};
  bool record_hypotheses = false;

  static NamedSlamSettings from(const ObjectSlamSettings& settings) {
    return {settings.motion, {nb::cast(settings.tracker)}, settings.record_hypotheses};
  }
  ObjectSlamSettings settings() const {
    return {motion, SettingValue<TrackerObject>::held(tracker), record_hypotheses};
  }
};

}  // namespace posemix::python

namespace nanobind::detail {

template <>
struct type_caster<posemix::ObjectSlamSettings> {
  using Named = posemix::python::NamedSlamSettings;
  NB_TYPE_CASTER(posemix::ObjectSlamSettings, make_caster<Named>::Name)

  bool from_python(handle source, std::uint32_t /*flags*/, cleanup_list* /*cleanup*/) noexcept try {
    if (!isinstance<Named>(source)) return false;
    value = inst_ptr<Named>(source)->settings();
    return true;
  } catch (...) {
    return false;
  }

  static handle from_cpp(const posemix::ObjectSlamSettings& settings, rv_policy /*policy*/,
                         cleanup_list* cleanup) noexcept try {
    return make_caster<Named>::from_cpp(Named::from(settings), rv_policy::move, cleanup);
  } catch (python_error& error) {
    error.restore();
    return {};
  }
};

}  // namespace nanobind::detail

namespace posemix::python {

template <>
struct SettingValue<ObjectSlamSettings> {
  using Value = ObjectSlamSettings;
  static nb::object get(const Value& value) { return nb::cast(value); }
  static Value set(nb::handle value, const std::string& /*name*/) { return nb::cast<Value>(value); }
  static bool same(const Value& a, const Value& b) { return get(a).equal(get(b)); }
  static std::string text(const Value& value) { return nb::repr(get(value)).c_str(); }
  static nb::object frozen(const Value& value) {
    return python::frozen(NamedSlamSettings::from(value));
  }
};

}  // namespace posemix::python
