// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cmath>

#include <fmt/format.h>

#include "mat_file.hpp"
#include "paths.hpp"
#include "posemix/base/error.hpp"
#include "posemix/io/dataset.hpp"
#include "posemix/io/rigid.hpp"
#include "posemix/io/text.hpp"

namespace posemix {
namespace {

using namespace internal;

constexpr std::string_view kMetaEnd = "-meta.mat";
constexpr std::size_t kMostClasses = 10'000;
constexpr std::size_t kPoseEntries = 12;

/// The pose of twelve numbers, a 3x4 matrix column by column, in metres.
SE3d pose_from_columns(const double* numbers, const std::string& where) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.topRows<3>() = Eigen::Map<const Eigen::Matrix<double, 3, 4>>(numbers);
  SE3d pose = pose_from_matrix(matrix, where);
  check_position(pose, where);
  return pose;
}

std::string place_in(const std::filesystem::path& path, const char* variable) {
  return fmt::format("{}: variable '{}'", path.string(), variable);
}

std::vector<std::int64_t> read_classes(const MatFile& file) {
  const MatArray array = file.array("cls_indexes", kMostClasses);
  std::vector<std::int64_t> classes;
  for (const double number : array.values) {
    const bool fits = number >= 0.0 && number <= 1e9 && number == std::floor(number);
    if (!fits) file.fail("cls_indexes", fmt::format("{:g}", number), "numbers of objects");
    classes.push_back(static_cast<std::int64_t>(number));
  }
  return classes;
}

std::vector<DatasetInstance> read_meta_objects(const MatFile& file,
                                               const std::filesystem::path& path) {
  const std::vector<std::int64_t> classes = read_classes(file);
  const MatArray poses = file.array("poses", kPoseEntries * kMostClasses);
  const bool fits = (classes.empty() && poses.values.empty()) ||
                    (poses.dims.size() >= 2 && poses.dims[0] == 3 && poses.dims[1] == 4 &&
                     poses.values.size() == kPoseEntries * classes.size());
  if (!fits)
    file.fail("poses", describe_dims(poses.dims),
              fmt::format("3x4x{} as there are {} cls_indexes", classes.size(), classes.size()));
  std::vector<DatasetInstance> objects;
  for (std::size_t i = 0; i < classes.size(); ++i) {
    const std::string where = fmt::format("{}: matrix {}", place_in(path, "poses"), i + 1);
    objects.push_back({classes[i], pose_from_columns(&poses.values[kPoseEntries * i], where)});
  }
  return objects;
}

std::optional<SE3d> read_meta_camera(const MatFile& file, const std::filesystem::path& path) {
  constexpr const char* kVariable = "rotation_translation_matrix";
  if (!file.has(kVariable)) return std::nullopt;
  const MatArray matrix = file.array(kVariable, kPoseEntries);
  if (matrix.dims != std::vector<std::size_t>{3, 4})
    file.fail(kVariable, describe_dims(matrix.dims), "3x4");
  return pose_from_columns(matrix.values.data(), place_in(path, kVariable)).inverse();
}

}  // namespace

DatasetScene read_ycb_video_scene(const std::filesystem::path& dataset,
                                  const std::string& sequence) {
  const std::filesystem::path folder = dataset / "data" / sequence;
  DatasetScene scene;
  scene.name = folder.string();
  if (!internal::is_folder(folder)) {
    throw InvalidInput(
        fmt::format("{}: is not there, expected the folder of a YCB-Video sequence", scene.name));
  }
  for (const std::filesystem::path& path : internal::entries_of(folder)) {
    const std::string file_name = path.filename().string();
    if (!file_name.ends_with(kMetaEnd)) continue;
    const auto number =
        parse_integer(std::string_view(file_name).substr(0, file_name.size() - kMetaEnd.size()));
    if (!number || *number < 0)
      throw InvalidInput(path.string() +
                         ": got a name without a frame number, expected "
                         "NNNNNN-meta.mat");
    const MatFile file(path);
    scene.images[*number] = read_meta_objects(file, path);
    scene.cameras[*number] = read_meta_camera(file, path);
  }
  if (scene.images.empty())
    throw InvalidInput(scene.name + ": got no file NNNNNN-meta.mat, expected one per frame");
  return scene;
}

std::vector<std::string> read_ycb_video_names(const std::filesystem::path& dataset) {
  const std::filesystem::path path = dataset / "image_sets" / "classes.txt";
  if (!internal::is_there(path)) return {};
  const std::string text = read_file(path);
  LineReader reader(text, path.string());
  std::vector<std::string> names;
  while (reader.next_content()) names.emplace_back(trimmed(reader.line()));
  return names;
}

}  // namespace posemix
