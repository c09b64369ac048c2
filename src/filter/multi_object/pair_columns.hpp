// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <Eigen/Core>

#include "base/cholesky6.hpp"
#include "base/dense_kernels.hpp"
#include "detection_update.hpp"

/// The update of a joint Gaussian in the columns of what a detection sees, eq. (26) to (30) of
/// docs/many-objects.md.
namespace posemix::internal {

/// Memory of updates, which a thread keeps for objects of each size.
struct PairWorkspace {
  Eigen::MatrixXd columns;   ///< F, the covariance with [xi_C; y], whitened
  Eigen::MatrixXd weighted;  ///< F Q
  Eigen::MatrixXd ordered;   ///< the covariance with the object last, then its factor
  Eigen::MatrixXd object;    ///< the columns of the object
  Eigen::VectorXd mean;      ///< of all coordinates
  Eigen::VectorXd moved;     ///< a part of it
  Eigen::VectorXd variances;
};

/// An update of a joint covariance, of which the camera has the first coordinates, by a detection
/// of an object with Own coordinates: 6, or 12 with the slow error behind the pose. y = [xi_O -
/// xi_C + A_0 b; b] is what the detection sees, with the slow error as the heaviest component of
/// the noise has it. Columns are whitened, those of xi_C by its covariance and those of y_1 by that
/// of the innovation: far from the origin, or where a slow error is much larger than what is left
/// of the pose, products with inverses would cancel.
template <int Own>
class PairUpdate {
 public:
  /// `object` is the first coordinate of the object, `gain` that of all else.
  PairUpdate(const Eigen::MatrixXd& covariance, Eigen::Index object, const Explanation& leading,
             const GainFactors& gain);

  /// Whether there is an update to take: false where the innovation's covariance is singular.
  [[nodiscard]] bool ok() const { return whitening_.ok(); }
  /// Eq. (5): the covariance under the leading hypothesis alone.
  void take_leading(Eigen::MatrixXd& covariance);
  /// Eq. (5) to (8): the same where the object's other hypotheses, of probability `weight`, give
  /// the camera other moments. False, and nothing has changed, where the covariance is so nearly
  /// singular that this way would lose digits.
  [[nodiscard]] bool take_mixture(double weight, const Vector6d& camera_mean,
                                  const Matrix6d& camera, Eigen::MatrixXd& covariance);

  /// Mean of all coordinates, in the tangent spaces at the means before.
  const Eigen::VectorXd& mean() const { return work_.mean; }
  /// D sum_c a_c S_c^-1 D_C^T with D = P H^T, for the rows of the camera, and for all rows.
  Matrix6d camera_reduction() const;
  void set_reduction_with_camera(MatrixRef rows) const;

 private:
  static constexpr int kAll = 6 + Own;
  using Square = Eigen::Matrix<double, Own, Own>;
  using Wide = Eigen::Matrix<double, Own, kAll>;
  using All = Eigen::Matrix<double, kAll, kAll>;
  using Seen = Eigen::Matrix<double, Own, 1>;

  /// N(g, g'), by which the covariance of rows of gain g with columns of gain g' changes: F N F'^T.
  Square change(double row_gain, double column_gain) const;
  /// Rows of the object in the columns of y, times N for its own gain and that of all else less
  /// another matrix.
  Square object_change(const Square& less) const;
  /// The object's covariance under the leading hypothesis.
  Square object_covariance(const Eigen::MatrixXd& covariance) const;
  /// The object's covariance given everything else; false where that is nearly singular.
  bool given_the_rest(const Eigen::MatrixXd& covariance, Square& own);
  /// Q, eq. (27): everything but the object has B_ss + F_s Q F_s^T.
  All weighting(double weight, const Eigen::Matrix<double, kAll, 1>& apart, const Cholesky6& prior,
                const Matrix6d& camera_change, const Square& n_gg) const;
  /// Eq. (30), with the mean shifted by F `shift`.
  void take_moments(const Eigen::Matrix<double, kAll, 1>& shift, const All& q, const Wide& c_phi,
                    const Square& c_y, Eigen::MatrixXd& covariance);
  /// The covariance less columns * weighted^T, but the object's columns less columns * object^T and
  /// its block `own`.
  void change_covariance(const ConstMatrixRef& columns, const ConstMatrixRef& weighted,
                         const ConstMatrixRef& object, const Square& own,
                         Eigen::MatrixXd& covariance);
  /// Rows of [xi_O - xi_C; b] become those of whitened y.
  Wide whitened(const Wide& rows) const;
  /// Columns of [xi_O - xi_C; b] become those of whitened y.
  Square in_whitened_columns(const Square& m) const;
  auto seen() const { return work_.columns.template rightCols<Own>(); }

  PairWorkspace& work_;
  Eigen::Index object_;
  GainFactors gain_;
  const Innovation& main_;  ///< the heaviest component, 0
  Cholesky6 whitening_;     ///< L_0, of its innovation's covariance
  /// sum_c a_c u_c with u_c = h_c S_c^-1 z_c, h_c = [L_0^T; (A_c - A_0)^T].
  Seen moved_ = Seen::Zero();
  Square reduction_ = Square::Zero();  ///< sum_c a_c h_c S_c^-1 h_c^T
  Square spread_ = Square::Zero();     ///< sum_c a_c u_c u_c^T less that of the mean
};

extern template class PairUpdate<6>;
extern template class PairUpdate<12>;

}  // namespace posemix::internal
