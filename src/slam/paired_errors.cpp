// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "paired_errors.hpp"

#include <vector>

#include "posemix/base/statistics.hpp"
#include "posemix/base/units.hpp"

namespace posemix::internal {
namespace {

/// The errors of a pose over some frames.
class ErrorMedians {
 public:
  void add(const SE3d& estimate, const SE3d& truth) {
    positions_.push_back((estimate.translation() - truth.translation()).norm());
    rotations_.push_back(degrees((truth.rotation().inverse() * estimate.rotation()).log().norm()));
  }
  std::size_t count() const { return positions_.size(); }
  PoseMedians medians() const {
    if (positions_.empty()) return {};
    return {median(positions_), median(rotations_)};
  }

 private:
  std::vector<double> positions_;
  std::vector<double> rotations_;
};

}  // namespace

PairedErrors paired_errors(const Sequence& sequence, const SlamRun& run, std::size_t object,
                           const ErrorReduction& reduction) {
  ErrorMedians estimates;
  ErrorMedians detections;
  for (std::size_t k = 0; k < run.frames.size(); ++k) {
    const auto& estimate = run.frames[k].relative[object];
    const auto& detected = sequence.objects[object].detections[k];
    const auto truth = true_relative_pose(sequence, object, k);
    if (!estimate || !detected || !truth) continue;
    estimates.add(estimate->mean(), reduction.nearest(*truth, estimate->mean()));
    detections.add(*detected, reduction.nearest(*truth, *detected));
  }
  return {estimates.count(), estimates.medians(), detections.medians()};
}

}  // namespace posemix::internal
