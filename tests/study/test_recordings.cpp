// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "study/recordings/recordings.hpp"

#include "io/expect_invalid.hpp"
#include "posemix/io/text.hpp"
#include "posemix/testing/data.hpp"
#include "recording_tree.hpp"

namespace posemix {
namespace {

using testing::RecordingTree;

constexpr const char* kOdom = "slam-super-6d/experiments/ycbv/odom/";

TEST(Recordings, AreFoundAndSorted) {
  RecordingTree tree;
  tree.put_dope("0060");
  tree.put_dope("0001");
  tree.put_cosypose("0022");
  tree.put("slam-super-6d/experiments/ycbv/inference/README", "not a folder");
  const auto found = find_recordings(tree.path());
  const std::string box(testing::kTreeBox);
  const std::vector<Recording> expected{{tree.path(), "cosypose", "all", "0022", {"4", "14"}},
                                        {tree.path(), "dope", box, "0001", {box}},
                                        {tree.path(), "dope", box, "0060", {box}}};
  EXPECT_EQ(found, expected);
}

TEST(Recordings, AreFoundInTheInnerFolderToo) {
  RecordingTree tree;
  tree.put_dope("0001");
  const auto inner = tree.path() / "slam-super-6d";
  ASSERT_EQ(find_recordings(inner).size(), 1U);
  EXPECT_EQ(read_recording(find_recordings(inner)[0]).sequence.stamps.size(), testing::kTreeFrames);
}

TEST(Recordings, OneStrayFileIsNoObject) {
  RecordingTree tree;
  tree.put_cosypose("0022");
  for (int k = 0; k < 300; ++k)
    tree.put(fmt::format("midway/cosypose/0022/obj_000004_{:06}.npy", 100 + k), "");
  tree.put("midway/cosypose/0022/obj_000007_000003.npy", "");
  EXPECT_EQ(find_recordings(tree.path())[0].objects, (std::vector<std::string>{"4", "14"}));
}

TEST(Recordings, EveryFileIsRead) {
  RecordingTree tree;
  tree.put_dope("0001");
  tree.put_cosypose("0022");
  for (const Recording& recording : find_recordings(tree.path())) {
    const SlamJob job = read_recording(recording);
    EXPECT_EQ(job.sequence.odometry.size(),
              recording.detector == "dope" ? testing::kTreeFrames : 0U);
    EXPECT_EQ(job.sequence.camera_truth.size(), testing::kTreeFrames);
    ASSERT_EQ(job.models.size(), recording.objects.size());
    for (std::size_t i = 0; i < job.models.size(); ++i) {
      EXPECT_EQ(job.models[i].id, recording.objects[i]);
      EXPECT_FALSE(job.sequence.objects[i].detections[4].has_value());
      EXPECT_TRUE(job.sequence.objects[i].detections[5].has_value());
    }
  }
}

/// The lever arm of these scenes leaves a static object static: 0.33 deg and 0.9 mm in the median
/// over pairs of scene and object, according to the README of the data.
TEST(Recordings, ObjectsOfTheTablesStandStill) {
  POSEMIX_REQUIRE_DATA();
  std::size_t pairs = 0;
  for (const Recording& recording : find_recordings(*testing::data_dir())) {
    if (recording.detector != "gdrnpp") continue;
    const SlamJob job = read_recording(recording);
    for (const ObjectRecording& object : job.sequence.objects) {
      std::vector<Eigen::Vector3d> places;
      for (std::size_t k = 0; k < job.sequence.stamps.size(); ++k) {
        if (object.relative_truth[k])
          places.push_back(
              (*job.sequence.camera_truth[k] * *object.relative_truth[k]).translation());
      }
      Eigen::Vector3d centre = Eigen::Vector3d::Zero();
      for (const auto& place : places) centre += place / static_cast<double>(places.size());
      double sum = 0.0;
      for (const auto& place : places) sum += (place - centre).squaredNorm();
      EXPECT_LT(std::sqrt(sum / static_cast<double>(places.size())), 4e-3)
          << recording.sequence << " " << object.id;
      ++pairs;
    }
  }
  if (pairs == 0) GTEST_SKIP() << "no tables";
}

/// Image i of a table is frame i, counted from one, of the scene's camera files.
TEST(Recordings, ScenesOfTablesAreRecordings) {
  RecordingTree tree;
  tree.put_dope("0001");
  tree.put_table("epos", 48);
  tree.put("consensus-driven-uncertainty/lmo_epos.csv", "another data set");
  const auto found = find_recordings(tree.path());
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[1], (Recording{tree.path(), "epos", "all", "0048", {"2", "14"}}));
  const SlamJob job = read_recording(found[1]);
  EXPECT_EQ(job.sequence.odometry.size(), testing::kTreeFrames);
  ASSERT_EQ(job.sequence.objects.size(), 2U);
  for (const ObjectRecording& object : job.sequence.objects) {
    for (std::size_t k = 0; k < testing::kTreeFrames; ++k) {
      ASSERT_EQ(object.detections[k].has_value(), k % 2 == 1);
      ASSERT_EQ(object.relative_truth[k].has_value(), k % 2 == 1);
      if (k % 2 == 0) continue;
      EXPECT_TRUE(object.detections[k]->is_approx(tree.detection(k), 1e-12));
      EXPECT_TRUE(object.relative_truth[k]->is_approx(tree.relative(k), 1e-9));
    }
  }
  tree.remove("slam-super-6d/experiments/ycbv/odom/results/0048.txt");
  EXPECT_TRUE(read_recording(found[1]).sequence.odometry.empty());
}

TEST(Recordings, WhatIsMissingIsLeftOut) {
  RecordingTree tree;
  tree.put_dope("0001");
  const Recording recording = find_recordings(tree.path())[0];
  tree.remove(std::string(kOdom) + "results/0001.txt");
  SlamJob job = read_recording(recording);
  EXPECT_TRUE(job.sequence.odometry.empty());
  EXPECT_EQ(job.settings.motion.model, MotionModel::constant_velocity);
  EXPECT_FALSE(job.sequence.camera_truth.empty());
  tree.remove(std::string(kOdom) + "ground_truth/0001.txt");
  tree.remove("slam-super-6d/experiments/ycbv/inference/" + std::string(testing::kTreeBox) +
              "/ground_truth/0001_ycb_gt.txt");
  job = read_recording(recording);
  EXPECT_TRUE(job.sequence.camera_truth.empty());
  EXPECT_TRUE(job.sequence.objects[0].relative_truth.empty());
  EXPECT_EQ(job.camera_prior.mean().translation(), Eigen::Vector3d::Zero());
}

TEST(Recordings, ObjectsWithoutAProxyHaveNoTruth) {
  RecordingTree tree;
  tree.put_cosypose("0007");
  tree.put("derived/0007_proxy_objects.txt", "4 0 0 1 0 0 0 1\n");
  const SlamJob job = read_recording(find_recordings(tree.path())[0]);
  EXPECT_FALSE(job.sequence.objects[0].world_truth.empty());
  EXPECT_TRUE(job.sequence.objects[1].world_truth.empty());
}

TEST(Recordings, ProfilesAreTheSequenceFilesOfTheProgram) {
  for (const auto& [name, file] : std::vector<std::pair<std::string, std::string>>{
           {"dope", "ycbv-dope"}, {"cosypose", "ycbv-0022"}, {"published", "ycbv-0022-paper"}}) {
    EXPECT_EQ(recording_profile(name),
              read_file(std::string(POSEMIX_SOURCE_DIR "/configs/") + file + ".toml"));
  }
  EXPECT_INVALID(recording_profile("x"), "profile \"x\", expected dope, cosypose or published");
}

TEST(Recordings, FoldersWithoutRecordingsAreRefused) {
  const testing::TemporaryFolder folder;
  EXPECT_INVALID_WITH(find_recordings(folder.path()), "holds no recording");
  EXPECT_INVALID_WITH(find_recordings(folder / "missing"), "is not a folder");
}

TEST(Recordings, DamagedFilesAreNamed) {
  RecordingTree tree;
  tree.put_dope("0001");
  tree.put(std::string(kOdom) + "results/0001.txt", "0.0 1 2 three 0 0 0 1\n");
  EXPECT_INVALID_WITH(read_recording(find_recordings(tree.path())[0]), "results/0001.txt:1");
}

void expect_equal(const SlamJob& job, const SlamJob& other) {
  EXPECT_EQ(job.sequence.stamps, other.sequence.stamps);
  EXPECT_EQ(job.method, other.method);
  EXPECT_EQ(job.camera_prior.covariance(), other.camera_prior.covariance());
  ASSERT_EQ(job.models.size(), other.models.size());
  for (std::size_t i = 0; i < job.models.size(); ++i) {
    EXPECT_EQ(job.models[i].id, other.models[i].id);
    EXPECT_EQ(job.models[i].independent_start, other.models[i].independent_start);
    const auto& objects = job.sequence.objects;
    EXPECT_EQ(objects[i].world_truth.size(), other.sequence.objects[i].world_truth.size());
    EXPECT_EQ(objects[i].detections.back()->translation(),
              other.sequence.objects[i].detections.back()->translation());
  }
}

TEST(Recordings, AreThoseThatTheSequenceFilesDescribe) {
  POSEMIX_REQUIRE_DATA();
  const auto data = *testing::data_dir();
  for (const Recording& recording : find_recordings(data)) {
    if (recording.sequence != "0022") continue;
    for (const char* name : {"ycbv-0022", "ycbv-0022-paper"}) {
      const auto profile =
          TomlDocument::load(std::string(POSEMIX_SOURCE_DIR "/configs/") + name + ".toml");
      const auto own = recording_document(
          recording,
          recording_profile(std::string(name) == "ycbv-0022" ? "cosypose" : "published"));
      expect_equal(read_slam_job(own, {data}), read_slam_job(profile, {data}));
    }
  }
}

}  // namespace
}  // namespace posemix
