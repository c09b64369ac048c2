// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <stdexcept>

#include <gtest/gtest.h>

#include "posemix/io/dataset.hpp"
#include "posemix/testing/mutate.hpp"
#include "small_dataset.hpp"

/// Damaged files of dataset folders.
namespace posemix {
namespace {

using testing::BopTexts;
using testing::fuzz;
using testing::FuzzReport;

constexpr std::size_t kInputs = 10000;
constexpr std::size_t kMatInputs = 1500;

void expect_sound_datasets(const FuzzReport& report, std::size_t least_of_each) {
  EXPECT_TRUE(report.failures.empty())
      << report.failures.size() << " failures, the first: " << report.failures[0];
  EXPECT_GT(report.accepted, least_of_each);
  EXPECT_GT(report.rejected, least_of_each);
}

void require_finite(const SE3d& pose) {
  if (!pose.log().allFinite()) throw std::logic_error("a pose that is not finite");
}

TEST(DamagedDataset, BopSceneFiles) {
  const BopTexts texts(testing::SmallRecording(), 2);
  const std::vector<std::string> truth{texts.truth};
  expect_sound_datasets(fuzz(truth, kInputs, 31,
                             [](const std::string& text) {
                               DatasetScene scene{"s", {}, parse_bop_scene_gt(text, "gt.json")};
                               for (const auto& [object, count] : scene.instance_counts())
                                 for (const auto& [image, pose] : scene.poses_of(object, count - 1))
                                   require_finite(pose);
                             }),
                        100);
  const std::vector<std::string> camera{texts.camera};
  expect_sound_datasets(
      fuzz(camera, kInputs, 32,
           [](const std::string& text) {
             for (const auto& [image, pose] : parse_bop_scene_camera(text, "c.json"))
               if (pose) require_finite(*pose);
           }),
      100);
}

TEST(DamagedDataset, MetaOfYcbVideo) {
  const testing::TemporaryFolder folder;
  const testing::SmallRecording recording;
  const std::string name = "data/0000/000001-meta.mat";
  std::vector<std::string> originals;
  for (const bool compressed : {true, false}) {
    testing::write_mat(folder / name, testing::meta_of(recording, 0), compressed);
    originals.push_back(testing::content_of(folder / name));
  }
  expect_sound_datasets(fuzz(originals, kMatInputs, 33,
                             [&](const std::string& bytes) {
                               folder.put(name, bytes);
                               const DatasetScene scene =
                                   read_ycb_video_scene(folder.path(), "0000");
                               for (const DatasetInstance& instance : scene.images.at(1))
                                 require_finite(instance.camera_object);
                               if (scene.cameras.at(1)) require_finite(*scene.cameras.at(1));
                             }),
                        20);
}

}  // namespace
}  // namespace posemix
