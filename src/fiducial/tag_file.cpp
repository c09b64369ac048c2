// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/fiducial/tag_file.hpp"

#include <fmt/format.h>

#include "posemix/io/text.hpp"
#include "yaml_pose.hpp"

namespace posemix {
namespace {

using namespace internal;

double size_in(const YamlValue& value) {
  const double size = value.number();
  if (!(size > 0.0)) value.fail(fmt::format("{}", size), "a size above zero [m]");
  return size;
}

/// T_a_c of T_a_b and T_b_c with independent errors on their right sides.
StatedPose composed(const StatedPose& first, const StatedPose& second) {
  StatedPose out{first.pose * second.pose, second.covariance};
  if (out.covariance && first.covariance)
    *out.covariance += second.pose.inverse().adjoint_congruence(*first.covariance);
  return out;
}

struct Body {
  bool is_static = false;
  std::optional<StatedPose> pose;
  std::optional<double> default_size;
  std::optional<double> position_sd;  ///< of all tags, in place of their own [m]
  std::optional<double> rotation_sd;  ///< the same [rad]
};

double sd_in(const YamlValue& value) {
  const double sd = value.number();
  if (!(sd > 0.0)) value.fail(fmt::format("{}", sd), "a standard deviation above zero");
  return sd;
}

Body body_of(const YamlValue& value) {
  Body body;
  if (const auto fixed = value.find("is_static")) body.is_static = fixed->boolean();
  if (const auto pose = value.find("pose")) body.pose = pose_of(*pose);
  if (const auto size = value.find("default_tag_size")) body.default_size = size_in(*size);
  if (const auto sd = value.find("override_tag_position_noise")) body.position_sd = sd_in(*sd);
  if (const auto sd = value.find("override_tag_rotation_noise")) body.rotation_sd = sd_in(*sd);
  return body;
}

void add_tag(const YamlValue& value, const Body& body, TagMap& map) {
  const std::int64_t id = value.at("id").integer();
  const auto own = value.find("size");
  const std::optional<double> size = own ? std::optional(size_in(*own)) : body.default_size;
  if (!size) value.fail("no size", "one here, or default_tag_size of the body");
  if (!map.size_m.emplace(id, *size).second)
    value.fail(fmt::format("tag {} again", id), "every tag once");
  const auto pose = value.find("pose");
  if (!pose || !body.is_static || !body.pose) return;
  StatedPose stated = pose_of(*pose);
  if (stated.covariance && body.position_sd)
    stated.covariance->bottomRightCorner<3, 3>() =
        Eigen::Matrix3d::Identity() * *body.position_sd * *body.position_sd;
  if (stated.covariance && body.rotation_sd)
    stated.covariance->topLeftCorner<3, 3>() =
        Eigen::Matrix3d::Identity() * *body.rotation_sd * *body.rotation_sd;
  if (stated.covariance) map.priors[id] = composed(*body.pose, stated);
}

void add_body(const std::string& name, const YamlValue& value, const std::string& default_body,
              TagMap& map) {
  const Body body = body_of(value);
  if (name == default_body) map.default_size_m = body.default_size;
  if (const auto odometry = value.find("T_body_odom"); odometry && !body.is_static)
    map.rig_odometry = pose_of(*odometry).pose;
  if (const auto ignored = value.find("ignore_tags")) {
    for (const YamlValue& tag : ignored->elements()) map.ignored.insert(tag.integer());
  }
  if (const auto tags = value.find("tags")) {
    for (const YamlValue& tag : tags->elements()) add_tag(tag, body, map);
  }
}

void add_remaps(const YamlValue& value, TagMap& map) {
  const std::int64_t id = value.at("id").integer();
  for (const YamlValue& remap : value.at("remaps").elements()) {
    map.remaps.push_back({id, remap.at("remap_id").integer(), remap.at("start_time").number(),
                          remap.at("end_time").number()});
  }
}

}  // namespace

TagMap parse_tag_map(std::string_view text, const std::string& name) {
  const YamlValue document = YamlValue::document(text, name);
  const auto standard = document.find("default_body");
  const std::string default_body = standard ? standard->text() : "";
  TagMap map;
  for (const YamlValue& element : document.at("bodies").elements()) {
    for (const auto& [body, value] : element.entries()) add_body(body, value, default_body, map);
  }
  if (const auto remaps = document.find("tag_id_remap")) {
    for (const YamlValue& remap : remaps->elements()) add_remaps(remap, map);
  }
  return map;
}

TagMap read_tag_map(const std::filesystem::path& path) {
  return parse_tag_map(read_file(path), path.string());
}

}  // namespace posemix
