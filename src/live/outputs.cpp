// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "outputs.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace posemix::internal {
namespace {

/// Where an object has no frame in /tf: it is not confirmed, or should be seen and is not.
bool is_in_tf(TrackHealth health) {
  return health != TrackHealth::none && health != TrackHealth::tentative &&
         health != TrackHealth::lost;
}

RosResult result_of(const ObjectHypothesis& hypothesis, const std::string& class_id, double total) {
  return {.class_id = class_id,
          .score = hypothesis.probability / total,
          .pose = numbers_of(hypothesis.pose),
          .covariance = covariance_numbers(hypothesis.pose, hypothesis.covariance)};
}

int level_of(TrackHealth health) {
  if (health == TrackHealth::good) return 0;
  return health == TrackHealth::inconsistent || health == TrackHealth::lost ? 2 : 1;
}

/// The shortest text that is read back to the last bit.
std::string text_of(double number) { return fmt::format("{}", number); }

}  // namespace

std::array<double, 36> covariance_numbers(const SE3d& pose, const Matrix6d& left) {
  // A left perturbation by [phi; rho] turns by phi, and moves the object by rho + phi x t.
  Matrix6d jacobian = Matrix6d::Identity();
  jacobian.bottomLeftCorner<3, 3>() = -SO3d::hat(pose.translation());
  const Matrix6d at_object = jacobian * left * jacobian.transpose();
  std::array<double, 36> numbers;
  for (Eigen::Index i = 0; i < 6; ++i) {
    for (Eigen::Index j = 0; j < 6; ++j) {
      const Eigen::Index row = (i + 3) % 6;
      const Eigen::Index column = (j + 3) % 6;
      numbers[static_cast<std::size_t>(6 * i + j)] =
          0.5 * (at_object(row, column) + at_object(column, row));
    }
  }
  return numbers;
}

RosDetections objects_message(const LiveEstimate& estimate, const LiveNodeSettings& node) {
  RosDetections message{.header = {estimate.stamp_ns, node.world_frame}};
  const FrameEstimate& frame = estimate.frame;
  for (std::size_t i = 0; i < frame.objects.size(); ++i) {
    if (!frame.objects[i] || frame.existences[i].value_or(0.0) < node.least_existence) continue;
    RosDetection& object = message.detections.emplace_back();
    object.header = message.header;
    object.id = (*frame.ids)[i];
    object.box = numbers_of(frame.objects[i]->mean());
    // The rest is the probability that none of the detections was of the object.
    double total = 0.0;
    for (const ObjectHypothesis& hypothesis : estimate.hypotheses[i])
      total += hypothesis.probability;
    for (const ObjectHypothesis& hypothesis : estimate.hypotheses[i])
      object.results.push_back(result_of(hypothesis, estimate.classes[i], total));
  }
  return message;
}

std::vector<RosTransform> transforms_message(const LiveEstimate& estimate,
                                             const LiveNodeSettings& node,
                                             const std::optional<FrameBelow>& below) {
  const FrameEstimate& frame = estimate.frame;
  const RosHeader header{estimate.stamp_ns + nanoseconds(node.transform_time_offset_s),
                         node.world_frame};
  std::vector<RosTransform> message;
  for (std::size_t i = 0; node.publish_tf && i < frame.objects.size(); ++i) {
    if (!frame.objects[i] || !is_in_tf(frame.healths[i])) continue;
    message.push_back(
        {header, node.tf_prefix + (*frame.ids)[i], numbers_of(frame.objects[i]->mean())});
  }
  if (below) {
    const auto& [child, child_body] = *below;
    message.push_back({header, child, numbers_of(frame.camera.mean() * child_body.inverse())});
  }
  return message;
}

std::vector<RosStatus> object_statuses(const LiveEstimate& estimate, const std::string& node) {
  std::vector<RosStatus> statuses;
  const FrameEstimate& frame = estimate.frame;
  for (std::size_t i = 0; i < frame.objects.size(); ++i) {
    if (!frame.objects[i]) continue;
    RosStatus& status = statuses.emplace_back();
    status.level = level_of(frame.healths[i]);
    status.name = fmt::format("{}: {}", node, (*frame.ids)[i]);
    status.message = word_of(frame.healths[i]);
    auto& values = status.values;
    values.emplace_back("register_again", frame.register_again[i] ? "true" : "false");
    if (frame.existences[i]) values.emplace_back("existence", text_of(*frame.existences[i]));
    for (std::size_t k = 0; k < frame.motion_models[i].size(); ++k)
      values.emplace_back(fmt::format("motion_model_{}", k), text_of(frame.motion_models[i][k]));
    if (frame.mode_probabilities[i])
      values.emplace_back("mode_probability", text_of(*frame.mode_probabilities[i]));
    values.emplace_back("hypotheses", std::to_string(estimate.hypotheses[i].size()));
  }
  return statuses;
}

RosStatus node_status(const std::string& node, const LiveCounts& counts,
                      const std::vector<std::string>& problems) {
  RosStatus status{
      .level = problems.empty() ? 0 : 1,
      .name = node + ": node",
      .message = problems.empty() ? "good" : fmt::to_string(fmt::join(problems, "; "))};
  const auto add = [&](const char* name, std::size_t count) {
    status.values.emplace_back(name, std::to_string(count));
  };
  add("images", counts.images);
  add("observations", counts.observations);
  add("late", counts.late);
  add("too_late", counts.too_late);
  add("ignored", counts.ignored);
  add("without_odometry", counts.without_odometry);
  add("dropped", counts.dropped);
  add("refused", counts.refused);
  add("resets", counts.resets);
  return status;
}

}  // namespace posemix::internal
