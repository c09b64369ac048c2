// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "plausibility.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "posemix/io/text.hpp"

namespace posemix::internal {
namespace {

/// Detectors of tags are good to 0.05 to 1 px, with motion blur to some pixels.
constexpr double kMostNoise = 3.0;
constexpr double kLeastNoise = 0.001;
/// Printed tags have edges of some millimetres to some metres.
constexpr double kLeastSize = 0.003;
constexpr double kMostSize = 3.0;
/// Principal points are near the middle of the image: its size is about twice their coordinates.
constexpr double kMostOfPrincipalPoint = 3.0;
constexpr double kMargin = 1.05;       ///< of an image whose size is known
constexpr double kMostOutside = 0.05;  ///< share of corners

constexpr const char* kCauses =
    "are intrinsics and distortion those of this camera at this resolution, and is the order of "
    "the corners right (--order, FiducialSettings.order)?";

/// Root mean square of the two coordinates of eight that the pose leaves over, the median over the
/// sightings [px].
double typical_residual(std::span<const std::vector<TagMinimum>> minima) {
  std::vector<double> errors;
  for (const std::vector<TagMinimum>& of_sighting : minima)
    if (!of_sighting.empty()) errors.push_back(of_sighting.front().squared_error);
  if (errors.empty()) return 0.0;
  const auto middle = errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2);
  std::nth_element(errors.begin(), middle, errors.end());
  return std::sqrt(*middle / 2.0);
}

/// The farthest corner that can be one [px].
Eigen::Vector2d farthest_corner(const RigCamera& camera) {
  if (const auto& size = camera.resolution)
    return kMargin * Eigen::Vector2d((*size)[0], (*size)[1]);
  return kMostOfPrincipalPoint * camera.model.intrinsics.tail<2>();
}

/// Share of the corners that lie beyond the image.
double share_outside(const CornersOfCamera& seen) {
  const Eigen::Vector2d farthest = farthest_corner(seen.camera);
  if (seen.corners.empty() || !(farthest.minCoeff() > 0.0)) return 0.0;
  std::size_t outside = 0;
  for (const TagCorners& corners : seen.corners) {
    for (const Eigen::Vector2d& corner : corners)
      outside += (corner.array() > farthest.array()).any() ? 1 : 0;
  }
  return static_cast<double>(outside) / (4.0 * static_cast<double>(seen.corners.size()));
}

std::vector<std::string> doubts_about_stated(const CornersOfCamera& seen) {
  const CornerNoise& noise = seen.noise.noise;
  const std::string camera = in_quotes(seen.camera.name);
  std::vector<std::string> doubts;
  if (!(noise.sd_px >= kLeastNoise && noise.sd_px <= kMostNoise)) {
    doubts.push_back(fmt::format(
        "the stated noise of the corners of camera {} is {:.3g} px, expected {:g} to {:g} px",
        camera, noise.sd_px, kLeastNoise, kMostNoise));
  }
  if (noise.dof < kLeastCornerDof) {
    doubts.push_back(
        fmt::format("the stated noise of the corners of camera {} has {:.3g} degrees of freedom, "
                    "expected at least {:g}",
                    camera, noise.dof, kLeastCornerDof));
  }
  return doubts;
}

}  // namespace

std::vector<std::string> doubts_about_corners(const CornersOfCamera& seen) {
  std::vector<std::string> doubts;
  if (seen.minima.empty()) return doubts;
  if (seen.noise.source == CornerNoiseSource::given) doubts = doubts_about_stated(seen);
  const std::string camera = in_quotes(seen.camera.name);
  const double residual = typical_residual(seen.minima);
  const bool learned = seen.noise.source == CornerNoiseSource::own;
  const double found = learned ? std::max(residual, seen.noise.noise.sd_px) : residual;
  if (found > kMostNoise) {
    doubts.push_back(fmt::format(
        "the corners of camera {} are those of a square tag to {:.3g} px only, expected "
        "at most {:g} px: {}",
        camera, found, kMostNoise, kCauses));
  }
  if (share_outside(seen) > kMostOutside) {
    const Eigen::Vector2d farthest = farthest_corner(seen.camera);
    doubts.push_back(fmt::format(
        "corners of camera {} lie beyond the image, expected none beyond ({:g}, {:g}) px with its "
        "resolution or principal point: {}",
        camera, farthest.x(), farthest.y(), kCauses));
  }
  return doubts;
}

std::vector<std::string> doubts_about_sizes(std::span<const double> sizes_m) {
  std::vector<std::string> doubts;
  if (sizes_m.empty()) return doubts;
  const auto [least, most] = std::minmax_element(sizes_m.begin(), sizes_m.end());
  if (*most > kMostSize) {
    doubts.push_back(fmt::format(
        "a tag has an edge of {:g} m, expected {:g} to {:g} m: are the sizes in millimetres?",
        *most, kLeastSize, kMostSize));
  }
  if (*least < kLeastSize) {
    doubts.push_back(fmt::format(
        "a tag has an edge of {:g} m, expected {:g} to {:g} m: are the sizes in another unit?",
        *least, kLeastSize, kMostSize));
  }
  return doubts;
}

std::vector<std::string> doubts_about_order(const Fiducials& found) {
  if (2 * found.without_pose <= found.sightings - found.ignored - found.without_size) return {};
  return {
      fmt::format("the corners of {} of {} sightings are no image of a tag's front: is the order "
                  "of the corners "
                  "right (--order, FiducialSettings.order), or are the images mirrored?",
                  found.without_pose, found.sightings)};
}

}  // namespace posemix::internal
