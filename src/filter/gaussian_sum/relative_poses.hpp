// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <span>
#include <vector>

#include "posemix/filter/iterated_update.hpp"
#include "symmetric_products.hpp"

/// The relative poses that detections depend on, and their estimation by iteration. Dim is six
/// times the number of detections: 6, or dynamic.
namespace posemix::internal {

/// One detection of the relative pose Z = T_o^-1 T_R = Exp(zeta) mean. In its model Log(Z detected)
/// is noise.
struct RelativePose {
  std::size_t object;
  SE3d mean;
  TwistMatrix<double> to_object;  ///< Ad(T_o^-1)
  SE3d detected;                  ///< Y offset^-1
  const NoiseComponent* component;
  Matrix6d whitener;  ///< L^-1 for the component's covariance L L^T, in its own axes
};

/// The prior of the relative poses, zeta_j = Ad(T_j^-1) (xi_R - xi_j) =: (D xi)_j.
template <int Dim>
struct RelativePrior {
  std::vector<RelativePose> poses;
  Tall<Dim> cross;         ///< P D^T
  Square<Dim> covariance;  ///< D P D^T
  Eigen::LLT<Square<Dim>> factor;

  RelativePrior(const Hypothesis& prior, std::span<const Detection> detections,
                std::span<const NoiseComponent* const> noise);

  Eigen::Index size() const { return offset(poses.size()); }

  /// matrix D^T
  Tall<Dim> times_dt(const Eigen::MatrixXd& matrix) const;
};

/// The solution of the iteration.
template <int Dim>
struct RelativePosterior {
  Vector<Dim> zeta;        ///< the solution, in the tangent space at the prior mean
  Square<Dim> covariance;  ///< in the same tangent space
  double log_likelihood;
  bool ok;
};

/// Gauss-Newton on zeta^T P^-1 zeta + n^T R^-1 n, with R turned to each iterate. At the solution
/// P^-1 zeta + M^T R^-1 n = 0.
template <int Dim>
RelativePosterior<Dim> estimate(const RelativePrior<Dim>& prior,
                                const IteratedUpdateSettings& settings);

extern template struct RelativePrior<kPoseDof>;
extern template struct RelativePrior<Eigen::Dynamic>;
extern template RelativePosterior<kPoseDof> estimate(const RelativePrior<kPoseDof>&,
                                                     const IteratedUpdateSettings&);
extern template RelativePosterior<Eigen::Dynamic> estimate(const RelativePrior<Eigen::Dynamic>&,
                                                           const IteratedUpdateSettings&);

}  // namespace posemix::internal
