// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <array>
#include <limits>
#include <vector>

#include <Eigen/Core>

#include "posemix/base/linear.hpp"
#include "posemix/base/words.hpp"
#include "posemix/detector/observation.hpp"
#include "posemix/fiducial/camera_model.hpp"
#include "posemix/lie/lie.hpp"

/// The poses of a square tag from its four corners in one image.
///
/// The frame of a tag is that of TagSLAM and of OpenCV's IPPE_SQUARE: the origin is at its centre,
/// x points to the right and y up on the printed tag, z out of it towards the viewer. AprilTag's
/// own frame (x right, y down, z into the tag) is this one turned by pi about x.
namespace posemix {

/// The order in which a detector states the corners; "left" and "up" are those of the printed tag.
enum class CornerOrder {
  apriltag,  ///< AprilTag and TagSLAM: bottom left, bottom right, top right, top left
  aruco      ///< OpenCV's ArUco detector: top left, top right, bottom right, bottom left
};

/// The words of CornerOrder in files and options.
template <>
inline constexpr WordTable<CornerOrder, 2> words<CornerOrder>{{
    {"apriltag", CornerOrder::apriltag},
    {"aruco", CornerOrder::aruco},
}};

/// Four corners in distorted pixels [px].
using TagCorners = std::array<Eigen::Vector2d, 4>;

/// The corners of `order` in the order of AprilTag.
TagCorners in_apriltag_order(const TagCorners& corners, CornerOrder order);

/// The corners in the frame of a tag with edges of `size` metres, in the order of AprilTag.
std::array<Eigen::Vector3d, 4> tag_points(double size);

/// A local minimum of the reprojection error.
struct TagMinimum {
  SE3d pose = {};            ///< T_camera_tag
  double squared_error = 0;  ///< sum over both coordinates of the four corners [px^2]
  /// J^T J of the eight coordinates with respect to n of T_camera_tag Exp(n) (rotation [rad] first,
  /// then m), at one pixel of noise [px^2].
  Matrix6d information = Matrix6d::Zero();
};

/// The local minima of the squared reprojection error in distorted pixels, sorted by their error:
/// two for most views of a planar square, one where the tag is near and turned towards the camera.
/// None when the corners are no image of the front of a square (on one line, clockwise) or no
/// minimum has full rank. The search starts from the two poses of weak perspective and is Levenberg
/// and Marquardt's.
/// @param corners in the order of AprilTag, which is counter-clockwise in the image
/// @param size edge of the tag [m]
/// @throws InvalidInput when a corner is not finite, the size not positive, or as
/// validate(CameraModel)
std::vector<TagMinimum> tag_minima(const TagCorners& corners, double size,
                                   const CameraModel& camera);

/// The noise of the coordinates of corners. The four corners of one sighting share a variance s^2;
/// dof sd_px^2 / s^2 is chi-squared with `dof` degrees of freedom, so that a coordinate is
/// Student's t: sightings with motion blur, or at a badly calibrated place of the image, have
/// larger errors.
struct CornerNoise {
  double sd_px = 1.0;                                    ///< scale of one coordinate [px]
  double dof = std::numeric_limits<double>::infinity();  ///< infinite: normal
};

/// The posterior of a tag's pose under a flat prior (that of Haar and Lebesgue), as components with
/// weight, pose and covariance, the heaviest first.
///
/// With m = J^T J, E the squared error, and nu = dof, the normal approximation at minimum k
/// integrates over the pose and over the variance of the sighting to
///   weight_k ~ |m_k|^(-1/2) (nu sd^2 + E_k)^(-(nu + 2) / 2),
///   covariance_k = m_k^-1 (nu sd^2 + E_k) / nu,
/// which for infinite nu are exp(-E_k / (2 sd^2)) |m_k|^(-1/2) and m_k^-1 sd^2. Of the eight
/// coordinates six are spent on the pose, so that two speak for one minimum against the other. The
/// factor |m|^(-1/2) is the width of a peak: the mass of a peak is its height times its width.
/// @param least_weight components with less are left out, and the others make up for them
/// @throws InvalidInput for a noise that is not positive
std::vector<ObservationComponent> tag_components(const std::vector<TagMinimum>& minima,
                                                 const CornerNoise& noise,
                                                 double least_weight = 1e-6);

/// Adds an error of the bearing to the covariances of poses T_camera_tag: a rotation of the camera
/// about its centre of standard deviation `sd_rad` about each axis. All corners of a sighting share
/// it, so that no reprojection error shows it; it comes from calibrations and from stamps.
/// @throws InvalidInput for a deviation that is negative or not finite
void add_bearing_error(std::vector<ObservationComponent>& components, double sd_rad);

}  // namespace posemix
