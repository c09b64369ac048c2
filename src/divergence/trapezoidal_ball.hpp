// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <vector>

#include "ball_centre.hpp"
#include "sphere_cubature.hpp"
#include "tangent_kernels.hpp"

namespace posemix::internal {

/// The radius in standard deviations beyond which lies far less of a peak than the tolerance.
double trapezoidal_radius(double tolerance);

/// A peak as seen from a centre.
TangentPeak tangent_peak(const BallCentre& centre, const RotationPeak& peak);

/// The integral over the tangent ball of one peak by trapezoidal rules in its whitened coordinates.
///
/// Where the integrand is smooth in the whole ball, it decays like a Gaussian to all sides, and the
/// rules converge exponentially \cite trefethen2014trapezoidal. The error is taken to be the change
/// from the level before, which is that level's; and no less than a share of the change before that
/// one, because a change can be small by accident.
class TrapezoidalBall {
 public:
  /// @param narrowest width of the narrowest feature in standard deviations
  TrapezoidalBall(const RotationPair& pair, const Integrand& integrand, const BallCentre& centre,
                  bool axisymmetric, double radius, double narrowest);

  TrapezoidalBall(const TrapezoidalBall&) = delete;
  TrapezoidalBall& operator=(const TrapezoidalBall&) = delete;
  TrapezoidalBall(TrapezoidalBall&&) = default;
  TrapezoidalBall& operator=(TrapezoidalBall&&) = default;
  ~TrapezoidalBall() = default;

  /// Whether the finest rule is fine enough for features of a width.
  static bool can_resolve(double narrowest, bool axisymmetric);

  const RayIntegral& total() const { return total_; }
  /// Goes to the next level; false if no level is expected to come below the error.
  bool refine(double error);

 private:
  void add_level();
  void add_point(double x, double y, double z, double weight);
  void add_block();
  bool may_reach(double error) const;

  DensityFactor factor_;
  double scale_;
  bool axisymmetric_;
  double radius_;
  int level_;
  double step_ = 0.0;         ///< change from the level before
  double step_before_ = 0.0;  ///< change from that before it
  RayIntegral total_;
  std::vector<TangentPeak> peaks_;
  TangentView view_;
  std::vector<double> scratch_;
  // Sums over the points of the level at hand.
  double value_ = 0.0;
  double absolute_ = 0.0;
  double shell_ = 0.0;
  // Points of it that wait for their evaluation.
  TangentBlock block_;
  Eigen::Array<double, kTangentPoints, 1> weights_;
  std::size_t waiting_ = 0;
};

}  // namespace posemix::internal
