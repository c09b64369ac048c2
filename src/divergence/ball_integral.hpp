// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <optional>
#include <vector>

#include "ball_centre.hpp"
#include "rotation_ray.hpp"
#include "sphere_cubature.hpp"
#include "trapezoidal_ball.hpp"

namespace posemix::internal {

/// The radius of integration about a peak in standard deviations; 5e-18 of its mass lies beyond.
inline constexpr double kRadius = 9.0;

/// The peaks about which to integrate, and their weights in the sum.
enum class Centres {
  of_p,        ///< the peaks of p
  difference,  ///< the peaks of p, and those of q with negative weights
  mean         ///< the peaks of p and q, with half their weights
};

/// One divergence of one pair of mixtures as a sum of integrals over tangent balls: by trapezoidal
/// rules where the integrand is smooth in the whole ball, otherwise along rays.
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

  const RayIntegral& total() const { return total_; }
  /// Refines where the error is largest; `error` is wanted.
  void refine(double error);

 private:
  /// A ball in which the integrand is smooth, and its centre.
  struct SmoothBall {
    std::size_t k;
    TrapezoidalBall rule;
  };

  /// A part of a ray, in standard deviations.
  struct Piece {
    double from;
    double to;
    RayIntegral integral;
  };

  static Eigen::Matrix3d symmetric_root(const RotationPeak& peak, const Eigen::Vector3d& axis);
  double solid_weight() const;
  void add_balls(bool axisymmetric, double tolerance);
  void sum_up();
  std::vector<SphereFeature> features(std::size_t k) const;
  void begin_pieces(double stretch, double end);
  RayIntegral along_ray(std::size_t k, const Eigen::Vector3d& u);
  RayIntegral piece(double stretch, double from, double to);

  const RotationPair& pair_;
  Integrand integrand_;
  double inner_tolerance_;
  double ray_tolerance_ = 0.0;
  std::vector<BallCentre> centres_;
  std::vector<SmoothBall> smooth_;
  // Of the ray at hand.
  RotationRay ray_;
  std::vector<double> breaks_;
  std::vector<Piece> pieces_;
  SphereCubature cubature_;
  std::size_t abandoned_ = 0;  ///< evaluations by rules that did not converge
  RayIntegral total_;
};

/// The weighted sum of the Gaussian masses beyond |xi| = pi of the peaks of q, less that of p.
RayIntegral missing_mass_gap(const RotationPair& pair, double tolerance);

}  // namespace posemix::internal
