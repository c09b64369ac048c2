// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <vector>

#include "posemix/divergence/so3_quadrature.hpp"
#include "ray_kernels.hpp"

namespace posemix::internal {

/// One weighted component, prepared for many evaluations.
struct RotationPeak {
  double weight;
  Eigen::Quaterniond mean;
  Eigen::Matrix3d root;    ///< P = root root^T
  Eigen::Matrix3d whiten;  ///< the inverse of root
  double log_scale;        ///< log weight - (3 log 2 pi + log det P) / 2

  explicit RotationPeak(const Component<ConcentratedGaussian<SO3d>>& component);
};

/// The components with a weight above zero.
std::vector<RotationPeak> rotation_peaks(const RotationDensity& density);

/// The components of two mixtures.
struct RotationPair {
  std::vector<RotationPeak> p;
  std::vector<RotationPeak> q;
};

/// Log densities of two mixtures along the geodesic X(r) = Exp(r n) C.
///
/// With C the mean of a component, the quaternion of X(r) mean_j^-1 is cos(r/2) A_j + sin(r/2) B_j
/// for two fixed quaternions, so that every log costs one arc tangent.
class RotationRay {
 public:
  struct LogDensities {
    double p;
    double q;
  };

  /// The pair must outlive the ray, which has no direction so far.
  explicit RotationRay(const RotationPair& pair);

  /// Begins a ray at a rotation C with a unit direction n.
  void begin(const Eigen::Quaterniond& start, const Eigen::Vector3d& direction);

  /// The reference of the kernel that evaluates a block: exact to a few units in the last place.
  LogDensities at(double r) const;
  void evaluate(double stretch, RayBlock& block) {
    ray_log_densities(peaks_.data(), of_p_, peaks_.size(), stretch, block, scratch_.data());
  }

  /// Appends the radii inside (0, end) at which the integrand is not smooth, or changes quickly
  /// because of features that are narrow compared with `scale`.
  void append_breaks(double end, double scale, std::vector<double>& breaks) const;

 private:
  /// Vector parts of A and B.
  struct Vectors {
    Eigen::Vector3d a, b;
  };

  double log_density(std::size_t first, std::size_t last, double cosine, double sine) const;

  const RotationPair* pair_;
  std::size_t of_p_;
  std::vector<RayPeak> peaks_;  ///< the components of p, then those of q
  std::vector<Vectors> vectors_;
  std::vector<double> scratch_;
};

}  // namespace posemix::internal
