// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <string>

#include <fmt/format.h>

#include "config/small_recording.hpp"

/// The small recording as files of the BOP benchmark: scene 2 with objects 4, 5 and 14.
namespace posemix::testing {

inline constexpr std::int64_t kSmallObjects[] = {4, 5, 14};

/// The entries of a matrix, row by row, as "[1, 2, 3]".
inline std::string json_numbers(const Eigen::Ref<const Eigen::MatrixXd>& matrix) {
  std::string text;
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    for (Eigen::Index j = 0; j < matrix.cols(); ++j)
      text += fmt::format("{}{:.12g}", text.empty() ? "" : ", ", matrix(i, j));
  }
  return "[" + text + "]";
}

/// A pose as `"R": [...], "t": [...]`, t in millimetres.
inline std::string bop_pose(const SE3d& pose, const std::string& of) {
  return fmt::format("\"cam_R_{}\": {}, \"cam_t_{}\": {}", of,
                     json_numbers(pose.rotation().matrix()), of,
                     json_numbers(1000.0 * pose.translation()));
}

/// BOP's files of the recording's first images, which are numbered from one.
struct BopTexts {
  explicit BopTexts(const SmallRecording& recording, std::size_t images = kSmallFrames) {
    for (std::size_t k = 0; k < images; ++k) {
      const SE3d camera_world = recording.camera[k].inverse();
      camera += fmt::format(
          "{}\n  \"{}\": {{\"cam_K\": [1, 0, 0, 0, 1, 0, 0, 0, 1], "
          "\"depth_scale\": 0.1, {}}}",
          k == 0 ? "{" : ",", k + 1, bop_pose(camera_world, "w2c"));
      truth += fmt::format("{}\n  \"{}\": [", k == 0 ? "{" : ",", k + 1);
      for (std::size_t i = 0; i < recording.objects.size(); ++i) {
        truth +=
            fmt::format("{}{{{}, \"obj_id\": {}}}", i == 0 ? "" : ",\n",
                        bop_pose(camera_world * recording.objects[i], "m2c"), kSmallObjects[i]);
      }
      truth += "]";
    }
    truth += "\n}\n";
    camera += "\n}\n";
  }

  std::string truth;
  std::string camera;
};

/// All detections of the recording.
inline std::string bop_results(const SmallRecording& recording) {
  std::string text = "scene_id,im_id,obj_id,score,R,t,time\n";
  for (std::size_t k = 0; k < kSmallFrames; ++k) {
    for (std::size_t i = 0; i < recording.objects.size(); ++i) {
      std::string row = SmallFolder::bop_row(k + 1, 0.9, recording.detections[i][k]);
      const std::string before = fmt::format("2,{},5,", k + 1);
      text += fmt::format("2,{},{},", k + 1, kSmallObjects[i]) + row.substr(before.size());
    }
  }
  return text;
}

}  // namespace posemix::testing
