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

/// A small data folder in the layout of the recorded sequences.
namespace posemix::testing {

inline constexpr std::size_t kTreeFrames = 12;
inline constexpr std::string_view kTreeBox = "003_cracker_box_16k";

/// A camera that moves on a line in front of a static object, with known detection errors.
class RecordingTree {
 public:
  RecordingTree() {
    RandomStream random(11);
    for (std::size_t k = 0; k < kTreeFrames; ++k) {
      const auto t = static_cast<double>(k);
      const SE3d camera(SO3d::exp({0.0, 0.01 * t, 0.0}), {0.01 * t, 0.0, 0.0});
      stamps_.push_back(0.1 * t);
      truth_.push_back({0.1 * t, camera});
      odometry_.push_back({0.1 * t, truth_[0].pose->inverse() * camera *
                                        SE3d(SO3d(), Eigen::Vector3d(0.001 * t, 0.0, 0.0))});
      const SE3d relative = camera.inverse() * object_;
      relative_.push_back({0.1 * t, relative});
      Eigen::VectorXd noise(6);
      random.fill_normal(noise);
      const SE3d error = SE3d::exp(0.01 * noise);
      detections_.push_back({0.1 * t, k == 4 ? std::nullopt : std::optional(relative * error)});
    }
  }

  /// A DOPE recording of the cracker box with all of its files.
  void put_dope(const std::string& sequence, const std::filesystem::path& root = "slam-super-6d") {
    const auto experiments = root / "experiments/ycbv";
    const auto inference = experiments / "inference" / kTreeBox;
    put(inference / "Initial" / (sequence + ".txt"),
        format_tum(detections_, TumMisses::write_zeros));
    put(inference / "ground_truth" / (sequence + "_ycb_gt.txt"), format_tum(relative_));
    put_camera(sequence, root);
    put(experiments / "odom/YCB.yaml",
        "%YAML:1.0\nCamera.fx: 1000.0\nCamera.fy: 1000.0\nCamera.cx: 320.0\nCamera.cy: 240.0\n");
    put(experiments / "_ycb_original.json",
        fmt::format(
            R"({{"exported_objects": [{{"class": "{}", "cuboid_dimensions": [6, 16, 21]}}]}})",
            kTreeBox));
  }

  /// A CosyPose recording of objects 4 and 14, with a stray file of object 7.
  void put_cosypose(const std::string& sequence) {
    const std::filesystem::path folder = std::filesystem::path("midway/cosypose") / sequence;
    for (std::size_t k = 0; k < kTreeFrames; ++k) {
      for (const int id : {4, 14}) {
        if (!detections_[k].pose) continue;
        put(folder / fmt::format("obj_{:06}_{:06}.npy", id, k + 1),
            npy_bytes(detections_[k].pose->matrix(), {.wide = true}));
      }
    }
    put_camera(sequence, "slam-super-6d");
    put(fmt::format("derived/{}_proxy_objects.txt", sequence),
        format_object_poses({{"4", object_}, {"14", object_}}));
  }

  /// A table of an estimator with objects 2 and 14 of a scene, in every second image.
  void put_table(const std::string& estimator, int scene) {
    std::string text = "# made up\nobj_id,scene_id,im_id";
    for (const char* prefix : {"est_", "gt_"}) {
      for (const char* column : {"tx", "ty", "tz", "qx", "qy", "qz", "qw"})
        text += fmt::format(",{}{}", prefix, column);
    }
    for (std::size_t k = 1; k < kTreeFrames; k += 2) {
      for (const int id : {14, 2}) {
        text += fmt::format("\n{},{},{}", id, scene, k + 1) + row_of(*detections_[k].pose) +
                row_of(*relative_[k].pose);
      }
    }
    put(fmt::format("consensus-driven-uncertainty/ycbv_{}.csv", estimator), text + "\n");
    put_camera(fmt::format("{:0>4}", scene), "slam-super-6d");
  }

  const SE3d& detection(std::size_t frame) const { return *detections_[frame].pose; }
  const SE3d& relative(std::size_t frame) const { return *relative_[frame].pose; }

  void put(const std::filesystem::path& name, std::string_view content) {
    folder_.put(name, content);
  }
  void remove(const std::filesystem::path& name) {
    if (!std::filesystem::remove(folder_ / name)) throw std::logic_error("no " + name.string());
  }
  const std::filesystem::path& path() const { return folder_.path(); }

 private:
  static std::string row_of(const SE3d& pose) {
    const Eigen::Vector3d& t = pose.translation();
    const Eigen::Vector4d q = pose.rotation().quaternion().coeffs();
    return fmt::format(",{},{},{},{},{},{},{}", t[0], t[1], t[2], q[0], q[1], q[2], q[3]);
  }

  void put_camera(const std::string& sequence, const std::filesystem::path& root) {
    const auto odom = root / "experiments/ycbv/odom";
    put(odom / "ground_truth" / (sequence + ".txt"), format_tum(truth_));
    put(odom / "results" / (sequence + ".txt"), format_tum(odometry_));
  }

  TemporaryFolder folder_;
  SE3d object_{SO3d::exp({0.2, 0.3, 0.1}), {0.1, 0.0, 0.8}};
  std::vector<double> stamps_;
  std::vector<StampedPose> truth_;     ///< T_world_camera, of the annotated frame
  std::vector<StampedPose> odometry_;  ///< one millimetre off per frame
  std::vector<StampedPose> relative_;
  std::vector<StampedPose> detections_;  ///< none in frame 4
};

}  // namespace posemix::testing
