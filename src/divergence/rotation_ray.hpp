// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <vector>

#include "posemix/divergence/so3_quadrature.hpp"

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

  RotationRay(const RotationPair& pair, const Eigen::Quaterniond& start,
              const Eigen::Vector3d& direction);

  LogDensities at(double r) const;

  /// Appends the radii inside (0, end) at which the integrand is not smooth, or changes quickly
  /// because of features that are narrow compared with `scale`.
  void append_breaks(double end, double scale, std::vector<double>& breaks) const;

 private:
  struct Peak {
    double a_scalar, b_scalar;
    Eigen::Vector3d a, b;              ///< vector parts of A and B
    Eigen::Vector3d white_a, white_b;  ///< the same, whitened
    double log_scale;
  };

  static double log_density(const Peak* first, const Peak* last, double cosine, double sine);

  std::vector<Peak> peaks_;  ///< the components of p, then those of q
  std::size_t of_p_;
};

}  // namespace posemix::internal
