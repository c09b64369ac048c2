// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "joint_gaussian.hpp"

#include <array>

#include "posemix/filter/update.hpp"

namespace posemix::internal {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Alternatives of less weight do not change the rows of the leading hypothesis beyond rounding.
constexpr double kNegligibleWeight = 1e-7;

}  // namespace

Matrix6d regression_on_camera(const Matrix6d& cross_covariance, const Matrix6d& camera) {
  const Eigen::LLT<Matrix6d> factor(camera);
  return factor.solve(cross_covariance.transpose()).transpose();
}

Pair JointGaussian::pair(std::size_t object) const {
  Pair result{poses_[kCamera], poses_[object], {}};
  result.covariance.topLeftCorner<6, 6>() = block(covariance_, kCamera, kCamera);
  result.covariance.bottomRightCorner<6, 6>() = block(covariance_, object, object);
  result.covariance.bottomLeftCorner<6, 6>() = block(covariance_, object, kCamera);
  result.covariance.topRightCorner<6, 6>() = block(covariance_, kCamera, object);
  return result;
}

MatrixXd JointGaussian::rows_of(std::size_t index) const { return rows(covariance_, index); }

MatrixXd JointGaussian::regressed_rows(const Matrix6d& cross_covariance) const {
  const Matrix6d by = regression_on_camera(cross_covariance, covariance(kCamera, kCamera));
  return by * rows(covariance_, kCamera);
}

std::size_t JointGaussian::append(const SE3d& pose, const Matrix6d& covariance,
                                  const Matrix6d& cross_covariance) {
  const std::size_t index = poses_.size();
  poses_.push_back(pose);
  const Index n = offset(index);
  covariance_.conservativeResize(n + kPoseDof, n + kPoseDof);
  replace(index, pose, covariance, cross_covariance);
  return index;
}

void JointGaussian::replace(std::size_t index, const SE3d& pose, const Matrix6d& covariance,
                            const Matrix6d& cross_covariance) {
  // B_j. = P_OC P_CC^-1 B_C.
  poses_[index] = pose;
  const Matrix6d by = regression_on_camera(cross_covariance, this->covariance(kCamera, kCamera));
  for (std::size_t k = 0; k < poses_.size(); ++k) {
    if (k == index) continue;
    const Matrix6d row =
        k == kCamera ? cross_covariance : Matrix6d(by * block(covariance_, kCamera, k));
    block(covariance_, index, k) = row;
    block(covariance_, k, index) = row.transpose();
  }
  block(covariance_, index, index) = covariance;
}

void JointGaussian::erase(std::size_t index) {
  poses_.erase(poses_.begin() + static_cast<std::ptrdiff_t>(index));
  std::vector<Index> kept;
  const Index at = offset(index);
  for (Index i = 0; i < covariance_.rows(); ++i) {
    if (i < at || i >= at + kPoseDof) kept.push_back(i);
  }
  covariance_ = MatrixXd(covariance_(kept, kept));
}

void JointGaussian::set_rows(std::size_t index, const SE3d& pose, const MatrixXd& values) {
  poses_[index] = pose;
  columns(covariance_, index) = values.transpose();
  rows(covariance_, index) = values;
}

void JointGaussian::regress(std::span<const std::size_t> indices, const VectorXd& mean,
                            const MatrixXd& covariance, VectorXd& all_mean,
                            MatrixXd& all_covariance) const {
  // G = B_.I B_II^-1, mu = G m, B* = B + G (P - B_II) G^T.
  const Index n = covariance_.rows();
  const Index m = offset(indices.size());
  MatrixXd columns_of(n, m);
  MatrixXd prior(m, m);
  for (std::size_t k = 0; k < indices.size(); ++k)
    columns(columns_of, k) = columns(covariance_, indices[k]);
  for (std::size_t k = 0; k < indices.size(); ++k) rows(prior, k) = rows(columns_of, indices[k]);
  const MatrixXd g = prior.llt().solve(columns_of.transpose()).transpose();
  all_mean.noalias() = g * mean;
  const MatrixXd change = g * (covariance - prior);
  all_covariance = covariance_;
  all_covariance.noalias() += change * g.transpose();
}

Vector6d JointGaussian::update(std::size_t index, const PairMoments& leading,
                               const CameraAlternative& alternative) {
  const Index n = covariance_.rows();
  VectorXd mean(n);
  MatrixXd b;
  // Under the leading hypothesis, eq. (5).
  regress(std::array{kCamera, index}, leading.mean, leading.covariance, mean, b);
  if (alternative.weight < kNegligibleWeight) {
    covariance_ = std::move(b);
    symmetrize(covariance_);
    return move(mean);
  }
  // Under all others, eq. (6).
  VectorXd other_mean(n);
  MatrixXd other;
  regress(std::array{kCamera}, alternative.mean, alternative.covariance, other_mean, other);
  // Projection onto one Gaussian, eq. (7) and (8).
  project(index, alternative.weight, mean, b, other_mean - mean, other);
  return move(mean);
}

void JointGaussian::project(std::size_t index, double w_a, VectorXd& mean, const MatrixXd& b,
                            const VectorXd& apart, const MatrixXd& other) {
  const double w = 1.0 - w_a;
  const Index at = offset(index);
  const Index n = covariance_.rows();
  std::vector<Index> s;
  s.reserve(static_cast<std::size_t>(n - kPoseDof));
  for (Index i = 0; i < n; ++i) {
    if (i < at || i >= at + kPoseDof) s.push_back(i);
  }
  // Everything but the object takes the exact moments of the mixture, eq. (7).
  const VectorXd difference = apart(s);
  const VectorXd shift = w_a * difference;
  MatrixXd b_s = w * b(s, s) + w_a * other(s, s);
  b_s.noalias() += w * w_a * difference * difference.transpose();
  // The object keeps the regression that it has under the leading hypothesis, eq. (8).
  const MatrixXd b_js = b.middleRows(at, kPoseDof)(Eigen::all, s);
  const MatrixXd before = b(s, s);
  const MatrixXd g = before.llt().solve(b_js.transpose()).transpose();
  mean.segment<kPoseDof>(at) += g * shift;
  for (std::size_t i = 0; i < s.size(); ++i) mean(s[i]) += shift(static_cast<Index>(i));
  const MatrixXd row = g * b_s;
  covariance_(s, s) = b_s;
  covariance_.middleRows(at, kPoseDof)(Eigen::all, s) = row;
  covariance_.middleCols(at, kPoseDof)(s, Eigen::all) = row.transpose();
  covariance_.block<kPoseDof, kPoseDof>(at, at) =
      b.block<kPoseDof, kPoseDof>(at, at) + g * (b_s - before) * g.transpose();
  symmetrize(covariance_);
}

Vector6d JointGaussian::move(const VectorXd& mean) {
  for (std::size_t k = 0; k < poses_.size(); ++k)
    poses_[k] = SE3d::exp(mean.segment<kPoseDof>(offset(k))) * poses_[k];
  return mean.head<kPoseDof>();
}

}  // namespace posemix::internal
