// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "posemix/base/words.hpp"
#include "posemix/filter/iterated_update.hpp"
#include "posemix/filter/predict.hpp"
#include "posemix/filter/robust_update.hpp"
#include "posemix/reduction/reduce.hpp"

namespace posemix {

/// The joint posterior of the camera and all objects.
using Posterior = Mixture<Hypothesis>;

/// How the components of a detector's noise are combined over the objects seen in one frame.
enum class NoiseUse {
  joint,  ///< one component is chosen for all visible objects together (the midway paper's filter)
  per_object,  ///< one component for every object, the objects processed one after another with a
               ///< reduction after each
  most_likely  ///< as per_object, but every hypothesis keeps only its child of the largest weight:
               ///< with one hypothesis the max-mixture of Olson and Agarwal (2013). A new object
               ///< enters by its detector's heaviest component.
};

/// The words of NoiseUse in files and options.
template <>
inline constexpr WordTable<NoiseUse, 3> words<NoiseUse>{{
    {"per_object", NoiseUse::per_object},
    {"joint", NoiseUse::joint},
    {"most_likely", NoiseUse::most_likely},
}};

/// How one hypothesis is updated.
enum class UpdateRule {
  linearized,  ///< by `update`, linearized at the prior mean (the midway paper's filter)
  iterated     ///< by `iterated_update`, consistent also when the odometry is worse than the
               ///< detector
};

/// The words of UpdateRule in files and options.
template <>
inline constexpr WordTable<UpdateRule, 2> words<UpdateRule>{{
    {"linearized", UpdateRule::linearized},
    {"iterated", UpdateRule::iterated},
}};

/// What is reported as the estimate.
enum class Summary {
  best,               ///< the hypothesis of the largest weight
  merge_two_largest,  ///< the merge of the two hypotheses of the largest weights (the midway
                      ///< paper's filter)
  whole_mixture       ///< the merge of all hypotheses
};

/// The words of Summary in files and options.
template <>
inline constexpr WordTable<Summary, 3> words<Summary>{{
    {"best", Summary::best},
    {"merge_two_largest", Summary::merge_two_largest},
    {"whole_mixture", Summary::whole_mixture},
}};

/// Settings of the filter.
struct GaussianSumSettings {
  NoiseUse noise_use = NoiseUse::per_object;
  UpdateRule update = UpdateRule::iterated;
  RobustLoss robust_loss = RobustLoss::none;
  double cauchy_scale = kCauchyScale;  ///< scale of RobustLoss::cauchy, in standard deviations
  /// A detection is left out when its squared Mahalanobis distance exceeds this quantile of the
  /// chi-square distribution with six degrees of freedom for every hypothesis and noise component;
  /// 1 turns the gate off.
  double gate_probability = 1.0;
  Summary summary = Summary::whole_mixture;
  ReductionSettings reduction;
  std::size_t first_object =
      1;  ///< index of the first object's pose: 2 where the motion is part of the state
};

/// The status of every detection of an update, in the order given, and its diagnostics.
struct UpdateReport {
  std::vector<bool> gated;  ///< whether the gate left the detection out
  /// Whether the detection was left out because an innovation covariance was not positive definite.
  std::vector<bool> failed;
  /// z^T S^-1 z of the heaviest hypothesis before each detection, under the noise component that
  /// explains it best, of six degrees of freedom; none where no S is positive definite.
  std::vector<std::optional<double>> nis = {};
  double log_evidence = 0.0;  ///< log of the summed likelihood of the detections used [nats]
  std::vector<ReductionReport> reductions;  ///< one for joint use, otherwise one per used detection
  double update_seconds = 0.0;
  double reduce_seconds = 0.0;
};

/// The Gaussian-sum invariant EKF (midway-merge paper, Algorithm 1): predict, update, reduce,
/// summarise.
///
/// Invariants: every hypothesis holds the same poses in the same order, pose 0 is the camera; every
/// covariance is symmetric positive definite; weights are normalised logarithms.
class GaussianSumFilter {
 public:
  /// Starts from a prior, usually one hypothesis that holds the camera alone.
  /// @throws InvalidInput when a setting is out of range, as check_pose and check_variances for the
  /// prior, and when a pose is more than 100 km from the origin
  GaussianSumFilter(Posterior prior, GaussianSumSettings settings);

  /// Moves every hypothesis, for example by predict_with_odometry. If `motion` throws, the filter
  /// stays as it was.
  /// @throws InvalidInput as check_pose for what `motion` returns, when the covariance of that is
  /// not finite, or hypotheses differ in their number of poses; the filter stays as it was
  void predict(const std::function<Hypothesis(Hypothesis)>& motion);

  /// Every hypothesis gets one child per noise component, is updated, and the mixture is reduced.
  /// @throws InvalidInput when a detection names the camera, a pose that does not exist or one
  /// named twice, as check_pose for its pose, when a prior is 3e6 times as wide as the noise, or
  /// joint use finds components that differ in number or weight; the filter stays as it was
  UpdateReport update(std::span<const Detection> detections);
  /// Only the checks of `update`.
  /// @throws InvalidInput as `update`
  void check(std::span<const Detection> detections) const;

  /// A new object enters every hypothesis with its full cross-covariance, one child per noise
  /// component, and the mixture is reduced. Returns the index of its pose.
  /// @throws InvalidInput as check_pose
  std::size_t add_object(const SE3d& camera_object, const DetectorNoise& noise);

  /// A new object enters every hypothesis at T_R camera_object with an error that is independent of
  /// all others, the covariance in the world frame. Returns the index of its pose.
  /// @throws InvalidInput as check_pose, and when the covariance is none
  std::size_t add_independent_object(const SE3d& camera_object, const Matrix6d& covariance);

  const Posterior& posterior() const { return posterior_; }
  const GaussianSumSettings& settings() const { return settings_; }

  /// One Gaussian in place of the posterior.
  Hypothesis summarise() const;

 private:
  /// Does this with the origin of the world near the scene, and puts it back; all stays as it was
  /// where the result says that nothing has changed.
  template <class Work, class Changed>
  auto near_the_scene(const Work& work, const Changed& has_changed);
  UpdateReport updated_by(std::span<const Detection> detections);
  std::size_t with_new_object(const SE3d& camera_object, const DetectorNoise& noise);
  bool branch(std::span<const Detection> detections, UpdateReport& report);
  void reduce(UpdateReport& report);

  Posterior posterior_;
  GaussianSumSettings settings_;
  double gate_;
};

}  // namespace posemix
