// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "picture_curves.hpp"

#include <algorithm>
#include <cmath>

#include "posemix/base/statistics.hpp"
#include "posemix/base/units.hpp"
#include "position_covariance.hpp"

namespace posemix::internal {
namespace {

constexpr double kPictureMillimetres = 1e3;

/// What the norm of a consistent error exceeds as rarely as a normal variable 3 sigma.
double bound(const Eigen::MatrixXd& covariance) {
  static const double kShare = std::erf(3.0 / std::sqrt(2.0));
  return gaussian_norm_quantile(covariance, kShare);
}

/// Of the axes that can be observed.
std::optional<double> rotation_width_deg(const PoseDensity& density,
                                         const ErrorReduction& reduction) {
  if (reduction.rotation_dof() == 0) return std::nullopt;
  if (reduction.rotation_dof() < 3) return degrees(bound(reduction.rotation_covariance(density)));
  return degrees(bound(density.covariance().topLeftCorner<3, 3>()));
}

/// Collects the curves of one pose.
class CurveMaker {
 public:
  explicit CurveMaker(const ErrorReduction& reduction) : reduction_(reduction) {}

  void add(const std::optional<PoseDensity>& estimate, const std::optional<SE3d>& truth,
           const std::optional<SE3d>& detection) {
    const auto mean = estimate ? std::optional(estimate->mean()) : std::nullopt;
    add_errors(mean, truth, curves_.rotation.estimate, curves_.position.estimate);
    add_errors(detection, truth, curves_.rotation.detector, curves_.position.detector);
    const auto rotation = estimate ? rotation_width_deg(*estimate, reduction_) : std::nullopt;
    curves_.rotation.width.push_back(rotation);
    const auto position =
        estimate ? std::optional(kPictureMillimetres * bound(position_covariance(*estimate)))
                 : std::nullopt;
    curves_.position.width.push_back(position);
  }
  void add_probability(const std::optional<double>& probability) {
    curves_.mode_probability.push_back(probability);
  }
  PoseCurves take() { return std::move(curves_); }

 private:
  void add_errors(const std::optional<SE3d>& pose, const std::optional<SE3d>& truth,
                  Curve& rotation, Curve& position) const {
    if (!pose || !truth) {
      rotation.emplace_back();
      position.emplace_back();
      return;
    }
    const SE3d nearest = reduction_.nearest(*truth, *pose);
    rotation.emplace_back(degrees((pose->rotation() * nearest.rotation().inverse()).log().norm()));
    position.emplace_back(kPictureMillimetres *
                          (pose->translation() - nearest.translation()).norm());
  }

  ErrorReduction reduction_;
  PoseCurves curves_;
};

}  // namespace

PoseCurves object_curves(const SlamJob& job, const SlamRun& run, std::size_t object) {
  CurveMaker maker{ErrorReduction(job.models[object].symmetries)};
  for (std::size_t k = 0; k < run.frames.size(); ++k) {
    const FrameEstimate& frame = run.frames[k];
    maker.add(frame.relative[object], true_relative_pose(job.sequence, object, k),
              job.sequence.objects[object].detections[k]);
    const bool is_told = object < frame.mode_probabilities.size();
    maker.add_probability(is_told ? frame.mode_probabilities[object] : std::nullopt);
  }
  return maker.take();
}

PoseCurves camera_curves(const SlamJob& job, const SlamRun& run) {
  CurveMaker maker{ErrorReduction()};
  for (std::size_t k = 0; k < run.frames.size(); ++k) {
    const bool is_known = k < job.sequence.camera_truth.size();
    maker.add(run.frames[k].camera, is_known ? job.sequence.camera_truth[k] : std::nullopt, {});
  }
  return maker.take();
}

bool has_values(const Curve& curve) {
  return std::any_of(curve.begin(), curve.end(),
                     [](const std::optional<double>& value) { return value.has_value(); });
}

}  // namespace posemix::internal
