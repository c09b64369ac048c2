// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "json_fault.hpp"
#include "json_place.hpp"
#include "posemix/base/error.hpp"
#include "posemix/io/text.hpp"
#include "posterior_schema.hpp"

namespace posemix {
namespace {

using namespace internal;

constexpr std::size_t kMostPoses = 10000;

void check_head(const JsonPlace& root) {
  root.member("type").require_word(kPosteriorType);
  const JsonPlace schema = root.member("schema");
  const double number = schema.number();
  if (number != static_cast<double>(kPosteriorSchema)) {
    schema.fail(
        fmt::format("{}", number),
        fmt::format("{}: the file was written in another version of the format", kPosteriorSchema));
  }
  const JsonPlace perturbation = root.member("perturbation");
  perturbation.member("side").require_word(kSide);
  const JsonPlace order = perturbation.member("order");
  if (order.string() != kOldOrder) order.require_word(kOrder);
  const JsonPlace units = root.member("units");
  units.member("rotation").require_word(kRotationUnit);
  units.member("translation").require_word(kTranslationUnit);
}

NamedPose read_named_pose(const JsonPlace& place) {
  const JsonPlace kind = place.member("kind");
  const std::string word = kind.string();
  const auto words = std::find_if(kPoseKinds.begin(), kPoseKinds.end(),
                                  [&](const PoseKindWords& entry) { return entry.word == word; });
  if (words == kPoseKinds.end())
    kind.fail(in_quotes(word), "\"camera\", \"camera_motion\" or \"object\"");
  place.member("transform").require_word(words->transform);
  place.member("covariance_frame").require_word(words->frame);
  return {place.member("name").string(), words->kind};
}

std::vector<NamedPose> read_named_poses(const JsonPlace& place) {
  std::vector<NamedPose> poses;
  std::set<std::string> objects;
  for (const JsonPlace& item : place.items()) {
    poses.push_back(read_named_pose(item));
    const bool first = poses.size() == 1;
    if (first != (poses.back().kind == PoseKind::camera))
      item.fail("a camera elsewhere", "one, as the first pose");
    if (poses.back().kind == PoseKind::object && !objects.insert(poses.back().name).second) {
      item.fail(fmt::format("the object {} again", in_quotes(poses.back().name)),
                "names that differ");
    }
  }
  if (poses.empty() || poses.size() > kMostPoses) {
    place.fail(fmt::format("{} poses", poses.size()), fmt::format("1 to {}", kMostPoses));
  }
  return poses;
}

SE3d read_pose(const JsonPlace& place) {
  const Eigen::Vector3d translation = place.member("translation").vector(3);
  return SE3d(place.member("quaternion_xyzw").rotation(), translation);
}

Component<Hypothesis> read_component(const JsonPlace& place, std::size_t size) {
  std::vector<SE3d> poses;
  for (const JsonPlace& pose : place.member("poses").items(size)) poses.push_back(read_pose(pose));
  const JsonPlace rows = place.member("covariance");
  const Eigen::MatrixXd covariance = rows.square_matrix(6 * size);
  const double log_weight = place.member("log_weight").number();
  try {
    return {log_weight, Hypothesis(PoseStackd(std::move(poses)), covariance)};
  } catch (const InvalidInput& error) {
    rows.refuse(fmt::format("{}, expected a symmetric positive definite matrix", error.what()));
  }
}

}  // namespace

PosteriorFile parse_posterior(std::string_view text, const std::string& name) {
  const Json json = json_of(text, name, "posterior.json");
  const JsonPlace root(json, name);
  check_head(root);
  std::vector<NamedPose> poses = read_named_poses(root.member("poses"));
  root.member("group").require_word(fmt::format("SE(3)^{}", poses.size()));
  std::vector<Component<Hypothesis>> components;
  const JsonPlace component_place = root.member("components");
  for (const JsonPlace& item : component_place.items())
    components.push_back(read_component(item, poses.size()));
  if (components.empty()) component_place.fail("no component", "at least one");
  return {root.member("method").string(), root.member("stamp_s").number(), std::move(poses),
          Posterior::from_stored(std::move(components))};
}

PosteriorFile read_posterior(const std::filesystem::path& path) {
  return parse_posterior(read_file(path), path.string());
}

}  // namespace posemix
