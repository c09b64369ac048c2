// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/fiducial/fiducials.hpp"

#include <filesystem>
#include <limits>

#include <nanobind/stl/array.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/set.h>

#include "array_like.hpp"
#include "posemix/fiducial/fiducial_folder.hpp"
#include "record.hpp"
#include "settings.hpp"
#include "words.hpp"

namespace posemix::python {
namespace {

using Corners = Eigen::Matrix<double, 4, 2>;

/// Four corners as an array.
struct CornersAsArray {
  using Matrix = SettingValue<Corners>;
  static Corners matrix_of(const TagCorners& corners) {
    Corners matrix;
    for (std::size_t i = 0; i < corners.size(); ++i)
      matrix.row(static_cast<Eigen::Index>(i)) = corners[i].transpose();
    return matrix;
  }
  static nb::object get(const TagCorners& corners) { return Matrix::get(matrix_of(corners)); }
  static TagCorners set(nb::handle value, const std::string& name) {
    const Corners matrix = Matrix::set(value, name);
    TagCorners corners;
    for (std::size_t i = 0; i < corners.size(); ++i)
      corners[i] = matrix.row(static_cast<Eigen::Index>(i)).transpose();
    return corners;
  }
  static bool same(const TagCorners& a, const TagCorners& b) { return a == b; }
  static std::string text(const TagCorners& corners) { return Matrix::text(matrix_of(corners)); }
};

void bind_camera(nb::module_& m) {
  Words<DistortionModel>(m, "DistortionModel", "The way a lens bends the image of a pinhole.")
      .value(DistortionModel::none, "Not at all.")
      .value(DistortionModel::radtan,
             "Radially and tangentially: k1 k2 p1 p2 [k3] of OpenCV, kalibr and ROS (plumb_bob).")
      .value(DistortionModel::equidistant,
             "By the angle to the optical axis: k1 k2 k3 k4 of OpenCV's fisheye.");
  using C = CameraModel;
  Record<C>(m, "CameraModel", "A calibrated camera: x right, y down, z forward.")
      .field("intrinsics", &C::intrinsics, "numpy.typing.ArrayLike",
             "Shape (4,): fx, fy, cx, cy [px].")
      .field("distortion", &C::distortion, "DistortionModel", "The model of the distortion.")
      .field<NumbersAsArray>("coefficients", &C::coefficients, "numpy.typing.ArrayLike",
                             "Coefficients of the distortion: none, 4 or 5 (radtan), 4.")
      .constructible(1, [](const C& camera) { validate(camera); })
      .done()
      .def(
          "project",
          [](const C& self, const ArrayLike& points) {
            const ShapedRows rows(points, 3, "points");
            Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::RowMajor> pixels(rows.rows.shape(0), 2);
            for (Eigen::Index i = 0; i < pixels.rows(); ++i) {
              const auto image =
                  project(self, Eigen::Map<const Eigen::Vector3d>(rows.rows.data() + 3 * i));
              pixels.row(i).setConstant(std::numeric_limits<double>::quiet_NaN());
              if (image) pixels.row(i) = image->pixel.transpose();
            }
            return pixels;
          },
          "points"_a,
          "Distorted pixels, shape (n, 2), of points in the camera's frame, shape (n, 3) [m]; NaN "
          "for points without an image.")
      .def(
          "rays",
          [](const C& self, const ArrayLike& pixels) {
            const ShapedRows rows(pixels, 2, "pixels");
            Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor> rays(rows.rows.shape(0), 3);
            for (Eigen::Index i = 0; i < rays.rows(); ++i) {
              const auto seen =
                  ray(self, Eigen::Map<const Eigen::Vector2d>(rows.rows.data() + 2 * i));
              rays.row(i).setConstant(std::numeric_limits<double>::quiet_NaN());
              if (seen) rays.row(i) = seen->transpose();
            }
            return rays;
          },
          "pixels"_a,
          "Unit vectors, shape (n, 3), towards what is seen at distorted pixels, shape (n, 2); NaN "
          "beyond the reach of the distortion.");
}

void bind_noise_of_corners(nb::module_& m) {
  using N = CornerNoise;
  Record<N>(m, "CornerNoise",
            "The noise of the coordinates of corners: Student's t, with one variance for the four "
            "corners of a sighting.")
      .field("sd_px", &N::sd_px, "float", "Scale of one coordinate [px].")
      .field("dof", &N::dof, "float", "Degrees of freedom; infinite: normal.")
      .constructible(1)
      .done();
  using F = CornerNoiseFit;
  Record<F>(m, "CornerNoiseFit", "The noise of corners that was learned from sightings.")
      .field("noise", &F::noise, "CornerNoise", "The noise of the greatest likelihood.")
      .field("sightings", &F::sightings, "int", "Number of sightings with a pose.")
      .field("converged", &F::converged, "bool", "Whether the iteration came to rest.")
      .done();
  using M = TagMinimum;
  Record<M>(m, "TagMinimum", "A local minimum of the reprojection error of a tag.")
      .field("pose", &M::pose, "posemix.lie.SE3", "T_camera_tag.")
      .field("squared_error", &M::squared_error, "float",
             "Sum over both coordinates of the four corners [px^2].")
      .field("information", &M::information, kFloatArray,
             "Shape (6, 6): J^T J of the coordinates with respect to n of T_camera_tag Exp(n).")
      .done();
}

void bind_files_of_fiducials(nb::module_& m) {
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
  using T = TagMap;
  Record<T>(m, "TagMap", "Knowledge of the tags before they are seen.")
      .field("size_m", &T::size_m, "dict[int, float]", "Edge by id [m].")
      .field("default_size_m", &T::default_size_m, "float | None",
             "Edge of the other tags [m]; None where it is unknown.")
      .field("ignored", &T::ignored, "set[int]", "Ids of tags to ignore.")
      .field("priors", &T::priors, "dict[int, StatedPose]",
             "T_map_tag by id, of tags on static bodies whose poses are stated with their noise.")
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
  m.def(
      "read_cameras",
      [](const std::filesystem::path& path,
         const std::optional<std::filesystem::path>& camera_poses) {
        std::vector<RigCamera> cameras = read_cameras(path);
        if (camera_poses) read_camera_poses(*camera_poses, cameras);
        return cameras;
      },
      "path"_a, "camera_poses"_a = nb::none(),
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
)");
  m.def(
      "read_tag_map", [](const std::filesystem::path& path) { return read_tag_map(path); },
      "path"_a, R"(Reads sizes, ignored ids and known poses of tags from TagSLAM's tagslam.yaml.

Raises
------
ValueError
    With file, line and key.
)");
  m.def(
      "read_corners", [](const std::filesystem::path& path) { return read_corners(path); },
      "path"_a,
      R"(Reads corners, CSV ``stamp_s,topic,tag,u0_px,v0_px,...,u3_px,v3_px``, compressed by gzip or not.

Raises
------
ValueError
    With file and line.
)");
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
      .field("detector", &F::detector, "str", "Name of the detector in the observations.")
      .done();
}

/// The rows of components: weights, poses and covariances.
nb::tuple arrays_of(const std::vector<ObservationComponent>& components) {
  NewArray weights({components.size()});
  NewArray covariances({components.size(), 6, 6});
  std::vector<SE3d> poses;
  for (std::size_t k = 0; k < components.size(); ++k) {
    weights.data[k] = components[k].weight;
    poses.push_back(components[k].pose);
    Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(covariances.data + 36 * k) =
        components[k].covariance.value_or(Matrix6d::Zero());
  }
  return nb::make_tuple(std::move(weights.array), PoseArray::of(poses),
                        std::move(covariances.array));
}

nb::tuple table_of(const Fiducials& fiducials) {
  std::vector<ObservationComponent> components;
  std::vector<std::size_t> sighting;
  for (std::size_t i = 0; i < fiducials.observations.size(); ++i) {
    for (const ObservationComponent& component : fiducials.observations[i].components) {
      components.push_back(component);
      sighting.push_back(i);
    }
  }
  nb::list stamps;
  nb::list cameras;
  nb::list tags;
  for (const Observation& observation : fiducials.observations) {
    stamps.append(observation.stamp_s);
    cameras.append(nb::str(observation.camera.c_str()));
    tags.append(std::stoll(observation.object));
  }
  return nb::make_tuple(stamps, cameras, tags, nb::cast(sighting), arrays_of(components),
                        nb::cast(fiducials.noise), fiducials.sightings, fiducials.ignored,
                        fiducials.without_size, fiducials.without_pose);
}

void bind_functions(nb::module_& m) {
  m.def(
      "tag_minima",
      [](const ArrayLike& corners, double size, const CameraModel& camera, CornerOrder order) {
        return tag_minima(in_apriltag_order(CornersAsArray::set(corners, "corners"), order), size,
                          camera);
      },
      "corners"_a, "size"_a, "camera"_a, "order"_a = CornerOrder::apriltag,
      R"(The local minima of the reprojection error of a square tag in distorted pixels, sorted by their error.

There are two for most views, one where the tag is near and turned towards the camera, none where the corners are no
image of the front of a square.

Parameters
----------
corners : array_like, shape (4, 2)
    Distorted pixels.
size : float
    Edge of the tag [m].
camera : CameraModel
    Intrinsics and distortion.
order : CornerOrder
    Order of the corners.

Raises
------
ValueError
    For corners that are not finite and a size that is not positive.
)");
  m.def(
      "fit_corner_noise",
      [](const std::vector<std::vector<TagMinimum>>& sightings) {
        const nb::gil_scoped_release unlocked;
        return fit_corner_noise(sightings);
      },
      "sightings"_a,
      R"(The noise that makes the corners of sightings most likely, by expectation maximisation.

Parameters
----------
sightings : sequence of sequence of TagMinimum
    The minima of each sighting, from `tag_minima`; which one is true need not be known.

Raises
------
ValueError
    If no sighting has a minimum.
)");
  m.def(
      "tag_components",
      [](const std::vector<TagMinimum>& minima, const CornerNoise& noise, double least_weight) {
        return arrays_of(tag_components(minima, noise, least_weight));
      },
      "minima"_a, "noise"_a, "least_weight"_a,
      "Weights, poses and covariances of the posterior of a tag's pose.");
  m.def(
      "observe_fiducials",
      [](const std::vector<CornerSighting>& sightings, const std::vector<RigCamera>& cameras,
         const TagMap& tags, const FiducialSettings& settings) {
        return table_of(observe_fiducials(sightings, cameras, tags, settings));
      },
      "sightings"_a, "cameras"_a, "tags"_a, "settings"_a,
      "The columns of the observations, and what became of the sightings.");
  m.def(
      "write_fiducials",
      [](const std::filesystem::path& path, const std::vector<CornerSighting>& sightings,
         const std::vector<RigCamera>& cameras, const TagMap& tags,
         const std::optional<FiducialSettings>& settings, bool compress) {
        FiducialFolder folder{.cameras = cameras, .tags = tags, .compress = compress};
        folder.fiducials =
            observe_fiducials(sightings, cameras, tags, settings.value_or(FiducialSettings{}));
        write_fiducial_folder(folder, path);
      },
      "path"_a, "sightings"_a, "cameras"_a, "tags"_a, "settings"_a = nb::none(),
      "compress"_a = false,
      R"(Writes the observations of a recording into a folder, as ``posemix fiducials`` does.

Parameters
----------
path : path
    The folder, which appears as a whole.
sightings : sequence of CornerSighting
    Corners of the tags.
cameras : sequence of RigCamera
    Cameras, which the sightings name by topic or name.
tags : TagMap
    Sizes and known poses of the tags.
settings : FiducialSettings, optional
    Order of the corners, noise.
compress : bool
    Whether the table of observations is compressed by gzip.

Raises
------
ValueError
    For a sighting of an unknown camera.
OSError
    If the system refuses.
)");
}

}  // namespace

void bind_fiducials(nb::module_& m) {
  bind_camera(m);
  bind_noise_of_corners(m);
  bind_files_of_fiducials(m);
  bind_settings(m);
  bind_functions(m);
}

}  // namespace posemix::python
