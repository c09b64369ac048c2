// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include "posemix/density/concentrated_gaussian.hpp"
#include "posemix/detector/detector_noise.hpp"
#include "posemix/mixture/log_weights.hpp"
#include "posemix/mixture/mixture.hpp"

/// The posterior that MultiObjectFilter approximates, without its approximations: one dense
/// Gaussian over camera and objects for every tuple of hypotheses, none of which is ever merged or
/// dropped. It is independent of the library's filter: only the groups, the noise model and the
/// mixtures are shared.
namespace posemix::testing {

class ExhaustiveFilter {
 public:
  struct Tuple {
    std::vector<int> hypothesis;  ///< of every object; -1: absent
    std::vector<SE3d> poses;      ///< camera, then the objects (identity where absent)
    Eigen::MatrixXd covariance;
    double log_weight = 0.0;
  };

  ExhaustiveFilter(const SE3d& camera, const Matrix6d& covariance, std::size_t objects,
                   DetectorNoise noise, double explained)
      : noise_(std::move(noise)), explained_(explained), hypotheses_(objects, 0) {
    Tuple start{std::vector<int>(objects, -1), std::vector<SE3d>(objects + 1), {}, 0.0};
    start.poses[0] = camera;
    start.covariance.setZero(dim(), dim());
    start.covariance.topLeftCorner<6, 6>() = covariance;
    tuples_.push_back(start);
  }

  void predict(const SE3d& motion, const Matrix6d& q) {
    for (Tuple& tuple : tuples_) {
      tuple.poses[0] = tuple.poses[0] * motion;
      const Matrix6d adjoint = tuple.poses[0].adjoint();
      tuple.covariance.topLeftCorner<6, 6>() += adjoint * q * adjoint.transpose();
    }
  }

  void update(std::size_t object, const SE3d& detected) {
    double least = std::numeric_limits<double>::infinity();
    std::vector<Tuple> next;
    for (const Tuple& tuple : tuples_) {
      if (tuple.hypothesis[object] < 0) continue;
      next.push_back(tuple);
      least = std::min(least, condition(next.back(), object, detected));
    }
    const double volume = 8.0 * std::numbers::pi * std::numbers::pi * noise_.clutter().volume_m3;
    const int id = hypotheses_[object];
    if (least >= explained_) ++hypotheses_[object];
    for (const Tuple& tuple : tuples_) {
      if (tuple.hypothesis[object] >= 0) continue;
      next.push_back(tuple);
      next.back().log_weight += noise_.log_clutter_density();
      if (least < explained_) continue;
      next.push_back(born(tuple, object, id, detected));
      next.back().log_weight += std::log(1.0 - noise_.clutter().weight) - std::log(volume);
    }
    tuples_ = std::move(next);
    std::vector<double> weights;
    for (const Tuple& tuple : tuples_) weights.push_back(tuple.log_weight);
    const double total = log_sum_exp(weights);
    for (Tuple& tuple : tuples_) tuple.log_weight -= total;
    std::erase_if(tuples_, [](const Tuple& tuple) { return tuple.log_weight < -5000.0; });
  }

  std::size_t size() const { return tuples_.size(); }

  /// The marginal of the camera (pose 0), or of an object given that it exists.
  Mixture<ConcentratedGaussian<SE3d>> marginal(std::size_t pose) const {
    std::vector<Component<ConcentratedGaussian<SE3d>>> components;
    const auto at = static_cast<Eigen::Index>(6 * pose);
    for (const Tuple& tuple : tuples_) {
      if (pose > 0 && tuple.hypothesis[pose - 1] < 0) continue;
      components.push_back(
          {tuple.log_weight, {tuple.poses[pose], Matrix6d(tuple.covariance.block<6, 6>(at, at))}});
    }
    return Mixture<ConcentratedGaussian<SE3d>>(std::move(components));
  }

 private:
  Eigen::Index dim() const { return 6 * static_cast<Eigen::Index>(hypotheses_.size() + 1); }

  /// World-frame noise of a component along the camera's axes at the object.
  Matrix6d world_noise(const NoiseComponent& component, const SE3d& camera,
                       const SE3d& object) const {
    const NoiseComponent along = along_camera(component, camera.inverse() * object);
    const Matrix6d adjoint = SE3d(camera.rotation(), object.translation()).adjoint();
    return adjoint * along.covariance * adjoint.transpose();
  }

  /// Conditions the tuple on a detection, by the moments of its children (inlier, wide, clutter).
  /// Returns the least squared distance.
  double condition(Tuple& tuple, std::size_t object, const SE3d& detected) const {
    const SE3d& camera = tuple.poses[0];
    const SE3d& pose = tuple.poses[object + 1];
    const auto at = 6 * static_cast<Eigen::Index>(object + 1);
    Eigen::MatrixXd h = Eigen::MatrixXd::Zero(6, dim());
    h.leftCols<6>() = -Matrix6d::Identity();
    h.middleCols<6>(at) = Matrix6d::Identity();
    const Vector6d z = (camera * detected * pose.inverse()).log();
    const Eigen::MatrixXd& p = tuple.covariance;
    std::vector<double> evidence;
    std::vector<Eigen::VectorXd> means;
    std::vector<Eigen::MatrixXd> covariances;
    double least = std::numeric_limits<double>::infinity();
    for (const NoiseComponent& component : noise_.components()) {
      const Matrix6d s = h * p * h.transpose() + world_noise(component, camera, pose);
      const Matrix6d inverse = s.inverse();
      const double squared = z.dot(inverse * z);
      least = std::min(least, squared);
      evidence.push_back(std::log(component.weight) -
                         0.5 * (squared + std::log(s.determinant()) + 6.0 * kLogTwoPi));
      const Eigen::MatrixXd k = p * h.transpose() * inverse;
      means.emplace_back(k * z);
      covariances.emplace_back(p - k * h * p);
    }
    evidence.push_back(noise_.log_clutter_density());
    means.emplace_back(Eigen::VectorXd::Zero(dim()));
    covariances.push_back(p);
    const double total = log_sum_exp(evidence);
    Eigen::VectorXd mean = Eigen::VectorXd::Zero(dim());
    Eigen::MatrixXd second = Eigen::MatrixXd::Zero(dim(), dim());
    for (std::size_t i = 0; i < evidence.size(); ++i) {
      const double weight = std::exp(evidence[i] - total);
      mean += weight * means[i];
      second += weight * (covariances[i] + means[i] * means[i].transpose());
    }
    tuple.covariance = second - mean * mean.transpose();
    for (std::size_t i = 0; i < tuple.poses.size(); ++i)
      tuple.poses[i] =
          SE3d::exp(Vector6d(mean.segment<6>(6 * static_cast<Eigen::Index>(i)))) * tuple.poses[i];
    tuple.log_weight += total;
    return least;
  }

  Tuple born(const Tuple& parent, std::size_t object, int id, const SE3d& detected) const {
    Tuple tuple = parent;
    tuple.hypothesis[object] = id;
    tuple.poses[object + 1] = tuple.poses[0] * detected;
    const auto at = 6 * static_cast<Eigen::Index>(object + 1);
    tuple.covariance.middleRows<6>(at) = tuple.covariance.topRows<6>();
    tuple.covariance.middleCols<6>(at) = tuple.covariance.leftCols<6>();
    tuple.covariance.block<6, 6>(at, at) = parent.covariance.topLeftCorner<6, 6>() +
                                           mode_noise(tuple.poses[0], tuple.poses[object + 1]);
    return tuple;
  }

  /// The covariance of all components together, none of which has an offset.
  Matrix6d mode_noise(const SE3d& camera, const SE3d& object) const {
    Matrix6d sum = Matrix6d::Zero();
    for (const NoiseComponent& component : noise_.components())
      sum += component.weight * world_noise(component, camera, object);
    return sum / (1.0 - noise_.clutter().weight);
  }

  DetectorNoise noise_;
  double explained_;
  std::vector<int> hypotheses_;  ///< begun so far, by object
  std::vector<Tuple> tuples_;
};

}  // namespace posemix::testing
