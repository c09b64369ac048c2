// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "json_numbers.hpp"
#include "posemix/base/error.hpp"
#include "posemix/io/text.hpp"
#include "posterior_schema.hpp"

namespace posemix {
namespace {

constexpr double kNormTolerance = 1e-6;
constexpr std::size_t kMostPoses = 10000;

/// A value of the document and the path to it, for messages.
class Place {
 public:
  Place(const Json& json, std::string path) : json_(json), path_(std::move(path)) {}

  [[noreturn]] void fail(std::string_view got, std::string_view expected) const {
    throw InvalidInput(fmt::format("{}: got {}, expected {}", path_, got, expected));
  }

  Place member(std::string_view key) const {
    if (!json_.is_object()) fail(json_.type_name(), "an object");
    const auto found = json_.find(std::string(key));
    if (found == json_.end()) fail("no key '" + std::string(key) + "'", "one");
    return {*found, fmt::format("{}: {}", path_, key)};
  }

  std::vector<Place> items(std::optional<std::size_t> size = {}) const {
    if (!json_.is_array()) fail(json_.type_name(), "an array");
    if (size && json_.size() != *size) {
      fail(fmt::format("{} entries", json_.size()), fmt::format("{}", *size));
    }
    std::vector<Place> items;
    for (std::size_t i = 0; i < json_.size(); ++i)
      items.emplace_back(json_[i], fmt::format("{}[{}]", path_, i));
    return items;
  }

  double number() const {
    const double number = json_.is_number() ? json_.get<double>() : std::nan("");
    if (!std::isfinite(number))
      fail(json_.is_number() ? "a number that is not finite" : json_.type_name(), "a number");
    return number;
  }

  std::string string() const {
    if (!json_.is_string()) fail(json_.type_name(), "a string");
    return json_.get<std::string>();
  }

  void require_word(std::string_view expected) const {
    const std::string word = string();
    if (word != expected) fail(in_quotes(word), in_quotes(expected));
  }

  Eigen::VectorXd vector(std::size_t size) const {
    Eigen::VectorXd result(static_cast<Eigen::Index>(size));
    Eigen::Index at = 0;
    for (const Place& item : items(size)) result[at++] = item.number();
    return result;
  }

 private:
  const Json& json_;
  std::string path_;
};

void check_head(const Place& root) {
  root.member("type").require_word(kPosteriorType);
  const Place schema = root.member("schema");
  const double number = schema.number();
  if (number != static_cast<double>(kPosteriorSchema)) {
    schema.fail(
        fmt::format("{}", number),
        fmt::format("{}: the file was written in another version of the format", kPosteriorSchema));
  }
  const Place perturbation = root.member("perturbation");
  perturbation.member("side").require_word(kSide);
  perturbation.member("order").require_word(kOrder);
  const Place units = root.member("units");
  units.member("rotation").require_word(kRotationUnit);
  units.member("translation").require_word(kTranslationUnit);
}

NamedPose read_named_pose(const Place& place) {
  const Place kind = place.member("kind");
  const std::string word = kind.string();
  const auto words = std::find_if(kPoseKinds.begin(), kPoseKinds.end(),
                                  [&](const PoseKindWords& entry) { return entry.word == word; });
  if (words == kPoseKinds.end())
    kind.fail(in_quotes(word), "\"camera\", \"camera_motion\" or \"object\"");
  place.member("transform").require_word(words->transform);
  place.member("covariance_frame").require_word(words->frame);
  return {place.member("name").string(), words->kind};
}

std::vector<NamedPose> read_named_poses(const Place& place) {
  std::vector<NamedPose> poses;
  std::set<std::string> objects;
  for (const Place& item : place.items()) {
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

SE3d read_pose(const Place& place) {
  const Eigen::Vector3d translation = place.member("translation").vector(3);
  const Place quaternion_place = place.member("quaternion_xyzw");
  const Eigen::Vector4d xyzw = quaternion_place.vector(4);
  const double norm = xyzw.stableNorm();
  if (!(std::abs(norm - 1.0) <= kNormTolerance)) {
    quaternion_place.fail(fmt::format("norm {:.9g}", norm), "norm 1");
  }
  return SE3d(SO3d::from_quaternion(Eigen::Quaterniond(xyzw)), translation);
}

Component<Hypothesis> read_component(const Place& place, std::size_t size) {
  std::vector<SE3d> poses;
  for (const Place& pose : place.member("poses").items(size)) poses.push_back(read_pose(pose));
  const Place rows = place.member("covariance");
  const auto dof = static_cast<Eigen::Index>(6 * size);
  Eigen::MatrixXd covariance(dof, dof);
  Eigen::Index row = 0;
  for (const Place& item : rows.items(6 * size))
    covariance.row(row++) = item.vector(6 * size).transpose();
  const double log_weight = place.member("log_weight").number();
  try {
    return {log_weight, Hypothesis(PoseStackd(std::move(poses)), covariance)};
  } catch (const InvalidInput& error) {
    rows.fail(error.what(), "a symmetric positive definite matrix");
  }
}

}  // namespace

PosteriorFile parse_posterior(std::string_view text, const std::string& name) {
  Json json;
  try {
    json = Json::parse(text);
  } catch (const Json::exception& error) {
    throw InvalidInput(fmt::format("{}: got a text that is not JSON ({}), expected posterior.json",
                                   name, error.what()));
  }
  const Place root(json, name);
  check_head(root);
  std::vector<NamedPose> poses = read_named_poses(root.member("poses"));
  std::vector<Component<Hypothesis>> components;
  const Place component_place = root.member("components");
  for (const Place& item : component_place.items())
    components.push_back(read_component(item, poses.size()));
  if (components.empty()) component_place.fail("no component", "at least one");
  return {root.member("method").string(), root.member("stamp_s").number(), std::move(poses),
          Posterior(std::move(components))};
}

PosteriorFile read_posterior(const std::filesystem::path& path) {
  return parse_posterior(read_file(path), path.string());
}

}  // namespace posemix
