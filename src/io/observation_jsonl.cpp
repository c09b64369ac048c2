// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/io/observation_jsonl.hpp"

#include <cmath>
#include <optional>
#include <set>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "json_numbers.hpp"
#include "json_place.hpp"
#include "observation_numbers.hpp"
#include "posemix/base/error.hpp"
#include "posemix/io/gzip.hpp"
#include "posemix/io/placeholder_covariance.hpp"
#include "posemix/io/rigid.hpp"
#include "posemix/io/text.hpp"

namespace posemix {
namespace {

using namespace internal;

constexpr std::size_t kTriangle = 21;

/// The value of a key that is there and not null.
std::optional<JsonPlace> given(const JsonPlace& place, std::string_view key) {
  if (!place.has(key) || place.member(key).is_null()) return std::nullopt;
  return place.member(key);
}

std::string string_of(const JsonPlace& place, std::string_view key) {
  const auto found = given(place, key);
  return found ? found->string() : std::string();
}

std::optional<double> number_of(const JsonPlace& place, std::string_view key) {
  const auto found = given(place, key);
  return found ? std::optional(found->number()) : std::nullopt;
}

/// Throws with the line and the key unless `wrong`, which is empty for a good number, is.
double checked(const JsonPlace& place, double number, std::string_view wrong) {
  if (!wrong.empty()) place.fail(fmt::format("{}", number), wrong);
  return number;
}

SE3d pose_of(const JsonPlace& place) {
  const Eigen::VectorXd numbers = place.vector(7);
  const std::vector<JsonPlace> places = place.items(7);
  for (std::size_t i = 0; i < 3; ++i) {
    const double coordinate = places[i].number();
    checked(places[i], coordinate, wrong_position(coordinate));
  }
  const Eigen::Quaterniond quaternion(Eigen::Vector4d(numbers.tail<4>()));
  const double deviation = std::abs(quaternion.coeffs().stableNorm() - 1.0);
  if (!(deviation <= kQuaternionNormTolerance)) {
    place.fail(fmt::format("a quaternion of norm {:.6g}", quaternion.coeffs().stableNorm()),
               fmt::format("qx qy qz qw of norm 1 within {:g}", kQuaternionNormTolerance));
  }
  const SO3d rotation = deviation <= kJsonNormTolerance ? SO3d::from_stored_quaternion(quaternion)
                                                        : SO3d::from_quaternion(quaternion);
  return SE3d(rotation, numbers.head<3>());
}

std::optional<Matrix6d> covariance_of(const JsonPlace& component) {
  const auto place = given(component, "covariance");
  if (!place) return std::nullopt;
  const Eigen::VectorXd numbers = place->vector(kTriangle);
  Matrix6d covariance;
  Eigen::Index next = 0;
  for (Eigen::Index i = 0; i < 6; ++i) {
    for (Eigen::Index j = i; j < 6; ++j) covariance(i, j) = covariance(j, i) = numbers[next++];
  }
  if (is_placeholder_covariance(covariance)) return std::nullopt;
  if (const auto fault = fault_of(covariance)) place->fail(fault->got, fault->expected);
  return covariance;
}

ObservationComponent component_of(const JsonPlace& place) {
  place.require_only({"weight", "pose", "covariance"});
  const JsonPlace weight = place.member("weight");
  return {.weight = checked(weight, weight.number(), wrong_weight(weight.number())),
          .pose = pose_of(place.member("pose")),
          .covariance = covariance_of(place)};
}

Observation observation_of_line(const JsonPlace& line) {
  line.require_only({"stamp_s", "camera", "detector", "id", "class", "sighting", "clutter", "score",
                     "components"});
  Observation observation;
  const JsonPlace stamp = line.member("stamp_s");
  observation.stamp_s = checked(stamp, stamp.number(), wrong_stamp(stamp.number()));
  observation.object = string_of(line, "id");
  observation.class_id = string_of(line, "class");
  if (observation.object.empty() == observation.class_id.empty())
    line.fail(observation.object.empty() ? "neither id nor class" : "both id and class",
              "one of the two");
  observation.camera = string_of(line, "camera");
  observation.detector = string_of(line, "detector");
  observation.clutter = number_of(line, "clutter");
  if (const auto& clutter = observation.clutter)
    checked(line.member("clutter"), *clutter, wrong_clutter(*clutter));
  observation.score = number_of(line, "score");
  for (const JsonPlace& component : line.member("components").items())
    observation.components.push_back(component_of(component));
  try {
    validate(observation);
  } catch (const InvalidInput& error) {
    line.refuse(error.what());
  }
  return observation;
}

/// Notes the number of a sighting, which no line before has.
void check_sighting(const JsonPlace& line, std::set<double>& known) {
  constexpr double kLargest = 9007199254740992.0;  // beyond, two integers may be one double
  const auto place = given(line, "sighting");
  if (!place) return;
  const double number = place->number();
  if (number != std::floor(number) || number < 0.0 || number > kLargest)
    place->fail(fmt::format("{}", number), "an integer from 0 to 2^53");
  if (!known.insert(number).second)
    place->fail(fmt::format("sighting {} again", number), "one line for every sighting");
}

Json json_of(const ObservationComponent& component) {
  Json json;
  json["weight"] = component.weight;
  const Eigen::Vector3d& t = component.pose.translation();
  const Eigen::Vector4d q = component.pose.rotation().quaternion().coeffs();
  json["pose"] = {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()};
  if (!component.covariance) return json;
  Json numbers = Json::array();
  for (Eigen::Index i = 0; i < 6; ++i) {
    for (Eigen::Index j = i; j < 6; ++j) numbers.push_back((*component.covariance)(i, j));
  }
  json["covariance"] = std::move(numbers);
  return json;
}

Json json_of(const Observation& observation, std::size_t sighting) {
  validate(observation);
  if (observation.object.empty() == observation.class_id.empty()) {
    throw InvalidInput(fmt::format("observation {} has {}, expected one of the two", sighting,
                                   observation.object.empty() ? "neither an object nor a class"
                                                              : "both an object and a class"));
  }
  Json json;
  json["stamp_s"] = observation.stamp_s;
  if (!observation.camera.empty()) json["camera"] = observation.camera;
  if (!observation.detector.empty()) json["detector"] = observation.detector;
  if (!observation.object.empty()) json["id"] = observation.object;
  if (!observation.class_id.empty()) json["class"] = observation.class_id;
  json["sighting"] = sighting;
  if (observation.clutter) json["clutter"] = *observation.clutter;
  if (observation.score) json["score"] = *observation.score;
  Json components = Json::array();
  for (const ObservationComponent& component : observation.components)
    components.push_back(json_of(component));
  json["components"] = std::move(components);
  return json;
}

}  // namespace

namespace internal {

PlacedObservations parse_placed_lines(std::string_view text, const std::string& name) {
  PlacedObservations placed;
  std::set<double> sightings;
  LineReader reader(text, name);
  while (reader.next_content()) {
    const std::string where = fmt::format("{}:{}", name, reader.number());
    const Json json = parse_json(reader.line(), where, "an observation");
    const JsonPlace line(json, where);
    placed.observations.push_back(observation_of_line(line));
    placed.lines.push_back(reader.number());
    check_sighting(line, sightings);
  }
  if (placed.observations.empty())
    throw InvalidInput(fmt::format("{}: got no observations, expected at least one", name));
  return placed;
}

}  // namespace internal

std::vector<Observation> parse_observation_lines(std::string_view text, const std::string& name) {
  return parse_placed_lines(text, name).observations;
}

std::vector<Observation> read_observation_lines(const std::filesystem::path& path) {
  return parse_observation_lines(read_file_or_gzip(path), path.string());
}

std::string format_observation_lines(std::span<const Observation> observations) {
  std::string text;
  for (std::size_t i = 0; i < observations.size(); ++i)
    text += json_text(json_of(observations[i], i));
  return text;
}

}  // namespace posemix
