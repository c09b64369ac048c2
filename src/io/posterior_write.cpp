// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "json_numbers.hpp"
#include "posemix/base/error.hpp"
#include "posterior_schema.hpp"

namespace posemix {
namespace {

using namespace internal;

Json posterior_numbers(const Eigen::Ref<const Eigen::VectorXd>& vector) {
  return std::vector<double>(vector.begin(), vector.end());
}

Json pose_json(const SE3d& pose) {
  return {{"translation", posterior_numbers(pose.translation())},
          {"quaternion_xyzw", posterior_numbers(pose.rotation().quaternion().coeffs())}};
}

Json component_json(const Component<Hypothesis>& component) {
  const Hypothesis& density = component.density;
  Json poses = Json::array();
  for (const SE3d& pose : density.mean()) poses.push_back(pose_json(pose));
  Json rows = Json::array();
  for (Eigen::Index row = 0; row < density.covariance().rows(); ++row) {
    rows.push_back(posterior_numbers(density.covariance().row(row).transpose()));
  }
  return {{"log_weight", component.log_weight},
          {"poses", std::move(poses)},
          {"covariance", std::move(rows)}};
}

Json named_pose_json(const NamedPose& pose) {
  const auto words =
      std::find_if(kPoseKinds.begin(), kPoseKinds.end(),
                   [&](const PoseKindWords& entry) { return entry.kind == pose.kind; });
  return {{"name", pose.name},
          {"kind", words->word},
          {"transform", words->transform},
          {"covariance_frame", words->frame}};
}

void check_component(const Component<Hypothesis>& component) {
  bool finite = std::isfinite(component.log_weight) && component.density.covariance().allFinite();
  for (const SE3d& pose : component.density.mean()) finite = finite && pose.log().allFinite();
  require(finite, "posterior: a number is not finite");
}

}  // namespace

std::string format_posterior(const PosteriorFile& file) {
  const std::size_t size = file.mixture[0].density.mean().size();
  if (file.poses.size() != size) {
    throw InvalidInput(fmt::format("posterior: {} names for {} poses", file.poses.size(), size));
  }
  Json poses = Json::array();
  for (const NamedPose& pose : file.poses) poses.push_back(named_pose_json(pose));
  Json components = Json::array();
  for (const auto& component : file.mixture.components()) {
    if (std::isinf(component.log_weight)) continue;
    check_component(component);
    components.push_back(component_json(component));
  }
  const Json json = {{"schema", kPosteriorSchema},
                     {"type", kPosteriorType},
                     {"method", file.method},
                     {"stamp_s", file.stamp},
                     {"group", fmt::format("SE(3)^{}", size)},
                     {"perturbation",
                      {{"side", kSide},
                       {"order", kOrder},
                       {"definition", "X = Exp(xi) X0, xi ~ N(0, covariance)"}}},
                     {"units", {{"rotation", kRotationUnit}, {"translation", kTranslationUnit}}},
                     {"poses", std::move(poses)},
                     {"components", std::move(components)}};
  return json_text(json);
}

}  // namespace posemix
