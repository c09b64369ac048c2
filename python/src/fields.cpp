// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "fields.hpp"

namespace posemix::python {
namespace {

std::string replaced(std::string text, const std::string& old, const std::string& by) {
  const auto at = text.find(old);
  if (at != std::string::npos) text.replace(at, old.size(), by);
  return text;
}

}  // namespace

std::string argument_type(const std::string& type) {
  // The group of a density is no pose.
  if (type.find("[posemix.lie.SE3]") != std::string::npos) return type;
  return replaced(type, "posemix.lie.SE3", "posemix.lie.SE3 | numpy.typing.ArrayLike");
}

std::string attribute_type(const std::string& type) {
  return replaced(type, "numpy.typing.ArrayLike", kFloatArray);
}

}  // namespace posemix::python
