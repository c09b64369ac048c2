// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>

#include <fmt/format.h>

#include "json_place.hpp"
#include "paths.hpp"
#include "posemix/base/error.hpp"
#include "posemix/io/dataset.hpp"
#include "posemix/io/rigid.hpp"
#include "posemix/io/text.hpp"

namespace posemix {
namespace {

using namespace internal;

constexpr double kDatasetMillimetre = 1e-3;

Json parse_scene_document(std::string_view text, const std::string& name) {
  return parse_json(text, name, "an object with a key per image");
}

std::int64_t image_id(const JsonPlace& root, const std::string& key) {
  const auto id = parse_integer(key);
  if (!id || *id < 0) root.fail(fmt::format("the key {}", in_quotes(key)), "an image id");
  return *id;
}

SE3d read_bop_pose(const JsonPlace& entry, std::string_view rotation_key,
                   std::string_view translation_key, const std::string& where) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  const Eigen::VectorXd rotation = entry.member(rotation_key).vector(9);
  matrix.topLeftCorner<3, 3>() = Eigen::Map<const Eigen::Matrix3d>(rotation.data()).transpose();
  matrix.topRightCorner<3, 1>() = kDatasetMillimetre * entry.member(translation_key).vector(3);
  SE3d pose = pose_from_matrix(matrix, fmt::format("{}: {}", where, rotation_key));
  check_position(pose, fmt::format("{}: {}", where, translation_key));
  return pose;
}

std::int64_t read_object_number(const JsonPlace& place) {
  const double number = place.number();
  if (!(number >= 0.0 && number <= 1e9 &&
        number == static_cast<double>(static_cast<std::int64_t>(number))))
    place.fail(fmt::format("{:g}", number), "an object id");
  return static_cast<std::int64_t>(number);
}

}  // namespace

DatasetImages parse_bop_scene_gt(std::string_view text, const std::string& name) {
  const Json json = parse_scene_document(text, name);
  const JsonPlace root(json, name);
  DatasetImages images;
  for (const std::string& key : root.keys()) {
    const auto [at, is_new] = images.try_emplace(image_id(root, key));
    std::vector<DatasetInstance>& image = at->second;
    if (!is_new) root.fail(fmt::format("image {} again", key), "every image once");
    for (const JsonPlace& entry : root.member(key).items()) {
      const std::string where = fmt::format("{}: {}[{}]", name, key, image.size());
      image.push_back({read_object_number(entry.member("obj_id")),
                       read_bop_pose(entry, "cam_R_m2c", "cam_t_m2c", where)});
    }
  }
  if (images.empty()) root.fail("no image", "at least one");
  return images;
}

DatasetCameras parse_bop_scene_camera(std::string_view text, const std::string& name) {
  const Json json = parse_scene_document(text, name);
  const JsonPlace root(json, name);
  DatasetCameras cameras;
  for (const std::string& key : root.keys()) {
    const JsonPlace entry = root.member(key);
    entry.keys();
    std::optional<SE3d> pose;
    if (entry.has("cam_R_w2c") || entry.has("cam_t_w2c")) {
      pose = read_bop_pose(entry, "cam_R_w2c", "cam_t_w2c", fmt::format("{}: {}", name, key))
                 .inverse();
    }
    if (!cameras.emplace(image_id(root, key), pose).second)
      root.fail(fmt::format("image {} again", key), "every image once");
  }
  if (cameras.empty()) root.fail("no image", "at least one");
  return cameras;
}

std::filesystem::path bop_scene_folder(const std::filesystem::path& dataset,
                                       const std::string& split, std::int64_t scene) {
  return dataset / split / fmt::format("{:06}", scene);
}

DatasetScene read_bop_scene(const std::filesystem::path& dataset, const std::string& split,
                            std::int64_t scene) {
  const std::filesystem::path folder = bop_scene_folder(dataset, split, scene);
  if (!internal::is_folder(folder)) {
    throw InvalidInput(
        fmt::format("{}: is not there, expected the folder of scene {} in a BOP "
                    "dataset",
                    folder.string(), scene));
  }
  DatasetScene result;
  result.name = folder.string();
  const std::filesystem::path truth = folder / "scene_gt.json";
  const std::filesystem::path camera = folder / "scene_camera.json";
  const bool has_truth = internal::is_there(truth);
  if (has_truth) result.images = parse_bop_scene_gt(read_file(truth), truth.string());
  if (!has_truth || internal::is_there(camera))
    result.cameras = parse_bop_scene_camera(read_file(camera), camera.string());
  return result;
}

}  // namespace posemix
