// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "scene.hpp"

#include <algorithm>
#include <numeric>
#include <set>

#include <fmt/format.h>

#include "posemix/base/error.hpp"
#include "posemix/io/pose_table.hpp"
#include "posemix/io/text.hpp"
#include "study/recordings/table_folder.hpp"
#include "study/tless/scene.hpp"

namespace posemix {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> files_with(const fs::path& folder, std::string_view begin,
                                 std::string_view part) {
  std::vector<fs::path> found;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    const std::string name = it->path().filename().string();
    if (name.starts_with(begin) && name.ends_with(".csv") && name.find(part) != std::string::npos)
      found.push_back(it->path());
  }
  if (error) throw InvalidInput(fmt::format("{}: {}", folder.string(), error.message()));
  if (found.empty()) {
    throw InvalidInput(
        fmt::format("{}: holds no file {}*{}*.csv, expected one", folder.string(), begin, part));
  }
  std::sort(found.begin(), found.end());
  return found;
}

/// The true poses of the tables' objects; an object may be in several tables.
std::vector<BopRow> truth_of_tables(const fs::path& folder) {
  std::vector<BopRow> rows;
  std::set<std::tuple<std::int64_t, std::int64_t, std::int64_t>> known;
  for (const fs::path& path : files_with(folder, "ycbv_", "")) {
    const std::string text = read_file(path);
    for (const auto& [scene, objects] : read_table_objects(path)) {
      for (const std::int64_t object : objects) {
        for (const auto& [image, pose] :
             parse_pose_table(text, path.string(), {scene, object}, "gt_")) {
          if (known.insert({scene, image, object}).second)
            rows.push_back({scene, image, object, 1.0, pose});
        }
      }
    }
  }
  return rows;
}

using RowsByImage = std::map<std::int64_t, std::vector<BopRow>>;

MultiViewScene scene_of(const std::string& dataset, std::int64_t number, const RowsByImage& truth,
                        const RowsByImage& estimates) {
  std::vector<std::vector<BopRow>> images;
  for (const auto& [image, rows] : truth) images.push_back(rows);
  const StaticScene placed = static_scene(images);
  MultiViewScene scene;
  scene.dataset = dataset;
  scene.number = number;
  std::size_t k = 0;
  for (const auto& [image, rows] : truth) {
    const std::optional<SE3d>& camera = placed.world_camera[k++];
    if (!camera) continue;
    scene.images.push_back(image);
    scene.world_camera.push_back(*camera);
    scene.truth.push_back(rows);
    const auto found = estimates.find(image);
    scene.estimates.push_back(found == estimates.end() ? std::vector<BopRow>{} : found->second);
  }
  for (const StaticScene::Instance& instance : placed.instances)
    scene.world_objects[instance.object].push_back(instance.world_object);
  return scene;
}

}  // namespace

std::vector<MultiViewScene> read_multi_view_scenes(const fs::path& data,
                                                   const std::string& dataset) {
  const fs::path folder = data / "bop_toolkit";
  const std::vector<BopRow> truth = dataset == "tless"
                                        ? read_bop_rows(files_with(folder, "gt-", dataset).front())
                                        : truth_of_tables(data / kTableFolder);
  std::map<std::int64_t, RowsByImage> true_rows, estimated;
  for (const BopRow& row : truth) true_rows[row.scene][row.image].push_back(row);
  for (const BopRow& row : read_bop_rows(files_with(folder, "", "megapose_" + dataset).front()))
    estimated[row.scene][row.image].push_back(row);
  std::vector<MultiViewScene> scenes;
  scenes.reserve(true_rows.size());
  for (const auto& [number, rows] : true_rows)
    scenes.push_back(scene_of(dataset, number, rows, estimated[number]));
  return scenes;
}

std::vector<std::vector<std::size_t>> image_groups(std::size_t images, std::size_t views,
                                                   RandomStream* stream) {
  std::vector<std::size_t> order(images);
  std::iota(order.begin(), order.end(), std::size_t{0});
  if (stream != nullptr) {
    for (std::size_t i = images; i > 1; --i) {
      const auto k = static_cast<std::size_t>(stream->uniform() * static_cast<double>(i));
      std::swap(order[i - 1], order[std::min(k, i - 1)]);
    }
  }
  std::vector<std::vector<std::size_t>> groups;
  for (std::size_t begin = 0; begin + 1 < images; begin += views) {
    const std::size_t end = std::min(begin + views, images);
    groups.emplace_back(order.begin() + static_cast<std::ptrdiff_t>(begin),
                        order.begin() + static_cast<std::ptrdiff_t>(end));
  }
  return groups;
}

}  // namespace posemix
