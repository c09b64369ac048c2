// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "files.hpp"
#include "invariants.hpp"
#include "posemix/fiducial/camera_file.hpp"
#include "posemix/fiducial/corner_file.hpp"
#include "posemix/fiducial/tag_file.hpp"
#include "target.hpp"

/// Files of fiducials, by the first letter: corners, cameras, poses of cameras, tags. The
/// components of a tag are valid. What is taken is taken from a file, too.
namespace posemix::fuzzing {
namespace {

void read_corners_of(std::string_view text) {
  static const CameraModel camera{.intrinsics = {600.0, 602.0, 640.0, 512.0},
                                  .distortion = DistortionModel::equidistant,
                                  .coefficients = {-0.013, -0.0099, 0.0121, -0.0045}};
  takes("f", [&] {
    const std::vector<CornerSighting> sightings = parse_corners(text, "f");
    expect(read_corners(file_of(text)).size() == sightings.size(), "other corners in the file");
    for (const CornerSighting& sighting : sightings) {
      Observation observation;
      observation.components =
          tag_components(tag_minima(sighting.corners, 0.15, camera), {.sd_px = 0.3, .dof = 3.0});
      if (!observation.components.empty()) validate(observation);
    }
  });
}

#ifdef POSEMIX_WITH_YAML

void expect_stated(const StatedPose& stated) {
  expect_pose(stated.pose);
  if (stated.covariance) expect(stated.covariance->allFinite(), "a covariance that is not finite");
}

void read_rig(std::string_view text) {
  takes("f", [&] {
    const std::vector<RigCamera> cameras = parse_cameras(text, "f");
    for (const RigCamera& camera : cameras) validate(camera.model);
    expect(read_cameras(file_of(text)).size() == cameras.size(), "other cameras in the file");
  });
}

void read_rig_poses(std::string_view text) {
  takes("f", [&] {
    std::vector<RigCamera> cameras(2);
    cameras[0].name = "cam0";
    cameras[1].name = "cam1";
    parse_camera_poses(text, "f", cameras);
    for (const RigCamera& camera : cameras)
      if (camera.rig_camera) expect_stated(*camera.rig_camera);
    read_camera_poses(file_of(text), cameras);
  });
}

void read_tags(std::string_view text) {
  takes("f", [&] {
    const TagMap map = parse_tag_map(text, "f");
    for (const auto& [tag, stated] : map.priors) expect_stated(stated);
    for (const auto& [tag, size] : map.size_m) expect(size > 0.0, "a tag without an edge");
    for (const TagRemap& remap : map.remaps) map.tag_at(remap.id, remap.from_s);
    expect(read_tag_map(file_of(text)).size_m == map.size_m, "other tags in the file");
  });
}

#endif

}  // namespace

POSEMIX_FUZZ_TARGET(fiducials) {
  const Choice choice(bytes);
  switch (choice.letter) {
#ifdef POSEMIX_WITH_YAML
    case 'c':
      return read_rig(choice.rest);
    case 'p':
      return read_rig_poses(choice.rest);
    case 't':
      return read_tags(choice.rest);
#endif
    default:
      return read_corners_of(choice.rest);
  }
}

}  // namespace posemix::fuzzing
