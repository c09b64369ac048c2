// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "study/tless/scene.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "posemix/base/units.hpp"
#include "posemix/slam/symmetric_error.hpp"
#include "posemix/testing/data.hpp"
#include "posemix/testing/expect.hpp"

namespace posemix {
namespace {

SE3d camera(std::int64_t image) {
  const auto t = static_cast<double>(image);
  return SE3d(SO3d::exp({0.02 * t, -0.05 * t, 0.01 * t}), {0.03 * t, 0.01 * t, -0.02 * t});
}

/// Two objects of class 1 and one of class 2: class and pose in the world.
const std::vector<std::pair<std::int64_t, SE3d>>& things() {
  static const std::vector<std::pair<std::int64_t, SE3d>> things{
      {1, SE3d(SO3d::exp({0.1, 0.2, 0.3}), {0.0, 0.0, 0.7})},
      {1, SE3d(SO3d::exp({0.1, 0.2, 1.3}), {0.1, 0.0, 0.7})},
      {2, SE3d(SO3d::exp({-0.4, 0.0, 0.0}), {0.0, 0.2, 0.8})}};
  return things;
}

BopRow row(std::int64_t image, std::size_t thing, double score = 1.0) {
  const auto& [object, world] = things()[thing];
  return {3, image, object, score, camera(image).inverse() * world};
}

TEST(Tless, InstancesAreKnownByTheirPlace) {
  // The file's order of instances changes, and one of them comes late.
  const std::vector<BopRow> truth{row(0, 0), row(0, 2), row(4, 2), row(4, 1),
                                  row(4, 0), row(9, 1), row(9, 2), {5, 0, 1, 1.0, {}}};
  const std::vector<BopRow> seen{row(4, 1, 0.9), row(4, 0, 0.2), row(9, 2, 0.8)};
  const TlessScene scene = tless_scene(3, truth, seen, 0.5);
  EXPECT_EQ(scene.images, (std::vector<std::int64_t>{0, 4, 9}));
  EXPECT_EQ(scene.sequence.stamps, (std::vector<double>{0.0, 0.4, 0.9}));
  ASSERT_EQ(scene.sequence.objects.size(), 3U);
  EXPECT_EQ(scene.classes, (std::vector<std::string>{"1", "1", "2"}));
  const std::vector<std::string> ids{"1.0", "1.1", "2"};
  for (std::size_t i = 0; i < 3; ++i) {
    const ObjectRecording& object = scene.sequence.objects[i];
    EXPECT_EQ(object.id, ids[i]);
    for (std::size_t k = 0; k < 3; ++k) {
      const SE3d t_world_camera = camera(scene.images[k]);
      EXPECT_TRUE(scene.sequence.camera_truth[k]->is_approx(t_world_camera, 1e-12));
      EXPECT_TRUE(object.world_truth[k]->is_approx(things()[i].second, 1e-12));
      EXPECT_EQ(object.relative_truth[k].has_value(), !(i == 0 && k == 2) && !(i == 1 && k == 0));
      EXPECT_FALSE(object.detections[k].has_value());
    }
  }
  ASSERT_EQ(scene.candidates.size(), 3U);
  EXPECT_TRUE(scene.candidates[0].empty());
  ASSERT_EQ(scene.candidates[1].size(), 1U);
  EXPECT_EQ(scene.candidates[1][0].class_id, "1");
  EXPECT_EQ(scene.candidates[1][0].score, 0.9);
  EXPECT_EQ(scene.candidates[2].size(), 1U);
}

TEST(Tless, ImagesThatCouldBeAnywhereWait) {
  // Image 2 shows one object of class 1, and nothing determines which. Image 5 determines image 1.
  const std::vector<BopRow> truth{row(0, 0), row(0, 1), row(2, 0), row(1, 2),
                                  row(5, 0), row(5, 1), row(5, 2)};
  const TlessScene scene = tless_scene(3, truth, {}, 0.5);
  EXPECT_EQ(scene.images, (std::vector<std::int64_t>{0, 1, 2, 5}));
  EXPECT_TRUE(scene.sequence.camera_truth[1]->is_approx(camera(1), 1e-12));
  EXPECT_FALSE(scene.sequence.camera_truth[2].has_value());
  EXPECT_TRUE(scene.sequence.camera_truth[3]->is_approx(camera(5), 1e-12));
  for (const ObjectRecording& object : scene.sequence.objects)
    EXPECT_FALSE(object.relative_truth[2].has_value());
}

TEST(Tless, RefusesWhatIsNotThere) {
  EXPECT_NE(testing::thrown_message([] {
              tless_scene(4, std::vector{row(0, 0)}, {}, 0.5);
            }).find("scene 4"),
            std::string::npos);
  EXPECT_NE(testing::thrown_message([] { read_tless("/nowhere"); }).find("bop_toolkit"),
            std::string::npos);
}

TEST(Tless, SymmetriesOfTheLibraryAreGroups) {
  const SymmetryGroups groups = tless_symmetries();
  EXPECT_EQ(groups.at(1).elements().size(), 6U);
  EXPECT_EQ(groups.at(4).axes().size(), 1U);
  EXPECT_EQ(groups.at(23).elements().size(), 2U);
  EXPECT_EQ(groups.count(3), 0U);
}

// Instances per class of the scenes: the largest number in one image, counted in the file.
TEST(Tless, RecordedScenes) {
  POSEMIX_REQUIRE_DATA();
  if (!std::filesystem::is_directory(*testing::data_dir() / "bop_toolkit")) GTEST_SKIP();
  const std::vector<TlessScene> scenes = read_tless(*testing::data_dir());
  const auto truth_of = [&](const TlessScene& scene) {
    std::map<std::string, std::size_t> most;
    for (std::size_t k = 0; k < scene.images.size(); ++k) {
      std::map<std::string, std::size_t> count;
      for (std::size_t i = 0; i < scene.classes.size(); ++i) {
        if (scene.sequence.objects[i].relative_truth[k]) ++count[scene.classes[i]];
      }
      for (const auto& [name, number] : count) most[name] = std::max(most[name], number);
    }
    return most;
  };
  ASSERT_FALSE(scenes.empty());
  for (const TlessScene& scene : scenes) {
    SCOPED_TRACE(scene.scene);
    EXPECT_EQ(scene.images.size(), 50U);
    std::map<std::string, std::size_t> instances;
    for (const std::string& name : scene.classes) ++instances[name];
    EXPECT_EQ(instances, truth_of(scene));
    for (std::size_t k = 0; k < scene.images.size(); ++k) {
      ASSERT_TRUE(scene.sequence.camera_truth[k].has_value());
      for (const ObjectRecording& object : scene.sequence.objects) {
        if (!object.relative_truth[k]) continue;
        const SE3d world = *scene.sequence.camera_truth[k] * *object.relative_truth[k];
        // README of the data: constant to 0.000 deg and 0.00 mm.
        EXPECT_TRUE(world.is_approx(*object.world_truth[k], 1e-5));
      }
    }
  }
}

/// Detections against the nearest true instance of their class: with the symmetries, most of
/// the apparent turns vanish.
TEST(Tless, SymmetriesExplainTheResiduals) {
  POSEMIX_REQUIRE_DATA();
  if (!std::filesystem::is_directory(*testing::data_dir() / "bop_toolkit")) GTEST_SKIP();
  const SymmetryGroups groups = tless_symmetries();
  std::size_t all = 0;
  std::size_t turned = 0;
  std::size_t left = 0;
  for (const TlessScene& scene : read_tless(*testing::data_dir())) {
    for (std::size_t k = 0; k < scene.images.size(); ++k) {
      for (const Candidate& candidate : scene.candidates[k]) {
        const SE3d* nearest = nullptr;
        double least = 0.03;
        for (std::size_t i = 0; i < scene.classes.size(); ++i) {
          const auto& truth = scene.sequence.objects[i].relative_truth[k];
          if (!truth || scene.classes[i] != candidate.class_id) continue;
          const double distance =
              (truth->translation() - candidate.camera_object.translation()).norm();
          if (distance >= least) continue;
          least = distance;
          nearest = &*truth;
        }
        const auto group = groups.find(std::stoll(candidate.class_id));
        if (nearest == nullptr || group == groups.end()) continue;
        const SE3d& pose = candidate.camera_object;
        ++all;
        if (symmetric_pose_error(pose, *nearest, {}).rotation_rad > radians(20.0)) ++turned;
        if (symmetric_pose_error(pose, *nearest, group->second).rotation_rad > radians(20.0))
          ++left;
      }
    }
  }
  RecordProperty("all", static_cast<int>(all));
  RecordProperty("turned", static_cast<int>(turned));
  RecordProperty("left", static_cast<int>(left));
  EXPECT_GT(all, 800U);
  EXPECT_GT(turned, all / 3);
  EXPECT_LT(left, turned / 5);
}

}  // namespace
}  // namespace posemix
