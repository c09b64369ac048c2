// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/io/bop_views.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "json_place.hpp"
#include "observation_numbers.hpp"
#include "posemix/base/error.hpp"
#include "posemix/io/rigid.hpp"
#include "posemix/io/text.hpp"

namespace posemix {
namespace {

using namespace internal;

constexpr std::string_view kCameraHead = "scene_id,im_id,tx,ty,tz,qx,qy,qz,qw";
constexpr double kUnitQuaternion = 1e-4;

Observation observation_of_rows(const std::vector<const BopRow*>& rows) {
  Observation observation;
  observation.class_id = std::to_string(rows.front()->object);
  observation.score = rows.front()->score;
  const bool by_score =
      rows.front()->score > 0.0 &&
      std::all_of(rows.begin(), rows.end(), [](const BopRow* row) { return row->score >= 0.0; });
  double total = 0.0;
  for (const BopRow* row : rows) total += by_score ? row->score : 1.0;
  for (const BopRow* row : rows) {
    if (by_score && row->score == 0.0) continue;
    observation.components.push_back(
        {.weight = (by_score ? row->score : 1.0) / total, .pose = row->pose});
  }
  return observation;
}

/// The rows of one object, the highest score first, as observations.
void add_observations(const std::vector<const BopRow*>& rows,
                      const BopObservationSettings& settings, std::vector<Observation>& all) {
  std::vector<std::vector<const BopRow*>> places;
  for (const BopRow* row : rows) {
    if (settings.use == BopRowUse::best && !places.empty()) break;
    const auto same = std::find_if(places.begin(), places.end(), [&](const auto& place) {
      return settings.use == BopRowUse::mixtures &&
             (place.front()->pose.translation() - row->pose.translation()).norm() <=
                 settings.same_place_m;
    });
    if (same == places.end()) {
      places.push_back({row});
    } else {
      same->push_back(row);
    }
  }
  for (const auto& place : places) all.push_back(observation_of_rows(place));
}

std::int64_t id_of(const JsonPlace& place, std::string_view what) {
  const double number = place.number();
  if (!(number >= 0.0 && number <= 1e9 && number == std::floor(number)))
    place.fail(fmt::format("{:g}", number), what);
  return static_cast<std::int64_t>(number);
}

/// A number, or [camera, number].
std::int64_t image_of(const JsonPlace& place, bool is_pair) {
  return id_of(is_pair ? place.items(2)[1] : place, "an image id");
}

SE3d camera_of(const std::vector<std::string_view>& fields, const LineReader& reader) {
  static constexpr const char* kNames[] = {"tx", "ty", "tz", "qx", "qy", "qz", "qw"};
  double v[7];
  for (std::size_t i = 0; i < 7; ++i) v[i] = reader.number_from(trimmed(fields[2 + i]), kNames[i]);
  for (std::size_t i = 0; i < 3; ++i) {
    if (const std::string_view wrong = wrong_position(v[i]); !wrong.empty())
      reader.fail(fmt::format("{} = {}", kNames[i], in_quotes(trimmed(fields[2 + i]))), wrong);
  }
  const Eigen::Quaterniond q(v[6], v[3], v[4], v[5]);
  if (!(std::abs(q.norm() - 1.0) <= kUnitQuaternion))
    reader.fail(fmt::format("a quaternion of norm {:g}", q.norm()), "one of norm 1");
  return SE3d(SO3d::from_quaternion(q), {v[0], v[1], v[2]});
}

}  // namespace

std::vector<Observation> bop_observations(std::span<const BopRow> rows,
                                          const BopObservationSettings& settings) {
  std::map<std::int64_t, std::vector<const BopRow*>> objects;
  for (const BopRow& row : rows)
    if (row.score >= settings.least_score) objects[row.object].push_back(&row);
  std::vector<Observation> all;
  for (auto& [object, of_object] : objects) {
    std::stable_sort(of_object.begin(), of_object.end(),
                     [](const BopRow* a, const BopRow* b) { return a->score > b->score; });
    add_observations(of_object, settings, all);
  }
  return all;
}

std::vector<ImageGroup> parse_image_groups(std::string_view text, const std::string& name) {
  const Json json = parse_json(text, name, "an array of groups of images");
  std::vector<ImageGroup> groups;
  const JsonPlace root(json, name);
  std::size_t index = 0;
  for (const JsonPlace& entry : root.items()) {
    ImageGroup& group = groups.emplace_back();
    group.scene = id_of(entry.member("scene_id"), "a scene id");
    const JsonPlace all = entry.member("im_id");
    const Json& images = json[index++]["im_id"];
    std::size_t at = 0;
    for (const JsonPlace& image : all.items()) {
      group.images.push_back(image_of(image, images[at++].is_array()));
      const auto last = group.images.end() - 1;
      if (std::find(group.images.begin(), last, *last) != last)
        image.fail(fmt::format("image {} again", *last), "every image once");
    }
    if (group.images.empty()) all.fail("no image", "at least one");
  }
  if (groups.empty()) root.fail("no group", "at least one");
  return groups;
}

std::vector<ImageGroup> read_image_groups(const std::filesystem::path& path) {
  return parse_image_groups(read_file(path), path.string());
}

SceneCameras parse_scene_cameras(std::string_view text, const std::string& name) {
  LineReader reader(text, name);
  if (!reader.next_content() || trimmed(reader.line()) != kCameraHead) {
    throw InvalidInput(fmt::format("{}: got no head line, expected {}", name, kCameraHead));
  }
  SceneCameras cameras;
  while (reader.next_content()) {
    const std::vector<std::string_view> fields = split_fields(reader.line(), ',');
    if (fields.size() != 9)
      reader.fail(fmt::format("{} columns", fields.size()), fmt::format("9: {}", kCameraHead));
    const std::pair image{reader.index_from(trimmed(fields[0]), "scene_id"),
                          reader.index_from(trimmed(fields[1]), "im_id")};
    const SE3d pose = camera_of(fields, reader);
    if (!cameras.emplace(image, pose).second) {
      reader.fail(fmt::format("image {} of scene {} again", image.second, image.first),
                  "every image once");
    }
  }
  if (cameras.empty()) throw InvalidInput(fmt::format("{}: got no row, expected one", name));
  return cameras;
}

SceneCameras read_scene_cameras(const std::filesystem::path& path) {
  return parse_scene_cameras(read_file(path), path.string());
}

std::string format_bop_rows(std::span<const BopRow> rows, double time_s) {
  std::string text = "scene_id,im_id,obj_id,score,R,t,time\n";
  for (const BopRow& row : rows) {
    const Eigen::Matrix3d r = row.pose.rotation().matrix();
    const Eigen::Vector3d t = 1e3 * row.pose.translation();
    text += fmt::format("{},{},{},{},", row.scene, row.image, row.object, row.score);
    for (Eigen::Index i = 0; i < 9; ++i)
      text += fmt::format("{}{}", r(i / 3, i % 3), i == 8 ? "," : " ");
    text += fmt::format("{} {} {},{}\n", t.x(), t.y(), t.z(), time_s);
  }
  return text;
}

}  // namespace posemix
