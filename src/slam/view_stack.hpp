// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "posemix/density/concentrated_gaussian.hpp"
#include "posemix/detector/symmetry.hpp"

/// Poses of one object from several views whose errors are correlated.
namespace posemix::internal {

/// What one view says in one case: Y = Exp(e) X of the object's pose X, with the error
/// e = F b + n of the normalised slow error b ~ N(0, I) and the white error n. Perturbations are on
/// the left, in a frame with the axes of the world near the object.
struct ViewTerm {
  SE3d pose;                        ///< Y
  Matrix6d white;                   ///< covariance of n
  Matrix6d slow_factor;             ///< F; zero without a slow error
  bool has_own_slow = false;        ///< b is independent of that of the other views
  bool is_turned = false;           ///< only the position is observed, the orientation is any
  Eigen::Vector3d camera_position;  ///< from which the view is
  double stamp_s = 0.0;
  double log_prior = 0.0;  ///< of the case, with the density of what is not in e [nats]
};

/// The lengths over which slow errors are correlated.
struct ViewCorrelation {
  double angle_rad;
  double time_s;
};

/// The joint Gaussian of the errors of some terms, about a reference pose.
///
/// Residuals z = H xi + e of X = Exp(xi) X_ref are whitened with the Cholesky factor of the errors'
/// joint covariance, which grows by a block per term. The log evidence is that of a pose uniform
/// over the group, with density one.
class ViewStack {
 public:
  explicit ViewStack(const ViewCorrelation& correlation) : correlation_(correlation) {}

  /// Appends a term; of equivalent poses the one nearest to the reference.
  void add(const ViewTerm& term, const SymmetryGroup& symmetries);

  bool is_empty() const { return rows_.empty(); }
  /// Whether a term tells the orientation.
  bool has_orientation() const { return has_orientation_; }
  /// Log of the integral of the product of the terms' densities over all poses [nats].
  double log_evidence() const;
  /// The maximum of the product of the densities, with the inverse of the information there. Where
  /// no term tells the orientation it is that of the reference with the variance of a uniform
  /// angle.
  ConcentratedGaussian<SE3d> solve() const;

 private:
  struct Row {
    ViewTerm term;
    SE3d pose;  ///< the equivalent one
    Eigen::Index begin;
    Eigen::Index size;
  };
  using Design = Eigen::Matrix<double, Eigen::Dynamic, 6>;

  Eigen::MatrixXd cross_covariance(const Row& row) const;
  void append(const Row& row);
  double correlation(const ViewTerm& a, const ViewTerm& b) const;

  ViewCorrelation correlation_;
  std::vector<Row> rows_;
  SE3d reference_;
  bool has_orientation_ = false;
  Eigen::MatrixXd factor_;    ///< lower Cholesky factor of the errors' covariance
  Design design_;             ///< whitened
  Eigen::VectorXd residual_;  ///< whitened
};

}  // namespace posemix::internal
