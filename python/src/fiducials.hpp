// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include "posemix/fiducial/tag_pose.hpp"
#include "setting_value.hpp"

namespace posemix::python {

/// Four corners as an array.
struct CornersAsArray {
  using Corners = Eigen::Matrix<double, 4, 2>;
  using Matrix = SettingValue<Corners>;
  static Corners matrix_of(const TagCorners& corners) {
    Corners matrix;
    for (std::size_t i = 0; i < corners.size(); ++i)
      matrix.row(static_cast<Eigen::Index>(i)) = corners[i].transpose();
    return matrix;
  }
  static nb::object get(const TagCorners& corners) { return Matrix::get(matrix_of(corners)); }
  static TagCorners set(nb::handle value, const std::string& name) {
    const Corners matrix = Matrix::set(value, name);
    TagCorners corners;
    for (std::size_t i = 0; i < corners.size(); ++i)
      corners[i] = matrix.row(static_cast<Eigen::Index>(i)).transpose();
    return corners;
  }
  static bool same(const TagCorners& a, const TagCorners& b) { return a == b; }
  static std::string text(const TagCorners& corners) { return Matrix::text(matrix_of(corners)); }
};

void bind_fiducial_files(nb::module_& m);

}  // namespace posemix::python
