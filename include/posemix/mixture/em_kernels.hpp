// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <array>
#include <cstddef>

#include "posemix/mixture/em_rows.hpp"

/// The inner loops of EM over the samples of one block, with the widest vector instructions that
/// the machine has. All read and write whole vectors: what lies beyond `count` in a row is scratch.
namespace posemix::internal {

/// A projected Gaussian for the loops.
struct ProjectedKernel {
  std::array<double, 4> tangent_point;               ///< x y z w
  std::array<double, 3> translation;                 ///< mean of t, zero on SO(3)
  std::array<double, 3> u;                           ///< mean of u
  std::array<std::array<double, 6>, 6> factor;       ///< L^-1, P = L L^T
  std::array<std::array<double, 6>, 3> precision_u;  ///< first rows of P^-1
  double log_constant;
};

/// y = [u; t] less its mean in n rows and the log density of every sample; zero and -inf where the
/// chart has no point. n is 3 on SO(3), 6 on SE(3).
void projected_log_density(std::size_t n, const EmRow* samples, std::size_t count,
                           const ProjectedKernel& density, EmRow* y, EmRow& out);

/// Adds the weighted moments of rows y to the sums; see em_second_moment.
void add_moments(std::size_t n, const EmRow* y, const EmRow& shares, std::size_t count,
                 double* sums);

/// Adds sum share u (u . (P^-1 y)_u) to three sums, sum share u.u (u . (P^-1 y)_u) to a fourth.
void add_projected_gradient(std::size_t n, const EmRow* y, const EmRow& shares, std::size_t count,
                            const ProjectedKernel& density, double* sums);

/// A concentrated Gaussian on SE(3) for the loops.
struct PoseKernel {
  std::array<double, 4> rotation;                  ///< of the mean, x y z w
  std::array<double, 3> translation;               ///< of the mean
  std::array<std::array<double, 6>, 6> factor;     ///< L^-1, P = L L^T
  std::array<std::array<double, 6>, 6> precision;  ///< P^-1
  double log_constant;
};

/// Rows of pose_log_density: xi, (t/2) / sin(t/2) for the angle t, the coefficient of second order
/// of the inverse Jacobians and xi^T P^-1 xi.
enum PoseRow : std::size_t { kXi = 0, kRatio = 6, kSecondOrder = 7, kSquared = 8, kPoseRows = 9 };

/// xi = Log(X X0^-1) and more in rows, and the log density of every sample.
void pose_log_density(const EmRow* samples, std::size_t count, const PoseKernel& density,
                      EmRow* rows, EmRow& out);

/// Sums of add_pose_gradient: of phi, rho in the gradient along phi (3) and rho (3), and the
/// weighted sums of xi (6 and 6) of which P^-1 takes a part away.
inline constexpr std::size_t kPoseGradientSums = 18;

/// Adds what pose_gradient makes of the rows.
void add_pose_gradient(const EmRow* rows, const EmRow& shares, std::size_t count,
                       const PoseKernel& density, double* sums);

}  // namespace posemix::internal
