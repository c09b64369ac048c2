// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "posemix/density/concentrated_gaussian.hpp"
#include "posemix/io/mixture_file.hpp"

/// TUM trajectories with a covariance behind every pose.
namespace posemix {

/// A pose with its covariance at a time.
struct StampedDensity {
  double stamp = 0.0;  ///< seconds
  ConcentratedGaussian<SE3d> density;
};

/// The error of a pose that a covariance is of.
enum class ErrorSide {
  left,   ///< xi in X = Exp(xi) X0, the convention of the library: in the frame that the pose is in
  right,  ///< delta in X = X0 Exp(delta): in the frame of the body
  fixed   ///< phi, dt in R = Exp(phi) R0, t = t0 + dt: about and along the axes of the frame that
          ///< the pose is in, at the body, as in a ROS PoseWithCovariance
};

/// The words of ErrorSide in options.
template <>
inline constexpr WordTable<ErrorSide, 3> words<ErrorSide>{{
    {"left", ErrorSide::left},
    {"right", ErrorSide::right},
    {"fixed", ErrorSide::fixed},
}};

/// What the covariances of a file are of, in radians and metres.
struct CovarianceConvention {
  ErrorSide side = ErrorSide::left;
  TangentOrder order = TangentOrder::rotation_translation;

  /// ROS, geometry_msgs/PoseWithCovariance: fixed axes, translation first.
  static CovarianceConvention ros() {
    return {ErrorSide::fixed, TangentOrder::translation_rotation};
  }
};

/// The covariance of the left perturbation, rotation first, from one in another convention.
Matrix6d left_covariance(const SE3d& pose, const Matrix6d& covariance,
                         const CovarianceConvention& convention);

/// Reads lines `stamp tx ty tz qx qy qz qw` followed by the covariance: the 21 numbers of its upper
/// triangle row by row, or all 36. Otherwise as parse_tum.
/// @throws InvalidInput `name:line: got ..., expected ...`, also for a covariance that is not
/// symmetric (to 1e-6 of its largest entry) positive definite
std::vector<StampedDensity> parse_tum_covariance(std::string_view text, const std::string& name,
                                                 const CovarianceConvention& convention = {});

/// Reads a file as parse_tum_covariance reads a text.
std::vector<StampedDensity> read_tum_covariance(const std::filesystem::path& path,
                                                const CovarianceConvention& convention = {});

/// The text of poses with the upper triangles of their covariances, in the convention of the
/// library: poses as format_tum writes them, covariances with 12 digits.
std::string format_tum_covariance(std::span<const StampedDensity> frames);

}  // namespace posemix
