// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <string>
#include <vector>

#include <fmt/format.h>

#include "config/small_bop.hpp"
#include "posemix/io/observation_csv.hpp"
#include "posemix/io/observation_jsonl.hpp"
#include "results/bounded_run.hpp"
#include "target.hpp"

/// Sequence files over a small recording, then the first frames of `posemix slam` by them and its
/// results. The recording has files of every kind that a sequence file can name.
namespace posemix::fuzzing {
namespace {

using posemix::testing::SmallFolder;

constexpr std::size_t kMostFrames = 3;

/// Of the objects 4 and 5 by two detectors through a rig of two cameras, of 14 by its class.
std::vector<Observation> observations_of(const testing::SmallRecording& recording) {
  std::vector<Observation> all;
  for (std::size_t k = 0; k < testing::kSmallFrames; ++k) {
    for (std::size_t i = 0; i < recording.objects.size(); ++i) {
      Observation seen = observation_of(recording.detections[i][k]);
      (i < 2 ? seen.object : seen.class_id) = std::to_string(testing::kSmallObjects[i]);
      seen.camera = k % 2 == 0 ? "left" : "right";
      seen.detector = i == 0 ? "near" : "far";
      seen.stamp_s = recording.stamps[k];
      all.push_back(seen);
    }
  }
  return all;
}

/// A pose table with estimates and truth of object 4.
std::string pose_table(const testing::SmallRecording& recording) {
  std::string text = "scene_id,im_id,obj_id";
  for (const char* side : {"est", "gt"})
    for (const char* column : {"tx", "ty", "tz", "qx", "qy", "qz", "qw"})
      text += fmt::format(",{}_{}", side, column);
  for (std::size_t k = 0; k < testing::kSmallFrames; ++k) {
    text += fmt::format("\n2,{},4", k + 1);
    const SE3d truth = recording.camera[k].inverse() * recording.objects[0];
    for (const SE3d& pose : {recording.detections[0][k], truth}) {
      const Eigen::Vector3d t = pose.translation();
      const Eigen::Vector4d q = pose.rotation().quaternion().coeffs();
      text += fmt::format(",{},{},{},{},{},{},{}", t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w());
    }
  }
  return text + "\n";
}

/// The small recording, and what else a sequence file may name.
struct Recording : SmallFolder {
  Recording() {
    const std::vector<Observation> seen = observations_of(recording);
    folder.put("observations.csv", format_observations(seen));
    folder.put("observations.jsonl", format_observation_lines(seen));
    folder.put("poses.csv", pose_table(recording));
    const testing::BopTexts bop(recording);
    folder.put("bop/test/000002/scene_gt.json", bop.truth);
    folder.put("bop/test/000002/scene_camera.json", bop.camera);
    folder.put("results.csv", testing::bop_results(recording));
    folder.put("models_info.json",
               R"({"5": {"diameter": 90, "symmetries_discrete": [[-1, 0, 0, 0, 0, -1, 0, 0, )"
               R"(0, 0, 1, 0, 0, 0, 0, 1]]}, "4": {"diameter": 90, "symmetries_continuous": )"
               R"([{"axis": [0, 0, 1], "offset": [0, 0, 0]}]}})");
    folder.put("images.txt", "0 left\n0.1 right@far\n");
    folder.put("stamps.txt", "0\n0.05\n0.1\n");
    folder.put("gripper.tum", "0 0.1 0 0.5 0 0 0 1\n1 0.2 0 0.5 0 0 0 1\n");
  }
};

}  // namespace

POSEMIX_FUZZ_TARGET(sequence) {
  static const Recording recorded;
  takes("", [&] {
    testing::run_first_frames(TomlDocument::parse(bytes, "s.toml"), recorded.folder.path(),
                              kMostFrames);
  });
}

}  // namespace posemix::fuzzing
