// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/fiducial/camera_file.hpp"

#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "posemix/base/error.hpp"
#include "posemix/io/rigid.hpp"
#include "posemix/io/text.hpp"
#include "yaml_pose.hpp"

namespace posemix {
namespace {

using namespace internal;

DistortionModel distortion_of(const YamlValue& value) {
  const std::string word = value.text();
  // Other names of the same models in ROS, kalibr and OpenCV.
  if (word == "equi" || word == "fisheye") return DistortionModel::equidistant;
  if (word == "plumb_bob") return DistortionModel::radtan;
  for (const auto& [name, model] : words<DistortionModel>) {
    if (word == name) return model;
  }
  value.fail(in_quotes(word), "equidistant, radtan or none");
}

CameraModel model_of(const YamlValue& value) {
  if (const auto kind = value.find("camera_model"); kind && kind->text() != "pinhole")
    kind->fail(in_quotes(kind->text()), "pinhole");
  CameraModel model;
  const std::vector<double> intrinsics = value.at("intrinsics").numbers(4);
  model.intrinsics = Eigen::Map<const Eigen::Vector4d>(intrinsics.data());
  if (const auto distortion = value.find("distortion_model"))
    model.distortion = distortion_of(*distortion);
  if (const auto coefficients = value.find("distortion_coeffs");
      coefficients && model.distortion != DistortionModel::none)
    model.coefficients = coefficients->numbers();
  try {
    validate(model);
  } catch (const InvalidInput& error) {
    value.refuse(error.what());
  }
  return model;
}

/// T_camera_previous of kalibr, four rows of four numbers.
SE3d chained(const YamlValue& value) {
  const std::vector<YamlValue> rows = value.elements();
  if (rows.size() != 4) value.fail(fmt::format("{} rows", rows.size()), "4");
  Eigen::Matrix4d matrix;
  for (std::size_t i = 0; i < 4; ++i)
    matrix.row(static_cast<Eigen::Index>(i)) =
        Eigen::Map<const Eigen::RowVector4d>(rows[i].numbers(4).data());
  try {
    return SE3d::from_matrix(matrix, kRotationTolerance);
  } catch (const InvalidInput& error) {
    value.refuse(error.what());
  }
}

int pixels_of(const YamlValue& value) {
  constexpr std::int64_t kMostPixels = 1'000'000;
  const std::int64_t pixels = value.integer();
  if (pixels < 1 || pixels > kMostPixels)
    value.fail(fmt::format("{}", pixels), fmt::format("pixels, 1 to {}", kMostPixels));
  return static_cast<int>(pixels);
}

RigCamera camera_of(const std::string& name, const YamlValue& value) {
  RigCamera camera;
  camera.name = name;
  camera.model = model_of(value);
  if (const auto resolution = value.find("resolution")) {
    const std::vector<YamlValue> size = resolution->elements();
    if (size.size() != 2) resolution->fail(fmt::format("{} numbers", size.size()), "2");
    camera.resolution = {pixels_of(size[0]), pixels_of(size[1])};
  }
  for (const char* key : {"tagtopic", "rostopic"}) {
    if (const auto topic = value.find(key)) camera.topics.push_back(topic->text());
  }
  return camera;
}

}  // namespace

std::vector<RigCamera> parse_cameras(std::string_view text, const std::string& name) {
  const YamlValue document = YamlValue::document(text, name);
  std::map<std::string, YamlValue> by_name;
  for (const auto& [key, value] : document.entries()) {
    if (!by_name.emplace(key, value).second)
      value.fail("camera " + in_quotes(key) + " again", "every camera once");
  }
  std::vector<RigCamera> cameras;
  for (const auto& [key, value] : by_name) {
    RigCamera camera = camera_of(key, value);
    if (const auto chain = value.find("T_cn_cnm1")) {
      if (cameras.empty()) chain->fail("a pose relative to the camera before", "none");
      StatedPose& before =
          cameras.back().rig_camera.emplace(cameras.back().rig_camera.value_or(StatedPose{}));
      camera.rig_camera = StatedPose{before.pose * chained(*chain).inverse(), {}};
    }
    cameras.push_back(std::move(camera));
  }
  if (cameras.empty()) document.fail("no cameras", "at least one");
  return cameras;
}

std::vector<RigCamera> read_cameras(const std::filesystem::path& path) {
  return parse_cameras(read_file(path), path.string());
}

void parse_camera_poses(std::string_view text, const std::string& name,
                        std::vector<RigCamera>& cameras) {
  for (const auto& [key, value] : YamlValue::document(text, name).entries()) {
    const auto camera =
        std::find_if(cameras.begin(), cameras.end(),
                     [&wanted = key](const RigCamera& c) { return c.name == wanted; });
    if (camera == cameras.end()) value.fail("camera " + in_quotes(key), "one with intrinsics");
    camera->rig_camera = pose_of(value.at("pose"));
  }
}

void read_camera_poses(const std::filesystem::path& path, std::vector<RigCamera>& cameras) {
  parse_camera_poses(read_file(path), path.string(), cameras);
}

}  // namespace posemix
