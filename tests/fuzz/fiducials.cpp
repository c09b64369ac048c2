// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "invariants.hpp"
#include "posemix/fiducial/camera_file.hpp"
#include "posemix/fiducial/corner_file.hpp"
#include "posemix/fiducial/tag_file.hpp"
#include "target.hpp"

/// Files of fiducials, by the first letter: corners, cameras, poses of cameras, tags. The
/// components of a tag are valid.
namespace posemix::fuzzing {
namespace {

void read_corners_of(std::string_view text) {
  static const CameraModel camera{.intrinsics = {600.0, 602.0, 640.0, 512.0},
                                  .distortion = DistortionModel::equidistant,
                                  .coefficients = {-0.013, -0.0099, 0.0121, -0.0045}};
  takes("f", [&] {
    for (const CornerSighting& sighting : parse_corners(text, "f")) {
      Observation observation;
      observation.components =
          tag_components(tag_minima(sighting.corners, 0.15, camera), {.sd_px = 0.3, .dof = 3.0});
      if (!observation.components.empty()) validate(observation);
    }
  });
}

}  // namespace

POSEMIX_FUZZ_TARGET(fiducials) {
  const Choice choice(bytes);
  switch (choice.letter) {
#ifdef POSEMIX_WITH_YAML
    case 'c':
      takes("f", [&, text = choice.rest] {
        for (const RigCamera& camera : parse_cameras(text, "f")) validate(camera.model);
      });
      return;
    case 'p':
      takes("f", [&, text = choice.rest] {
        std::vector<RigCamera> cameras(2);
        cameras[0].name = "cam0";
        cameras[1].name = "cam1";
        parse_camera_poses(text, "f", cameras);
      });
      return;
    case 't':
      takes("f", [&, text = choice.rest] { parse_tag_map(text, "f"); });
      return;
#endif
    default:
      return read_corners_of(choice.rest);
  }
}

}  // namespace posemix::fuzzing
