// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cmath>
#include <optional>
#include <vector>

#include "density_factors.hpp"
#include "rotation_ray.hpp"
#include "sphere_cubature.hpp"

namespace posemix::internal {

/// The radius of integration about a peak in standard deviations; 5e-18 of its mass lies beyond.
inline constexpr double kRadius = 9.0;

/// The peaks about which to integrate, and their weights in the sum.
enum class Centres {
  of_p,        ///< the peaks of p
  difference,  ///< the peaks of p, and those of q with negative weights
  mean         ///< the peaks of p and q, with half their weights
};

/// The rounding error of a log density.
inline constexpr double kLogRounding = 4e-15;

/// An integrand, and how rounding of the log densities reaches it.
struct Integrand {
  DensityFactor factor;
  double scale;      ///< about the largest value of densities in it; 1 for log densities
  bool is_positive;  ///< of second order in the difference of the log densities

  /// The rounding error of a weighted mean of the factor whose absolute value is so large.
  double rounding(double absolute) const {
    if (!is_positive) return kLogRounding * scale;
    return kLogRounding * std::sqrt(2.0 * absolute * scale) + kLogRounding * kLogRounding * scale;
  }
};

/// One divergence of one pair of mixtures as a sum of integrals over tangent balls.
class BallIntegral {
 public:
  /// @param axis common axis of symmetry, if there is one
  BallIntegral(const RotationPair& pair, const Integrand& integrand, Centres centres,
               const std::optional<Eigen::Vector3d>& axis, double tolerance);
  BallIntegral(const BallIntegral&) = delete;
  BallIntegral& operator=(const BallIntegral&) = delete;
  BallIntegral(BallIntegral&&) = delete;
  BallIntegral& operator=(BallIntegral&&) = delete;
  ~BallIntegral() = default;

  const RayIntegral& total() const { return cubature_.total(); }
  void refine() { cubature_.refine(); }

 private:
  /// A peak about which to integrate, and its square root in the coordinates of the sphere.
  struct Centre {
    const RotationPeak* peak;
    double share;
    Eigen::Matrix3d root;
  };

  /// A part of a ray, in standard deviations.
  struct Piece {
    double from;
    double to;
    RayIntegral integral;
  };

  static Eigen::Matrix3d symmetric_root(const RotationPeak& peak, const Eigen::Vector3d& axis);
  double solid_weight() const;
  std::vector<SphereFeature> features(std::size_t k) const;
  void begin_pieces(double stretch, double end);
  RayIntegral along_ray(std::size_t k, const Eigen::Vector3d& u);
  RayIntegral piece(double stretch, double from, double to);

  const RotationPair& pair_;
  Integrand integrand_;
  double inner_tolerance_;
  double ray_tolerance_ = 0.0;
  std::vector<Centre> centres_;
  // Of the ray at hand.
  RotationRay ray_;
  std::vector<double> breaks_;
  std::vector<Piece> pieces_;
  SphereCubature cubature_;
};

/// The weighted sum of the Gaussian masses beyond |xi| = pi of the peaks of q, less that of p.
RayIntegral missing_mass_gap(const RotationPair& pair, double tolerance);

}  // namespace posemix::internal
