// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <string>
#include <vector>

#include <fmt/format.h>

#include "io/npy_bytes.hpp"
#include "io/temporary_folder.hpp"
#include "posemix/base/random.hpp"
#include "posemix/io/object_poses.hpp"
#include "posemix/io/tum.hpp"

/// A small recording in a temporary folder: three objects, one for each kind of detection file.
namespace posemix::testing {

inline constexpr std::size_t kSmallFrames = 20;

inline constexpr std::string_view kSmallToml = R"(schema = 1
sequence = "0001"

[camera]
odometry = "odometry.txt"
ground_truth = "truth/${sequence}.txt"

[camera.start]
pose = "ground_truth"
rotation_sd_deg = 0.1
translation_sd_m = 0.002

[motion]
noise = {per = "second", rotation_sd_deg = 0.15, translation_sd_m = 0.002}

[noise.detector]
components = [
  {weight = 0.7, rotation_sd_deg = 3, translation_sd_m = 0.005},
  {weight = 0.3, rotation_sd_deg = [3, 3, 9], translation_sd_m = 0.005},
]

[[objects]]
id = "mug"
noise = "detector"
detections = {tum = "mug.txt"}
ground_truth = {relative_tum = "mug_truth.txt"}

[[objects]]
id = "box"
noise = "detector"
detections = {npy = "box", prefix = "obj_000006_"}
ground_truth = {world_poses = "objects.txt"}

[[objects]]
id = "can"
noise = "detector"
detections = {bop = "can.csv", scene = 2, object = 5}
ground_truth = {world_pose = [0.0, 0.1, 0.7, 0, 0, 0, 1]}

[filter]
method = "gm-iekf"
max_components = 4
gate_probability = 0.9999
update = "linearized"
)";

/// The true poses and the detections.
struct SmallRecording {
  std::vector<double> stamps;
  std::vector<SE3d> camera;                   ///< T_world_camera
  std::vector<SE3d> objects;                  ///< T_world_object: mug, box, can
  std::vector<std::vector<SE3d>> detections;  ///< T_camera_object by object, then frame

  SmallRecording() {
    objects = {SE3d(SO3d::exp({0.3, 0.1, 0.0}), {0.1, 0.0, 0.5}),
               SE3d(SO3d::exp({0.0, 0.4, -0.2}), {-0.1, 0.05, 0.6}), SE3d(SO3d(), {0.0, 0.1, 0.7})};
    RandomStream random(7);
    detections.resize(objects.size());
    for (std::size_t k = 0; k < kSmallFrames; ++k) {
      const auto t = static_cast<double>(k);
      stamps.push_back(0.1 * t);
      camera.push_back(SE3d::exp(
          (SE3d::Tangent() << 0.002 * t, 0.2, 0.003 * t, 0.01 * t, 0.002 * t, 0.0).finished()));
      for (std::size_t i = 0; i < objects.size(); ++i) {
        Eigen::VectorXd noise(6);
        random.fill_normal(noise);
        noise.head<3>() *= 0.04;
        noise.tail<3>() *= 0.004;
        detections[i].push_back(camera.back().inverse() * objects[i] * SE3d::exp(noise));
      }
    }
  }
};

/// Writes the recording's files and sequence.toml into a folder of its own.
class SmallFolder {
 public:
  SmallFolder() {
    std::vector<StampedPose> odometry, truth, mug, mug_truth;
    std::string bop = "scene_id,im_id,obj_id,score,R,t,time\n";
    for (std::size_t k = 0; k < kSmallFrames; ++k) {
      const double stamp = recording.stamps[k];
      odometry.push_back({stamp, recording.camera[0].inverse() * recording.camera[k]});
      truth.push_back({stamp, recording.camera[k]});
      mug.push_back({stamp, k == 3 ? std::nullopt : std::optional(recording.detections[0][k])});
      mug_truth.push_back({stamp, recording.camera[k].inverse() * recording.objects[0]});
      folder.put(fmt::format("box/obj_000006_{:06}.npy", k + 1),
                 npy_bytes(recording.detections[1][k].matrix(), {.wide = true}));
      if (k % 2 == 0) bop += bop_row(k + 1, 0.9, recording.detections[2][k]);
      if (k % 4 == 0) bop += bop_row(k + 1, 0.2, SE3d(SO3d(), {1.0, 1.0, 1.0}));
    }
    folder.put("odometry.txt", format_tum(odometry));
    folder.put("truth/0001.txt", format_tum(truth));
    folder.put("mug.txt", format_tum(mug, TumMisses::write_zeros));
    folder.put("mug_truth.txt", format_tum(mug_truth));
    folder.put("can.csv", bop);
    folder.put("objects.txt", format_object_poses({{"box", recording.objects[1]}}));
    folder.put("sequence.toml", kSmallToml);
  }

  static std::string bop_row(std::size_t image, double score, const SE3d& pose) {
    const Eigen::Matrix3d r = pose.rotation().matrix();
    const Eigen::Vector3d t = 1000.0 * pose.translation();
    return fmt::format(
        "2,{},5,{},{:.12f} {:.12f} {:.12f} {:.12f} {:.12f} {:.12f} {:.12f} {:.12f} {:.12f},{} {} "
        "{},-1\n",
        image, score, r(0, 0), r(0, 1), r(0, 2), r(1, 0), r(1, 1), r(1, 2), r(2, 0), r(2, 1),
        r(2, 2), t.x(), t.y(), t.z());
  }

  std::filesystem::path toml() const { return folder / "sequence.toml"; }

  SmallRecording recording;
  TemporaryFolder folder;
};

/// `text` with the first occurrence of `old` replaced; throws if there is none.
inline std::string replaced(std::string text, std::string_view old, std::string_view by) {
  const std::size_t at = text.find(old);
  if (at == std::string::npos) throw std::logic_error("not in the text: " + std::string(old));
  return text.replace(at, old.size(), by);
}

}  // namespace posemix::testing
