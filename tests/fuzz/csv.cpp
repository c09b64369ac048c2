// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "invariants.hpp"
#include "posemix/grasp/outcome.hpp"
#include "posemix/io/grasp_outcomes.hpp"
#include "posemix/io/object_poses.hpp"
#include "posemix/io/pose_samples.hpp"
#include "posemix/io/pose_table.hpp"
#include "target.hpp"

/// Tables of poses, residuals, named poses and grasps.
namespace posemix::fuzzing {
namespace {

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
  });
}

void read_grasps(std::string_view text) {
  takes("f.csv", [&] {
    GraspOutcomes outcomes;
    parse_grasp_outcomes(text, "f.csv", "dataset", "estimator", outcomes);
  });
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
    case 'p':
      takes("f.csv", [&] {
        for (const auto& [image, pose] : parse_pose_table(choice.rest, "f.csv", {2, 5}, "est_"))
          expect_pose(pose);
      });
      return;
    default:
      return read_samples(choice.rest, PoseFormat::csv);
  }
}

}  // namespace posemix::fuzzing
