// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>

#include <gtest/gtest.h>

#include "posemix/base/units.hpp"
#include "posemix/fiducial/fiducials.hpp"
#include "posemix/io/gzip.hpp"
#include "posemix/io/tum.hpp"
#include "posemix/testing/data.hpp"

/// Observations of the recordings of TagSLAM against the surveyed poses of the tags.
namespace posemix {
namespace {

namespace fs = std::filesystem;

#ifdef POSEMIX_WITH_YAML

struct Recording {
  Fiducials fiducials;
  std::vector<RigCamera> cameras;
  TagMap tags;
  std::vector<StampedPose> rig;  ///< T_map_rig, by all sightings and the survey
};

Recording read_recording(const std::string& test) {
  const fs::path folder = *testing::data_dir() / "tagslam" / test;
  Recording recording;
  recording.cameras = read_cameras(folder / "cameras.yaml");
  read_camera_poses(folder / "camera_poses.yaml", recording.cameras);
  recording.tags = read_tag_map(folder / "tagslam.yaml");
  recording.rig = parse_tum(read_file_or_gzip(folder / "reference_rig.tum.gz"), "reference");
  recording.fiducials =
      observe_fiducials(read_corners(folder / "corners.csv.gz"), recording.cameras, recording.tags);
  return recording;
}

/// T_map_camera at about the time of an observation.
std::optional<SE3d> map_camera(const Recording& recording, const Observation& observation) {
  constexpr double kNear = 0.03;  // [s], of frames at 20 Hz
  const auto after =
      std::lower_bound(recording.rig.begin(), recording.rig.end(), observation.stamp_s - kNear,
                       [](const StampedPose& pose, double stamp) { return pose.stamp < stamp; });
  if (after == recording.rig.end() || after->stamp > observation.stamp_s + kNear)
    return std::nullopt;
  for (const RigCamera& camera : recording.cameras) {
    if (camera.name == observation.camera) return *after->pose * camera.rig_camera->pose;
  }
  return std::nullopt;
}

/// Of the observations of surveyed tags: sums over those with two components whose normals are more
/// than 15 degrees apart.
struct Score {
  double count = 0.0;
  double wrong = 0.0;           ///< leading components that are not the surveyed one
  double stated_wrong = 0.0;    ///< their expected number by the weights
  double sure_wrong = 0.0;      ///< with a weight above 0.99
  double normal_error_deg = 0;  ///< mean over all, of the nearer component
  double all = 0.0;
};

Score score(const Recording& recording) {
  Score out;
  for (const Observation& observation : recording.fiducials.observations) {
    const auto prior = recording.tags.priors.find(std::stoll(observation.object));
    const auto camera = map_camera(recording, observation);
    if (prior == recording.tags.priors.end() || !camera) continue;
    const auto normal = [](const SE3d& pose) -> Eigen::Vector3d {
      return pose.rotation() * Eigen::Vector3d::UnitZ();
    };
    const auto angle = [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
      return std::acos(std::clamp(a.dot(b), -1.0, 1.0)) / kRadPerDeg;
    };
    const Eigen::Vector3d truth = normal(camera->inverse() * prior->second.pose);
    std::vector<double> error;
    for (const auto& component : observation.components)
      error.push_back(angle(normal(component.pose), truth));
    out.all += 1.0;
    out.normal_error_deg += *std::min_element(error.begin(), error.end());
    if (error.size() < 2) continue;
    if (angle(normal(observation.components[0].pose), normal(observation.components[1].pose)) < 15)
      continue;
    const double weight = observation.components[0].weight;
    out.count += 1.0;
    out.stated_wrong += 1.0 - weight;
    if (error[0] > error[1]) {
      out.wrong += 1.0;
      out.sure_wrong += weight > 0.99 ? 1.0 : 0.0;
    }
  }
  out.normal_error_deg /= out.all;
  return out;
}

// The corners' order and the tag's axes are right, or normals and surveyed poses would disagree.
TEST(Recordings, NormalsAreThoseOfTheSurvey) {
  POSEMIX_REQUIRE_DATA();
  EXPECT_LT(score(read_recording("test_9")).normal_error_deg, 1.5);
  EXPECT_LT(score(read_recording("test_11")).normal_error_deg, 4.0);
}

// Weights are probabilities of the recordings too: as many leading components are wrong as they
// say, to a factor, and next to none of the sure ones.
TEST(Recordings, WeightsAreNotOverconfident) {
  POSEMIX_REQUIRE_DATA();
  for (const char* test : {"test_9", "test_11"}) {
    const Score found = score(read_recording(test));
    ASSERT_GT(found.count, 500.0) << test;
    EXPECT_LT(found.wrong, 1.5 * found.stated_wrong) << test;
    EXPECT_GT(found.wrong, 0.3 * found.stated_wrong) << test;
    EXPECT_LT(found.sure_wrong, 0.002 * found.count) << test;
    RecordProperty(std::string(test) + "_wrong", std::to_string(found.wrong / found.count));
  }
}

TEST(Recordings, NoSightingOfTheFisheyeRigIsLost) {
  POSEMIX_REQUIRE_DATA();
  const Recording recording = read_recording("test_5");
  EXPECT_EQ(recording.fiducials.sightings, 28063U);
  EXPECT_EQ(recording.fiducials.observations.size(), 28063U);
  ASSERT_EQ(recording.fiducials.noise.size(), 4U);
  for (const CameraCornerNoise& camera : recording.fiducials.noise) {
    EXPECT_EQ(camera.source, CornerNoiseSource::own);
    EXPECT_GT(camera.noise.sd_px, 0.05);
    EXPECT_LT(camera.noise.sd_px, 0.2);
  }
}

#endif

}  // namespace
}  // namespace posemix
