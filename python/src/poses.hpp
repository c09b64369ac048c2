// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nanobind/stl/string.h>

#include "arrays.hpp"

/// Conversions of poses from and to the package's class SE3, which has one pose or an array of
/// them.
namespace posemix::python {

/// The class posemix.lie.SE3.
inline nb::object pose_class() { return nb::module_::import_("posemix.lie").attr("SE3"); }

/// An SE3 of any shape; `rows` are its poses in C order.
struct PoseArray {
  Rows rows;
  std::vector<std::size_t> shape;
  nb::object made;  ///< the Python object of an array that was made in C++

  std::size_t size() const { return rows.shape(0); }
  SE3d operator[](std::size_t i) const { return Wire<SE3d>::read(rows.data() + 7 * i); }
  std::vector<SE3d> poses() const { return elements_of<SE3d>(rows, "poses"); }

  static PoseArray of(const std::vector<SE3d>& poses) {
    NewArray out({poses.size(), 7});
    for (std::size_t i = 0; i < poses.size(); ++i) Wire<SE3d>::write(poses[i], out.data + 7 * i);
    return of(std::move(out.array), {poses.size()});
  }
  static PoseArray of(Array rows, std::vector<std::size_t> shape) {
    nb::list lengths;
    for (const std::size_t n : shape) lengths.append(n);
    PoseArray result;
    result.made = pose_class().attr("_wrap")(std::move(rows), nb::tuple(lengths));
    result.shape = std::move(shape);
    return result;
  }
};

/// One pose, of an SE3 or a homogeneous matrix.
/// @throws ValueError or TypeError of Python, naming the argument `name`
inline SE3d pose_of(nb::handle value, const std::string& name) {
  const nb::object pose = nb::module_::import_("posemix._poses").attr("one_pose")(value, name);
  return Wire<SE3d>::read(nb::cast<Rows>(pose.attr("_rows")()).data());
}

/// Poses as rows of seven numbers, of NaN for a miss.
inline Rows pose_rows(nb::handle value, const std::string& name) {
  return nb::cast<Rows>(nb::module_::import_("posemix._poses").attr("pose_rows")(value, name));
}

using MaybePoses = std::vector<std::optional<SE3d>>;

/// Rows of seven numbers; of NaN for a miss.
MaybePoses maybe_poses(const Rows& rows, const std::string& name);
Array rows_of(const MaybePoses& poses);

}  // namespace posemix::python

namespace nanobind::detail {

template <>
struct type_caster<posemix::SE3d> {
  NB_TYPE_CASTER(posemix::SE3d, const_name("posemix.lie.SE3"))

  bool from_python(handle source, std::uint8_t /*flags*/, cleanup_list* /*cleanup*/) noexcept try {
    if (!isinstance(source, posemix::python::pose_class())) return false;
    const auto row = nanobind::cast<posemix::python::Rows>(source.attr("_rows")());
    if (nanobind::len(nanobind::handle(object(source.attr("shape")))) != 0) return false;
    value = posemix::python::Wire<posemix::SE3d>::read(row.data());
    return true;
  } catch (...) {
    return false;
  }

  static handle from_cpp(const posemix::SE3d& pose, rv_policy /*policy*/,
                         cleanup_list* /*cleanup*/) noexcept try {
    const object wrap = posemix::python::pose_class().attr("_wrap");
    return wrap(posemix::python::array_of(pose), nanobind::tuple()).release();
  } catch (python_error& error) {
    error.restore();
    return {};
  }
};

template <>
struct type_caster<posemix::python::PoseArray> {
  NB_TYPE_CASTER(posemix::python::PoseArray, const_name("posemix.lie.SE3"))

  bool from_python(handle source, std::uint8_t /*flags*/, cleanup_list* /*cleanup*/) noexcept try {
    if (!isinstance(source, posemix::python::pose_class())) return false;
    value.rows = nanobind::cast<posemix::python::Rows>(source.attr("_rows")());
    value.shape.clear();
    for (const handle n : source.attr("shape"))
      value.shape.push_back(nanobind::cast<std::size_t>(n));
    return true;
  } catch (...) {
    return false;
  }

  static handle from_cpp(const posemix::python::PoseArray& poses, rv_policy /*policy*/,
                         cleanup_list* /*cleanup*/) noexcept {
    return object(poses.made).release();
  }
};

}  // namespace nanobind::detail
