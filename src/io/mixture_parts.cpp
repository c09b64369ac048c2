// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "mixture_parts.hpp"

#include <algorithm>

#include "posemix/base/units.hpp"

namespace posemix::internal {
namespace {

Matrix6d scaled(const Matrix6d& covariance, double rotation, double translation) {
  Vector6d scale;
  scale << Eigen::Vector3d::Constant(rotation), Eigen::Vector3d::Constant(translation);
  return scale.asDiagonal() * covariance * scale.asDiagonal();
}

Matrix6d with_halves_swapped(const Matrix6d& covariance) {
  Matrix6d swapped;
  swapped << covariance.bottomRightCorner<3, 3>(), covariance.bottomLeftCorner<3, 3>(),
      covariance.topRightCorner<3, 3>(), covariance.topLeftCorner<3, 3>();
  return swapped;
}

double radians_per_unit(AngleUnit unit) { return unit == AngleUnit::deg ? kRadPerDeg : 1.0; }

}  // namespace

double metres_per_unit(LengthUnit unit) { return unit == LengthUnit::mm ? 1e-3 : 1.0; }

Matrix6d stated_covariance(const Matrix6d& covariance, const MixtureConvention& convention) {
  const Matrix6d in_units = scaled(covariance, 1.0 / radians_per_unit(convention.angle),
                                   1.0 / metres_per_unit(convention.length));
  return convention.order == TangentOrder::rotation_translation ? in_units
                                                                : with_halves_swapped(in_units);
}

Matrix6d plain_covariance(const Matrix6d& stated, const MixtureConvention& convention) {
  const Matrix6d ordered =
      convention.order == TangentOrder::rotation_translation ? stated : with_halves_swapped(stated);
  return scaled(ordered, radians_per_unit(convention.angle), metres_per_unit(convention.length));
}

bool is_position(const Eigen::Vector3d& translation) {
  return translation.allFinite() && translation.cwiseAbs().maxCoeff() <= kFarthestPosition;
}

bool is_frame_name(std::string_view name) {
  const auto printable = [](char c) { return c > ' ' && c < '\x7f'; };
  return !name.empty() && name.size() <= kLongestFrameName &&
         std::all_of(name.begin(), name.end(), printable);
}

}  // namespace posemix::internal
