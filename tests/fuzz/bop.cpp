// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/io/bop.hpp"
#include "files.hpp"
#include "invariants.hpp"
#include "io/temporary_folder.hpp"
#include "posemix/io/bop_models.hpp"
#include "posemix/io/bop_views.hpp"
#include "posemix/io/dataset.hpp"
#include "target.hpp"

/// Files of the BOP benchmark: results, models, annotations, cameras and groups of images. What is
/// taken is taken from a file, too.
namespace posemix::fuzzing {
namespace {

using posemix::testing::TemporaryFolder;

void expect_same_size(const auto& from_file, const auto& from_text) {
  expect(from_file.size() == from_text.size(), "another number of entries in the file");
}

void read_results(std::string_view text) {
  takes("f.csv", [&] {
    const std::vector<BopRow> rows = parse_bop_rows(text, "f.csv");
    for (const BopRow& row : rows) expect_pose(row.pose);
    expect_same_size(read_bop_rows(file_of(text)), rows);
    expect(parse_bop_rows(format_bop_rows(rows), "again").size() == rows.size(),
           "another number of rows after writing");
    for (const BopRowUse use : {BopRowUse::mixtures, BopRowUse::rows, BopRowUse::best})
      for (const Observation& observation : bop_observations(rows, {.use = use}))
        validate(observation);
  });
  takes("f.csv", [&] {
    const BopDetections detections = parse_bop(text, "f.csv", {2, 5});
    for (const auto& [image, poses] : detections)
      for (const ScoredPose& each : poses) expect_pose(each.pose);
    expect_same_size(read_bop(file_of(text), {2, 5}), detections);
  });
}

void read_models(std::string_view text) {
  takes("f.json", [&] {
    const BopModels models = parse_bop_models(text, "f.json");
    expect_same_size(read_bop_models(file_of(text)), models);
    for (const auto& [id, model] : models) {
      expect(std::isfinite(model.diameter_m), "a diameter that is not finite");
      expect(!model.symmetries.elements().empty(), "a group without the identity");
      if (model.box) expect(model.box->corners().back().allFinite(), "a box that is not finite");
    }
  });
  takes("f.json", [&] {
    const BopModel model = parse_bop_model(text, "f.json", 5);
    expect(read_bop_model(file_of(text), 5).diameter_m == model.diameter_m,
           "another model in the file");
  });
}

void read_annotations(std::string_view text) {
  takes("s", [&] {
    const DatasetScene scene{"s", {}, parse_bop_scene_gt(text, "s.json")};
    for (const auto& [object, count] : scene.instance_counts())
      for (const auto& [image, pose] : scene.poses_of(object, count - 1)) expect_pose(pose);
    static const TemporaryFolder folder;
    folder.put(bop_scene_folder("", "test", 1) / "scene_gt.json", text);
    expect_same_size(read_bop_scene(folder.path(), "test", 1).images, scene.images);
  });
}

void read_cameras_of_scene(std::string_view text) {
  takes("c.json", [&] {
    const DatasetCameras cameras = parse_bop_scene_camera(text, "c.json");
    for (const auto& [image, pose] : cameras)
      if (pose) expect_pose(*pose);
    static const TemporaryFolder folder;
    folder.put(bop_scene_folder("", "test", 1) / "scene_camera.json", text);
    expect_same_size(read_bop_scene(folder.path(), "test", 1).cameras, cameras);
  });
}

void read_camera_table(std::string_view text) {
  takes("s.json", [&] {
    const SceneCameras cameras = parse_scene_cameras(text, "s.json");
    for (const auto& [image, pose] : cameras) expect_pose(pose);
    expect_same_size(read_scene_cameras(file_of(text)), cameras);
  });
}

void read_groups(std::string_view text) {
  takes("g.json", [&] {
    const std::vector<ImageGroup> groups = parse_image_groups(text, "g.json");
    for (const ImageGroup& group : groups) expect(!group.images.empty(), "a group without images");
    expect(read_image_groups(file_of(text)) == groups, "other groups in the file");
  });
}

}  // namespace

POSEMIX_FUZZ_TARGET(bop) {
  const Choice choice(bytes);
  switch (choice.letter) {
    case 'm':
      return read_models(choice.rest);
    case 'a':
      return read_annotations(choice.rest);
    case 'c':
      return read_cameras_of_scene(choice.rest);
    case 's':
      return read_camera_table(choice.rest);
    case 'g':
      return read_groups(choice.rest);
    default:
      return read_results(choice.rest);
  }
}

}  // namespace posemix::fuzzing
