// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <string>

#include "setting_value.hpp"

namespace posemix::python {

/// Three numbers, or one that stands for all.
struct Sides : SettingValue<Eigen::Vector3d> {
  static Eigen::Vector3d set(nb::handle value, const std::string& name) {
    const nb::module_ numpy = nb::module_::import_("numpy");
    if (!numpy.attr("ndim")(value).equal(nb::int_(0)))
      return SettingValue<Eigen::Vector3d>::set(value, name);
    return Eigen::Vector3d::Constant(nb::cast<double>(nb::float_(value)));
  }
};

}  // namespace posemix::python
