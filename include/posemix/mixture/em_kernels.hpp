// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "posemix/mixture/em_rows.hpp"

/// The inner loops of EM over the samples of one block, with the widest vector instructions of the
/// machine. All of them read and write whole vectors: entries of a row beyond `count` are scratch.
namespace posemix::internal {

/// The parameters of a projected Gaussian in the inner loops.
struct ProjectedKernel {
  std::size_t dimensions;                            ///< of y: 3 on SO(3), 6 on SE(3)
  std::array<double, 4> tangent_point;               ///< x y z w
  std::array<double, 3> translation;                 ///< mean of t, zero on SO(3)
  std::array<double, 3> u;                           ///< mean of u
  std::array<std::array<double, 6>, 6> factor;       ///< L^-1, P = L L^T
  std::array<std::array<double, 6>, 3> precision_u;  ///< first rows of P^-1
  double log_constant;
};

/// Computes y = [u; t] less its mean, in as many rows, and the log density of every sample; zero
/// and -inf if the rotation has no coordinates u.
void projected_log_density(const EmRow* samples, std::size_t count, const ProjectedKernel& density,
                           EmRow* y, EmRow& out);

/// Adds the weighted moments of rows y to the sums; see em_second_moment.
void add_moments(std::size_t n, const EmRow* y, const EmRow& shares, std::size_t count,
                 double* sums);

/// Adds sum share u (u . (P^-1 y)_u) to three sums, sum share u.u (u . (P^-1 y)_u) to a fourth.
void add_projected_gradient(const EmRow* y, const EmRow& shares, std::size_t count,
                            const ProjectedKernel& density, double* sums);

/// The parameters of a concentrated Gaussian on SO(3) in the inner loops.
struct RotationKernel {
  std::array<double, 4> rotation;               ///< the mean, x y z w
  std::array<std::array<double, 6>, 6> factor;  ///< L^-1, P = L L^T, in the first three rows
  double log_constant;
};

/// Computes the log density of every sample.
void rotation_log_density(const EmRow* samples, std::size_t count, const RotationKernel& density,
                          EmRow& out);

/// The parameters of a concentrated Gaussian on SE(3) in the inner loops.
struct PoseKernel {
  std::array<double, 4> rotation;                  ///< rotation of the mean, x y z w
  std::array<double, 3> translation;               ///< translation of the mean
  std::array<std::array<double, 6>, 6> factor;     ///< L^-1, P = L L^T
  std::array<std::array<double, 6>, 6> precision;  ///< P^-1
  double log_constant;
};

/// The rows that pose_log_density writes: xi, (t/2) / sin(t/2) for the angle t, the coefficient D
/// of second order of the inverse Jacobian (small_angle.hpp), and xi^T P^-1 xi.
enum PoseRow : std::size_t { kXi = 0, kRatio = 6, kSecondOrder = 7, kSquared = 8, kPoseRows = 9 };

/// Computes xi = Log(X X0^-1) and the other rows, and the log density of every sample.
void pose_log_density(const EmRow* samples, std::size_t count, const PoseKernel& density,
                      EmRow* rows, EmRow& out);

/// The number of sums of add_pose_gradient: three for each half of the gradient, and two weighted
/// sums of xi with six entries each, which are multiplied by P^-1 afterwards.
inline constexpr std::size_t kPoseGradientSums = 18;

/// Adds the terms of the gradient that are not linear in the second moments of xi.
void add_pose_gradient(const EmRow* rows, const EmRow& shares, std::size_t count,
                       const PoseKernel& density, double* sums);

/// The parameters of a Gaussian on R^n in the inner loops.
struct RnKernel {
  std::vector<double> mean;
  std::vector<double> factor;  ///< L^-1, P = L L^T: its lower triangle, row by row
  double log_constant;
};

/// Computes the log density of every sample. n is any; up to 6 all intermediate results are in
/// registers.
void rn_log_density(const EmRow* samples, std::size_t count, const RnKernel& density, EmRow& out);

/// Adds the weighted moments of the samples less the mean to the sums; see em_second_moment.
void add_rn_moments(const EmRow* samples, const EmRow& shares, std::size_t count,
                    const RnKernel& density, double* sums);

}  // namespace posemix::internal
