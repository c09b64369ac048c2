// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "map_pairs.hpp"

#include <limits>
#include <utility>

#include "posemix/base/statistics.hpp"
#include "posemix/lie/pose_blocks.hpp"

namespace posemix::internal {
namespace {

constexpr int kMostFitSteps = 12;
constexpr double kFitTolerance = 1e-10;

}  // namespace

MapSide::MapSide(const MultiObjectSlam& slam, double least_existence)
    : slam_(slam),
      camera_information_(
          Eigen::CompleteOrthogonalDecomposition<Matrix6d>(slam.filter().camera().covariance())
              .pseudoInverse()) {
  for (std::size_t j = 0; j < slam.objects().size(); ++j) {
    std::vector<ObjectHypothesis>& own = hypotheses_.emplace_back();
    if (slam.moving().has(j) || slam.existence(j).value_or(0.0) < least_existence) continue;
    own = slam.hypotheses(j);
  }
}

Matrix6d MapSide::covariance(std::size_t object, std::size_t h, std::size_t other,
                             std::size_t k) const {
  const ObjectHypothesis& a = hypotheses_[object][h];
  const ObjectHypothesis& b = hypotheses_[other][k];
  if (object == other && h == k) return a.covariance;
  if (leads(object, h) && leads(other, k))
    return block(slam_.estimate().covariance(), *slam_.pose_index(object),
                 *slam_.pose_index(other));
  return a.cross_covariance * camera_information_ * b.cross_covariance.transpose();
}

PairsFit::PairsFit(const MapSide& old_map, const MapSide& now, SE3d start,
                   std::vector<MapPair> pairs)
    : old_(&old_map), now_(&now), new_old_(std::move(start)), pairs_(std::move(pairs)) {
  for (int step = 0; step < kMostFitSteps; ++step) {
    linearise();
    if (!is_solved_) return;
    new_old_ = SE3d::exp(tau_) * new_old_;
    if (tau_.norm() < kFitTolerance) break;
  }
  linearise();
}

Vector6d PairsFit::residual(const MapPair& pair) const {
  const ObjectHypothesis& before = old_->hypotheses(pair.old_object)[pair.old_hypothesis];
  const ObjectHypothesis& after = now_->hypotheses(pair.new_object)[pair.new_hypothesis];
  const SE3d expected = new_old_ * before.pose;
  const SymmetryGroup& symmetries = now_->model(pair.new_object).symmetries;
  SE3d nearest = after.pose;
  if (!symmetries.is_trivial()) {
    const Matrix6d along_object = after.pose.inverse().adjoint_congruence(error(pair, pair));
    nearest = symmetries.closest_observed(after.pose, expected, along_object.inverse());
  }
  return (nearest * expected.inverse()).log();
}

Matrix6d PairsFit::error(const MapPair& a, const MapPair& b) const {
  const Matrix6d before =
      old_->covariance(a.old_object, a.old_hypothesis, b.old_object, b.old_hypothesis);
  const Matrix6d adjoint = new_old_.adjoint();
  return adjoint * before * adjoint.transpose() +
         now_->covariance(a.new_object, a.new_hypothesis, b.new_object, b.new_hypothesis);
}

void PairsFit::linearise() {
  const auto n = pairs_.size();
  Eigen::MatrixXd errors(offset(n), offset(n));
  residuals_.resize(offset(n));
  for (std::size_t i = 0; i < n; ++i) {
    segment(residuals_, i) = residual(pairs_[i]);
    for (std::size_t k = 0; k < n; ++k) block(errors, i, k) = error(pairs_[i], pairs_[k]);
  }
  const Eigen::MatrixXd symmetric = 0.5 * (errors + errors.transpose());
  factor_.compute(symmetric);
  const Matrix6d identity = Matrix6d::Identity();
  solved_ = factor_.solve(identity.replicate(static_cast<Eigen::Index>(n), 1));
  Matrix6d information = Matrix6d::Zero();
  Vector6d sum = Vector6d::Zero();
  for (std::size_t i = 0; i < n; ++i) {
    information += rows(solved_, i);
    sum += rows(solved_, i).transpose() * segment(residuals_, i);
  }
  const Eigen::LLT<Matrix6d> own(Matrix6d(0.5 * (information + information.transpose())));
  is_solved_ = factor_.info() == Eigen::Success && own.info() == Eigen::Success;
  if (!is_solved_) return;
  covariance_ = own.solve(identity);  // eq. (3)
  tau_ = own.solve(sum);
  log_det_ = log_det(factor_) + log_det(own);
}

std::pair<Vector6d, Matrix6d> PairsFit::given(const Eigen::MatrixXd& cross,
                                              const Matrix6d& own) const {
  Eigen::VectorXd left = residuals_;
  for (std::size_t i = 0; i < pairs_.size(); ++i) segment(left, i) -= tau_;
  const Matrix6d kept = Matrix6d::Identity() - cross.transpose() * solved_;
  const Matrix6d covariance =
      own - cross.transpose() * factor_.solve(cross) + kept * covariance_ * kept.transpose();
  return {tau_ + cross.transpose() * factor_.solve(left),
          0.5 * (covariance + covariance.transpose())};
}

PairPrediction PairsFit::predict(const MapPair& pair) const {
  Eigen::MatrixXd cross(offset(pairs_.size()), 6);
  for (std::size_t i = 0; i < pairs_.size(); ++i) rows(cross, i) = error(pairs_[i], pair);
  const auto [mean, covariance] = given(cross, error(pair, pair));
  const Eigen::LLT<Matrix6d> factor(covariance);
  if (factor.info() != Eigen::Success) {
    constexpr double kUnbounded = std::numeric_limits<double>::infinity();
    return {kUnbounded, -kUnbounded};
  }
  const Vector6d difference = residual(pair) - mean;
  return {difference.dot(factor.solve(difference)), log_normal(factor, difference)};
}

// With V = C^-1 - C^-1 A P A^T C^-1, the residual that the others leave of pair k is
// V_kk^-1 (V r)_k, and V_kk^-1 is its covariance.
std::vector<double> PairsFit::left_out() const {
  const std::size_t n = pairs_.size();
  if (n == 1) return {0.0};
  const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(offset(n), offset(n));
  const Eigen::MatrixXd v =
      Eigen::MatrixXd(factor_.solve(identity)) - solved_ * covariance_ * solved_.transpose();
  const Eigen::VectorXd weighted = v * residuals_;
  std::vector<double> squared;
  for (std::size_t k = 0; k < n; ++k) {
    const Eigen::LDLT<Matrix6d> own(Matrix6d(block(v, k, k)));
    squared.push_back(segment(weighted, k).dot(own.solve(segment(weighted, k))));
  }
  return squared;
}

double PairsFit::log_evidence() const {
  const auto free = static_cast<double>(residuals_.size() - kPoseDof);
  const Eigen::VectorXd left = residuals_ - tau_.replicate(residuals_.size() / kPoseDof, 1);
  const double squared = left.dot(factor_.solve(left));
  return -0.5 * (squared + log_det_ + free * kLogTwoPi);
}

RelocatedPose PairsFit::relocated(std::size_t old_object, std::size_t h) const {
  const Matrix6d adjoint = new_old_.adjoint();
  Eigen::MatrixXd cross(offset(pairs_.size()), 6);
  Eigen::MatrixXd camera(offset(pairs_.size()), 6);
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    const MapPair& pair = pairs_[i];
    rows(cross, i) = adjoint *
                     old_->covariance(pair.old_object, pair.old_hypothesis, old_object, h) *
                     adjoint.transpose();
    rows(camera, i) = now_->hypotheses(pair.new_object)[pair.new_hypothesis].cross_covariance;
  }
  const ObjectHypothesis& known = old_->hypotheses(old_object)[h];
  const auto [mean, covariance] =
      given(cross, Matrix6d(adjoint * known.covariance * adjoint.transpose()));
  // The error is Ad_T xi_old - L e, and e has that of the camera by -eta alone.
  const Matrix6d kept = Matrix6d::Identity() - cross.transpose() * solved_;
  const Eigen::MatrixXd l =
      factor_.solve(cross).transpose() + kept * covariance_ * solved_.transpose();
  const Matrix6d with_camera = l * camera;
  const Matrix6d common = with_camera * now_->camera_information() * with_camera.transpose();
  return {{SE3d::exp(mean) * new_old_ * known.pose, covariance},
          covariance - 0.5 * (common + common.transpose())};
}

}  // namespace posemix::internal
