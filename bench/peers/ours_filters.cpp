// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors

// Merges, a frame of the Gaussian-sum filter, and frames of the multi-object filter.
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "ours.hpp"
#include "posemix/base/units.hpp"
#include "posemix/filter/gaussian_sum_filter.hpp"
#include "posemix/filter/multi_object_filter.hpp"
#include "posemix/reduction/reduce.hpp"

namespace posemix {
namespace {

std::vector<Component<Hypothesis>> hypotheses(const bench::Jobs& jobs, const std::string& name) {
  const auto weights = jobs.input(name + "_weights");
  const auto poses = poses_of(jobs.input(name + "_poses"));
  const auto covariances = jobs.input(name + "_covariances");
  const std::size_t each = poses.size() / weights.size();
  const auto n = static_cast<Eigen::Index>(6 * each);
  std::vector<Component<Hypothesis>> result;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const auto first = poses.begin() + static_cast<std::ptrdiff_t>(i * each);
    const std::vector<SE3d> mean(first, first + static_cast<std::ptrdiff_t>(each));
    const Eigen::Map<const RowMajor> covariance(&covariances[i * 36 * each * each], n, n);
    result.push_back({std::log(weights[i]), Hypothesis(PoseStackd(mean), covariance)});
  }
  return result;
}

std::vector<double> numbers_of(const Hypothesis& h) {
  std::vector<double> numbers;
  for (const SE3d& pose : h.mean()) append(numbers, pose);
  append(numbers, h.covariance());
  return numbers;
}

void merge_jobs(bench::Jobs& jobs) {
  for (const int n : {12, 36, 66, 126}) {
    const std::string name = "merge_" + std::to_string(n);
    if (!jobs.wants(name)) continue;
    const auto pair = hypotheses(jobs, name);
    const auto work = [&] { return merge<PoseStackd>(pair).component.density; };
    jobs.run(
        name, 1, [&] { bench::keep(work()); }, [&] { return numbers_of(work()); });
  }
}

/// The published filter's frame (midway-merge paper, section VII-B): prediction, five objects
/// detected at once under two components by each of twelve hypotheses, the merge to twelve, and the
/// summary.
void frame_job(bench::Jobs& jobs) {
  if (!jobs.wants("frame")) return;
  const auto noise = jobs.input("frame_noise");
  const auto weights = jobs.input("frame_noise_weights");
  std::vector<NoiseComponent> parts;
  for (std::size_t k = 0; k < weights.size(); ++k) {
    parts.push_back({weights[k], Matrix6d(Vector6d(&noise[6 * k]).asDiagonal())});
  }
  const DetectorNoise detector(parts);
  const auto seen = poses_of(jobs.input("frame_detections"));
  std::vector<Detection> detections;
  for (std::size_t j = 0; j < seen.size(); ++j) detections.push_back({j + 1, seen[j], &detector});
  const Matrix6d step = Vector6d(jobs.input("frame_step").data()).asDiagonal();
  GaussianSumSettings published;
  published.update = UpdateRule::linearized;
  published.noise_use = NoiseUse::joint;
  published.summary = Summary::merge_two_largest;
  published.reduction = {.prune_below = 0.0, .max_components = 12};
  const GaussianSumFilter filter(Posterior(hypotheses(jobs, "frame")), published);
  const auto work = [&] {
    GaussianSumFilter copy = filter;
    copy.predict([&](Hypothesis h) { return predict_with_odometry(std::move(h), SE3d(), step); });
    copy.update(detections);
    return copy.summarise();
  };
  jobs.run(
      "frame", 1, [&] { bench::keep(work()); }, [&] { return numbers_of(work()); });
}

/// An update of a camera and five objects by detections under the Cauchy loss, one of which is
/// wrong. Only the means are compared.
void robust_job(bench::Jobs& jobs) {
  if (!jobs.wants("robust")) return;
  const auto noise = jobs.input("frame_noise");
  const DetectorNoise detector({{1.0, Matrix6d(Vector6d(noise.data()).asDiagonal())}});
  const auto seen = poses_of(jobs.input("robust_detections"));
  std::vector<Detection> detections;
  for (std::size_t j = 0; j < seen.size(); ++j) detections.push_back({j + 1, seen[j], &detector});
  const auto prior = hypotheses(jobs, "frame").front().density;
  Eigen::MatrixXd independent = Eigen::MatrixXd::Zero(prior.dof(), prior.dof());
  for (std::size_t i = 0; i <= seen.size(); ++i)
    block(independent, i, i) = block(prior.covariance(), i, i);
  GaussianSumSettings settings;
  settings.noise_use = NoiseUse::joint;
  settings.robust_loss = RobustLoss::cauchy;
  const GaussianSumFilter filter(Posterior({{0.0, Hypothesis(prior.mean(), independent)}}),
                                 settings);
  const auto work = [&] {
    GaussianSumFilter copy = filter;
    copy.update(detections);
    return copy.summarise();
  };
  jobs.run(
      "robust", 1, [&] { bench::keep(work()); },
      [&] {
        std::vector<double> result;
        const Hypothesis found = work();
        for (const SE3d& pose : found.mean()) append(result, pose);
        return result;
      });
}

/// The noise of a detector with two components and clutter.
ObjectSensor sensor() {
  const Matrix6d sharp =
      pose_covariance({radians(7.5), radians(7.5), radians(2.0)}, {0.007, 0.007, 0.045});
  return {DetectorNoise({{.weight = 0.65, .covariance = sharp, .frame = NoiseFrame::ray},
                         {.weight = 0.12, .covariance = 7.29 * sharp, .frame = NoiseFrame::ray}},
                        {.weight = 0.23, .volume_m3 = 1.0})};
}

/// A hundred images of so many objects, each of which keeps three modes alive; an item is an image.
void objects_jobs(bench::Jobs& jobs) {
  const auto seen = poses_of(jobs.input("objects_detections"));
  const SE3d motion(SO3d::exp({1e-3, 0.0, 0.0}), {1e-3, 0.0, 0.0});
  const Matrix6d q =
      pose_covariance(Eigen::Vector3d::Constant(radians(0.05)), Eigen::Vector3d::Constant(6e-4));
  for (const std::size_t objects : {1, 5, 10}) {
    const auto work = [&] {
      MultiObjectFilter filter(ConcentratedGaussian<SE3d>(SE3d(), q),
                               std::vector<ObjectSensor>(objects, sensor()), {.max_hypotheses = 8});
      for (std::size_t first = 0; first < seen.size(); first += 10) {
        filter.predict_with_odometry(motion, q, 0.1);
        for (std::size_t j = 0; j < objects; ++j) filter.update(j, seen[first + j]);
      }
      return filter.camera();
    };
    jobs.run(
        "objects_" + std::to_string(objects), seen.size() / 10, [&] { bench::keep(work()); },
        [&] { return flat(std::vector{work()}); });
  }
}

}  // namespace

void filter_jobs(bench::Jobs& jobs) {
  merge_jobs(jobs);
  frame_job(jobs);
  robust_job(jobs);
  objects_jobs(jobs);
}

}  // namespace posemix
