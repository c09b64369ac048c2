// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "trial.hpp"

#include <array>
#include <cmath>
#include <optional>

#include <Eigen/Eigenvalues>

#include "posemix/base/statistics.hpp"
#include "posemix/slam/evaluation.hpp"
#include "posemix/slam/object_slam.hpp"
#include "scene.hpp"

namespace posemix {
namespace {

constexpr double kFrameS = 0.1;
constexpr double kPauseFrameS = 1.0;
/// Parts of a normal distribution within 1, 2 and 3 sigma.
constexpr std::array<double, 3> kWithin{0.6826894921370859, 0.9544997361036416, 0.9973002039367398};

/// An orthonormal basis of the directions that a symmetry leaves observable, along the object's
/// axes.
Eigen::MatrixXd observable(const SymmetryGroup& symmetries) {
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(symmetries.unobserved_covariance());
  Eigen::Index hidden = 0;
  for (const double value : eigen.eigenvalues()) hidden += value > 1e-6 ? 1 : 0;
  return eigen.eigenvectors().leftCols(6 - hidden);
}

class ConsistencySums {
 public:
  explicit ConsistencySums(const SymmetryGroup& symmetries)
      : symmetries_(symmetries), basis_(observable(symmetries)) {
    for (std::size_t i = 0; i < kWithin.size(); ++i)
      bounds_[i] = chi_square_quantile(kWithin[i], static_cast<int>(basis_.cols()), "coverage");
  }

  void add(const PoseDensity& estimate, const SE3d& truth) {
    const SE3d to_body = estimate.mean().inverse();
    const Matrix6d covariance = to_body.adjoint_congruence(estimate.covariance());
    const SE3d nearest = symmetries_.closest_observed(truth, estimate.mean(), covariance.inverse());
    const Eigen::VectorXd e = basis_.transpose() * (to_body * nearest).log();
    const Eigen::MatrixXd p = basis_.transpose() * covariance * basis_;
    const double squared = e.dot(p.llt().solve(e));
    nees_ += squared / static_cast<double>(basis_.cols());
    for (std::size_t i = 0; i < kWithin.size(); ++i) covered_[i] += squared <= bounds_[i] ? 1 : 0;
    ++count_;
  }

  PoseConsistency result() const {
    PoseConsistency result{.count = count_};
    if (count_ == 0) return result;
    const auto n = static_cast<double>(count_);
    result.nees = nees_ / n;
    for (std::size_t i = 0; i < kWithin.size(); ++i) result.covered[i] = covered_[i] / n;
    return result;
  }

 private:
  SymmetryGroup symmetries_;
  Eigen::MatrixXd basis_;
  std::array<double, 3> bounds_{};
  double nees_ = 0.0;
  std::array<double, 3> covered_{};
  std::size_t count_ = 0;
};

ObjectSlam make_slam(const ConsistencyCell& cell, RandomStream& random) {
  const Matrix6d start =
      pose_covariance(Eigen::Vector3d::Constant(radians(0.1)), Eigen::Vector3d::Constant(2e-3));
  const SE3d told = SE3d::exp(draw_error(start, random)).inverse();
  std::vector<ObjectModel> models;
  const std::size_t count = cell.candidates ? cell.objects + 1 : cell.objects;
  models.reserve(count);
  for (std::size_t j = 0; j < count; ++j) {
    models.push_back({.id = fmt::format("{}", j),
                      .noise = detector_of(cell),
                      .symmetries = symmetries_of(cell.shape),
                      .class_id = cell.candidates ? "thing" : ""});
  }
  return {PoseDensity(told, start), std::move(models), {.motion = motion_of(cell)}};
}

/// Detections as candidates of a class.
FrameInput as_candidates(const FrameInput& input, std::size_t models) {
  FrameInput result = input;
  result.detections.assign(models, std::nullopt);
  for (const auto& detected : input.detections) {
    if (detected) result.candidates.push_back({"thing", *detected, 1.0});
  }
  return result;
}

class Trial {
 public:
  Trial(const ConsistencyCell& cell, std::uint64_t seed, std::uint64_t run)
      : cell_(cell),
        random_(seed, 2 * run),
        slam_(make_slam(cell, random_)),
        scene_(cell, RandomStream(seed, 2 * run + 1)),
        symmetries_(symmetries_of(cell.shape)),
        camera_(SymmetryGroup{}),
        object_(symmetries_),
        relative_(symmetries_) {}

  ConsistencyTrial run() {
    for (std::size_t turn = 0; turn < cell_.turns; ++turn) {
      for (double t = 0.0; t < cell_.seen_s - 1e-9; t += kFrameS) step(kFrameS, true);
      if (turn + 1 == cell_.turns) break;
      for (double t = 0.0; t < cell_.pause_s - 1e-9; t += kPauseFrameS) step(kPauseFrameS, false);
      resumed_ = true;
    }
    result_.camera = camera_.result();
    result_.object = object_.result();
    result_.relative = relative_.result();
    const double looks = std::max(1.0, static_cast<double>(looks_));
    result_.mode_probability /= looks;
    result_.right_mode /= looks;
    result_.rotation_deg /= looks;
    result_.position_m /= looks;
    return result_;
  }

 private:
  void step(double dt, bool seen) {
    FrameInput input = scene_.next(dt, seen);
    if (cell_.candidates) input = as_candidates(input, cell_.objects + 1);
    const FrameEstimate estimate = slam_.step(input);
    time_s_ += dt;
    if (cell_.candidates) count_duplicates(estimate);
    next_look_s_ -= dt;
    if (time_s_ < cell_.first_look_s || next_look_s_ > 1e-9) return;
    next_look_s_ = cell_.look_every_s;
    look(estimate);
  }

  /// The first detections after a pause are of instances that are known.
  void count_duplicates(const FrameEstimate& estimate) {
    if (!resumed_ || result_.instances > 0 || estimate.report.candidates.empty()) return;
    for (const CandidateReport& candidate : estimate.report.candidates) {
      ++result_.instances;
      result_.duplicates += candidate.status == CandidateStatus::fresh ? 1 : 0;
    }
  }

  void look(const FrameEstimate& estimate) {
    camera_.add(estimate.camera, scene_.camera());
    for (std::size_t j = 0; j < scene_.objects().size(); ++j) {
      // Of a late object and its neighbour only the late one counts.
      if (cell_.late_s > 0.0 && j + 1 != scene_.objects().size()) continue;
      if (!estimate.relative[j]) continue;
      const SE3d truth = scene_.camera().inverse() * scene_.objects()[j];
      const PoseDensity& relative = *estimate.relative[j];
      ++looks_;
      const SE3d nearest = symmetries_.nearest_rotation(truth, relative.mean());
      result_.rotation_deg +=
          degrees((relative.mean().rotation().inverse() * nearest.rotation()).log().norm());
      result_.position_m += (relative.mean().translation() - truth.translation()).norm();
      result_.mode_probability += *estimate.mode_probabilities[j];
      if (!on_right_mode(relative.mean(), nearest)) continue;
      result_.right_mode += 1.0;
      relative_.add(relative, truth);
      object_.add(*estimate.objects[j], scene_.objects()[j]);
    }
  }

  const ConsistencyCell& cell_;
  RandomStream random_;
  ObjectSlam slam_;
  ConsistencyScene scene_;
  SymmetryGroup symmetries_;
  ConsistencySums camera_;
  ConsistencySums object_;
  ConsistencySums relative_;
  ConsistencyTrial result_;
  double time_s_ = 0.0;
  double next_look_s_ = 0.0;
  bool resumed_ = false;
  std::size_t looks_ = 0;
};

}  // namespace

ConsistencyTrial run_consistency_trial(const ConsistencyCell& cell, std::uint64_t seed,
                                       std::uint64_t run) {
  return Trial(cell, seed, run).run();
}

}  // namespace posemix
