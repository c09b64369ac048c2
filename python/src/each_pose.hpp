// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <utility>

#include "poses.hpp"

namespace posemix::python {

/// f(x_i, y_i) for two arrays of poses, of which one may be a single pose.
template <class Function>
PoseArray each_pose(const PoseArray& x, const PoseArray& y, Function f) {
  if (x.shape != y.shape && !x.shape.empty() && !y.shape.empty())
    throw InvalidInput(fmt::format("{} poses and {}; expected one shape", x.size(), y.size()));
  const PoseArray& longer = x.shape.empty() ? y : x;
  NewArray out({longer.size(), 7});
  for (std::size_t i = 0; i < longer.size(); ++i) {
    const SE3d pose = f(x[x.shape.empty() ? 0 : i], y[y.shape.empty() ? 0 : i]);
    Wire<SE3d>::write(pose, out.data + 7 * i);
  }
  return PoseArray::of(std::move(out.array), longer.shape);
}

}  // namespace posemix::python
