// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/io/bop_models.hpp"

#include <fmt/format.h>

#include "json_place.hpp"
#include "posemix/base/error.hpp"
#include "posemix/io/rigid.hpp"
#include "posemix/io/text.hpp"

namespace posemix {
namespace {

using namespace internal;

constexpr double kModelMillimetre = 1e-3;

/// The place of a key for messages.
std::string place_of(const std::string& name, const std::string& id, std::string_view key) {
  return fmt::format("{}: {}: {}", name, id, key);
}

std::vector<SE3d> read_discrete(const JsonPlace& entry, const std::string& place) {
  std::vector<SE3d> elements;
  if (!entry.has("symmetries_discrete")) return elements;
  for (const JsonPlace& item : entry.member("symmetries_discrete").items()) {
    const Eigen::VectorXd numbers = item.vector(16);
    Eigen::Matrix4d matrix = Eigen::Map<const Eigen::Matrix4d>(numbers.data()).transpose();
    matrix.topRightCorner<3, 1>() *= kModelMillimetre;
    elements.push_back(pose_from_matrix(matrix, fmt::format("{}[{}]", place, elements.size())));
  }
  return elements;
}

std::vector<SymmetryAxis> read_continuous(const JsonPlace& entry) {
  std::vector<SymmetryAxis> axes;
  if (!entry.has("symmetries_continuous")) return axes;
  for (const JsonPlace& item : entry.member("symmetries_continuous").items()) {
    axes.push_back(
        {item.member("axis").vector(3), kModelMillimetre * item.member("offset").vector(3)});
  }
  return axes;
}

std::optional<ObjectBox> read_box(const JsonPlace& entry) {
  constexpr std::array<std::string_view, 3> kLowest{"min_x", "min_y", "min_z"};
  constexpr std::array<std::string_view, 3> kSize{"size_x", "size_y", "size_z"};
  bool has_any = false;
  for (std::size_t i = 0; i < 3; ++i)
    has_any = has_any || entry.has(kLowest[i]) || entry.has(kSize[i]);
  if (!has_any) return std::nullopt;
  ObjectBox box;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    box.lowest_m[axis] = kModelMillimetre * entry.member(kLowest[i]).number();
    const JsonPlace size = entry.member(kSize[i]);
    box.size_m[axis] = kModelMillimetre * size.number();
    if (!(box.size_m[axis] >= 0.0)) size.fail("a negative number", "a number of at least 0");
  }
  return box;
}

BopModel read_bop_entry(const JsonPlace& entry, const std::string& name, const std::string& id) {
  BopModel model;
  const JsonPlace diameter = entry.member("diameter");
  model.diameter_m = kModelMillimetre * diameter.number();
  if (!(model.diameter_m > 0.0)) {
    diameter.fail(fmt::format("{:g}", model.diameter_m / kModelMillimetre), "a positive number");
  }
  model.box = read_box(entry);
  const std::vector<SE3d> discrete =
      read_discrete(entry, place_of(name, id, "symmetries_discrete"));
  const std::vector<SymmetryAxis> continuous = read_continuous(entry);
  try {
    model.symmetries = SymmetryGroup(discrete, continuous);
  } catch (const InvalidInput& error) {
    throw InvalidInput(fmt::format("{}: {}: {}", name, id, error.what()));
  }
  return model;
}

std::int64_t bop_object_id(const JsonPlace& root, const std::string& key) {
  const auto id = parse_integer(key);
  if (!id || *id < 0) root.fail(fmt::format("the key {}", in_quotes(key)), "an object id");
  return *id;
}

}  // namespace

std::array<Eigen::Vector3d, 8> ObjectBox::corners() const {
  std::array<Eigen::Vector3d, 8> corners;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector3d share(static_cast<double>(i & 1U), static_cast<double>(i >> 1U & 1U),
                                static_cast<double>(i >> 2U & 1U));
    corners[i] = lowest_m + share.cwiseProduct(size_m);
  }
  return corners;
}

BopModels parse_bop_models(std::string_view text, const std::string& name) {
  const Json json = parse_json(text, name, "models_info.json");
  const JsonPlace root(json, name);
  BopModels models;
  for (const std::string& key : root.keys()) {
    const std::int64_t id = bop_object_id(root, key);
    if (!models.emplace(id, read_bop_entry(root.member(key), name, key)).second)
      root.fail(fmt::format("object {} again", id), "every object once");
  }
  if (models.empty()) root.fail("no object", "at least one");
  return models;
}

BopModel parse_bop_model(std::string_view text, const std::string& name, std::int64_t object) {
  const Json json = parse_json(text, name, "models_info.json");
  const std::string id = std::to_string(object);
  return read_bop_entry(JsonPlace(json, name).member(id), name, id);
}

BopModels read_bop_models(const std::filesystem::path& path) {
  return parse_bop_models(read_file(path), path.string());
}

BopModel read_bop_model(const std::filesystem::path& path, std::int64_t object) {
  return parse_bop_model(read_file(path), path.string(), object);
}

}  // namespace posemix
