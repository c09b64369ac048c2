// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "files.hpp"
#include "invariants.hpp"
#include "io/temporary_folder.hpp"
#include "posemix/grasp/outcome.hpp"
#include "posemix/io/grasp_outcomes.hpp"
#include "posemix/io/object_poses.hpp"
#include "posemix/io/pose_samples.hpp"
#include "posemix/io/pose_table.hpp"
#include "target.hpp"

/// Tables of poses, residuals, named poses and grasps. What is taken is taken from a file, too.
namespace posemix::fuzzing {
namespace {

using posemix::testing::TemporaryFolder;

void read_samples(std::string_view text, PoseFormat format, const PoseSampleOptions& options = {}) {
  takes("f.csv", [&] {
    const PoseSamples samples = parse_pose_samples(text, "f.csv", format, options);
    expect(samples.weights.empty() || samples.weights.size() == samples.poses.size(),
           "a number of weights that is not that of the poses");
    for (const SE3d& pose : samples.poses) expect_pose(pose);
    for (const double weight : samples.weights)
      expect(weight >= 0.0 && std::isfinite(weight), "a weight that is none");
    if (options.residuals) return;
    for (const PoseFormat each : {PoseFormat::csv, PoseFormat::tum, PoseFormat::npy}) {
      const auto again = parse_pose_samples(format_poses(samples.poses, each), "again", each);
      expect(again.poses.size() == samples.poses.size(), "another number of poses after writing");
    }
  });
}

void read_named_poses(std::string_view text) {
  takes("f.csv", [&] {
    const auto poses = parse_object_poses(text, "f.csv");
    for (const auto& [name, pose] : poses) expect_pose(pose);
    expect(parse_object_poses(format_object_poses(poses), "again").size() == poses.size(),
           "another number of objects after writing");
    expect(read_object_poses(file_of(text)).size() == poses.size(), "other objects in the file");
  });
}

/// A table of any name, whose end says in which format it is.
void read_named_samples(std::string_view bytes) {
  const NamedFile file(bytes);
  if (const auto format = pose_format_of(file.name)) read_samples(file.content, *format);
}

void read_table(std::string_view text) {
  takes("f.csv", [&] {
    const auto poses = parse_pose_table(text, "f.csv", {2, 5}, "est_");
    for (const auto& [image, pose] : poses) expect_pose(pose);
    expect(read_pose_table(file_of(text), {2, 5}, "est_").size() == poses.size(),
           "another number of poses in the file");
  });
  const auto path = file_of(text);
  takes(path.string(), [&] {
    for (const auto& [scene, objects] : read_table_objects(path))
      expect(!objects.empty(), "a scene without an object");
  });
}

void read_grasps(std::string_view text) {
  takes("f.csv", [&] {
    GraspOutcomes outcomes;
    parse_grasp_outcomes(text, "f.csv", "dataset", "estimator", outcomes);
  });
}

/// A table of any name in a folder of grasps.
void read_grasp_folder(std::string_view bytes) {
  static const TemporaryFolder folder;
  const NamedFile file(bytes);
  const auto path = folder.put("consensus-driven-uncertainty/" + file.name, file.content);
  takes(folder.path().string(), [&] {
    for (const GraspTrial& trial : read_grasp_outcomes(folder.path()).trials) {
      expect_pose(trial.estimate);
      expect(path.stem() == trial.dataset + "_" + trial.estimator, "a trial of another table");
    }
  });
  std::filesystem::remove(path);
}

}  // namespace

POSEMIX_FUZZ_TARGET(csv) {
  const Choice choice(bytes);
  switch (choice.letter) {
    case 't':
      return read_samples(choice.rest, PoseFormat::tum);
    case 'n':
      return read_samples(choice.rest, PoseFormat::npy);
    case 'l':
      return read_samples(choice.rest, PoseFormat::csv, {.residuals = Side::left});
    case 'r':
      return read_samples(choice.rest, PoseFormat::csv, {.residuals = Side::right, .weights = "w"});
    case 'o':
      return read_named_poses(choice.rest);
    case 'g':
      return read_grasps(choice.rest);
    case 'd':
      return read_grasp_folder(choice.rest);
    case 'a':
      return read_named_samples(choice.rest);
    case 'p':
      return read_table(choice.rest);
    default:
      return read_samples(choice.rest, PoseFormat::csv);
  }
}

}  // namespace posemix::fuzzing
