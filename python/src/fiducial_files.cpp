// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <filesystem>

#include <nanobind/stl/array.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/set.h>

#include "fiducials.hpp"
#include "posemix/fiducial/fiducials.hpp"
#include "record.hpp"
#include "settings.hpp"
#include "words.hpp"

namespace posemix::python {
namespace {

constexpr const char* kCamerasDoc =
    R"(Reads the cameras of a YAML file as TagSLAM (cameras.yaml) and kalibr (camchain.yaml) write it.

Parameters
----------
path : path
    Intrinsics and distortion.
camera_poses : path, optional
    The poses on the rig as TagSLAM writes them (camera_poses.yaml).

Raises
------
ValueError
    With file, line and key.
)";

constexpr const char* kTagsDoc =
    R"(Reads sizes, ignored ids and known poses of tags from TagSLAM's tagslam.yaml.

Raises
------
ValueError
    With file, line and key.
)";

constexpr const char* kCornersDoc =
    R"(Reads corners, CSV ``stamp_s,topic,tag,u0_px,v0_px,...,u3_px,v3_px``, compressed by gzip or not.

Raises
------
ValueError
    With file and line.
)";

void bind_cameras(nb::module_& m) {
  using P = StatedPose;
  Record<P>(m, "StatedPose", "A pose as a file states it, with or without an uncertainty.")
      .field("pose", &P::pose, "posemix.lie.SE3", "T_a_b.")
      .field("covariance", &P::covariance, "numpy.typing.NDArray[numpy.float64] | None",
             "Shape (6, 6): covariance of n of T_a_b Exp(n) [rad, m]; None where it is not stated.")
      .constructible(1)
      .done();
  using R = RigCamera;
  Record<R>(m, "RigCamera", "A camera of a rig.")
      .field("name", &R::name, "str", "Name.")
      .field("model", &R::model, "CameraModel", "Intrinsics and distortion.")
      .field("resolution", &R::resolution, "collections.abc.Sequence[int] | None",
             "Width and height [px]; None where they are not stated.")
      .field("topics", &R::topics, "collections.abc.Sequence[str]",
             "Topics of its images and its corners.")
      .field("rig_camera", &R::rig_camera, "StatedPose | None",
             "T_rig_camera; None where it is not stated.")
      .constructible(2)
      .done();
}

void bind_tags(nb::module_& m) {
  using T = TagMap;
  Record<T>(m, "TagMap", "Knowledge of the tags before they are seen.")
      .field("size_m", &T::size_m, "collections.abc.Mapping[int, float]", "Edge by id [m].")
      .field("default_size_m", &T::default_size_m, "float | None",
             "Edge of the other tags [m]; None where it is unknown.")
      .field("ignored", &T::ignored, "collections.abc.Set[int]", "Ids of tags to ignore.")
      .field("priors", &T::priors, "collections.abc.Mapping[int, StatedPose]",
             "T_map_tag by id, of tags on static bodies whose poses are stated with their noise.")
      .field("rig_odometry", &T::rig_odometry, "posemix.lie.SE3 | None",
             "T_rig_odom, the frame whose motion the odometry states; None: that of the rig.")
      .constructible(0)
      .done();
  using S = CornerSighting;
  Record<S>(m, "CornerSighting", "The corners of one tag in one image.")
      .field("stamp_s", &S::stamp_s, "float", "Time of the image [s].")
      .field("topic", &S::topic, "str", "Topic of the camera, or its name.")
      .field("tag", &S::tag, "int", "Id of the tag.")
      .field<CornersAsArray>("corners", &S::corners, "numpy.typing.ArrayLike",
                             "Shape (4, 2): distorted pixels in the detector's order.")
      .field("place", &S::place, "str", "File and line for messages; empty without a file.")
      .constructible(4)
      .done();
}

void bind_readers(nb::module_& m) {
  m.def(
      "read_cameras",
      [](const std::filesystem::path& path,
         const std::optional<std::filesystem::path>& camera_poses) {
        std::vector<RigCamera> cameras = read_cameras(path);
        if (camera_poses) read_camera_poses(*camera_poses, cameras);
        return cameras;
      },
      "path"_a, "camera_poses"_a = nb::none(), kCamerasDoc);
  m.def(
      "read_tag_map", [](const std::filesystem::path& path) { return read_tag_map(path); },
      "path"_a, kTagsDoc);
  m.def(
      "read_corners", [](const std::filesystem::path& path) { return read_corners(path); },
      "path"_a, kCornersDoc);
}

void bind_settings(nb::module_& m) {
  Words<CornerOrder>(m, "CornerOrder", "Order in which a detector states the corners of a tag.")
      .value(CornerOrder::apriltag,
             "Bottom left, bottom right, top right, top left: AprilTag and TagSLAM.")
      .value(CornerOrder::aruco,
             "Top left, top right, bottom right, bottom left: OpenCV's ArUco detector.");
  Words<CornerNoiseSource>(m, "CornerNoiseSource", "The origin of the noise of a camera's corners.")
      .value(CornerNoiseSource::own, "Learned from the sightings of the camera.")
      .value(CornerNoiseSource::all, "Learned from those of all cameras.")
      .value(CornerNoiseSource::given, "The noise of the settings.")
      .value(CornerNoiseSource::assumed, "The assumed noise of the settings, for few sightings.");
  using C = CameraCornerNoise;
  Record<C>(m, "CameraCornerNoise", "The noise of one camera's corners.")
      .field("camera", &C::camera, "str", "Name of the camera.")
      .field("noise", &C::noise, "CornerNoise", "The noise.")
      .field("sightings", &C::sightings, "int", "Number of sightings with a pose.")
      .field("source", &C::source, "CornerNoiseSource", "The origin of the noise.")
      .done();
  using F = FiducialSettings;
  Settings<F>(m, "FiducialSettings", "Settings of `observe_fiducials`.")
      .field("order", &F::order, "CornerOrder", "Order of the corners.")
      .field("noise", &F::noise, "CornerNoise | None", "Noise of all cameras; learned where None.")
      .field("least_sightings", &F::least_sightings, "int",
             "Sightings that a camera needs for a noise of its own.")
      .field("assumed", &F::assumed, "CornerNoise", "Noise where all cameras together have fewer.")
      .field("least_weight", &F::least_weight, "float", "Components with less are left out.")
      .field("bearing_sd_px", &F::bearing_sd_px, "float",
             "Standard deviation of an error that all corners of a sighting share [px].")
      .field("detector", &F::detector, "str", "Name of the detector in the observations.")
      .done();
}

}  // namespace

void bind_fiducial_files(nb::module_& m) {
  bind_cameras(m);
  bind_tags(m);
  bind_readers(m);
  bind_settings(m);
}

}  // namespace posemix::python
