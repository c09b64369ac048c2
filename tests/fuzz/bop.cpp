// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/io/bop.hpp"
#include "invariants.hpp"
#include "posemix/io/bop_models.hpp"
#include "posemix/io/bop_views.hpp"
#include "posemix/io/dataset.hpp"
#include "target.hpp"

/// Files of the BOP benchmark: results, models, annotations, cameras and groups of images.
namespace posemix::fuzzing {
namespace {

void read_results(std::string_view text) {
  takes("f.csv", [&] {
    const std::vector<BopRow> rows = parse_bop_rows(text, "f.csv");
    for (const BopRow& row : rows) expect_pose(row.pose);
    expect(parse_bop_rows(format_bop_rows(rows), "again").size() == rows.size(),
           "another number of rows after writing");
    for (const BopRowUse use : {BopRowUse::mixtures, BopRowUse::rows, BopRowUse::best})
      for (const Observation& observation : bop_observations(rows, {.use = use}))
        validate(observation);
  });
  takes("f.csv", [&] {
    for (const auto& [image, poses] : parse_bop(text, "f.csv", {2, 5}))
      for (const ScoredPose& each : poses) expect_pose(each.pose);
  });
}

void read_models(std::string_view text) {
  takes("f.json", [&] {
    for (const auto& [id, model] : parse_bop_models(text, "f.json")) {
      expect(std::isfinite(model.diameter_m), "a diameter that is not finite");
      expect(!model.symmetries.elements().empty(), "a group without the identity");
      if (model.box) expect(model.box->corners().back().allFinite(), "a box that is not finite");
    }
  });
  takes("f.json", [&] { parse_bop_model(text, "f.json", 5); });
}

void read_annotations(std::string_view text) {
  takes("s", [&] {
    const DatasetScene scene{"s", {}, parse_bop_scene_gt(text, "s.json")};
    for (const auto& [object, count] : scene.instance_counts())
      for (const auto& [image, pose] : scene.poses_of(object, count - 1)) expect_pose(pose);
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
      takes("c.json", [&] {
        for (const auto& [image, pose] : parse_bop_scene_camera(choice.rest, "c.json"))
          if (pose) expect_pose(*pose);
      });
      return;
    case 's':
      takes("s.json", [&] {
        for (const auto& [image, pose] : parse_scene_cameras(choice.rest, "s.json"))
          expect_pose(pose);
      });
      return;
    case 'g':
      takes("g.json", [&] {
        for (const ImageGroup& group : parse_image_groups(choice.rest, "g.json"))
          expect(!group.images.empty(), "a group without images");
      });
      return;
    default:
      return read_results(choice.rest);
  }
}

}  // namespace posemix::fuzzing
