// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/fiducial/fiducials.hpp"

#include <filesystem>
#include <limits>

#include <fmt/format.h>
#include <nanobind/stl/filesystem.h>

#include "array_like.hpp"
#include "fiducials.hpp"
#include "posemix/fiducial/fiducial_folder.hpp"
#include "record.hpp"
#include "words.hpp"

namespace posemix::python {
namespace {

void bind_distortion(nb::module_& m) {
  Words<DistortionModel>(m, "DistortionModel", "The way a lens bends the image of a pinhole.")
      .value(DistortionModel::none, "Not at all.")
      .value(DistortionModel::radtan,
             "Radially and tangentially: k1 k2 p1 p2 [k3] of OpenCV, kalibr and ROS (plumb_bob).")
      .value(DistortionModel::equidistant,
             "Along the radius, by the angle to the axis: k1 k2 k3 k4 of OpenCV's fisheye.");
}

void bind_camera(nb::module_& m) {
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
                        fiducials.without_size, fiducials.without_pose,
                        nb::cast(fiducials.warnings));
}

constexpr const char* kMinimaDoc =
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
)";

constexpr const char* kNoiseDoc =
    R"(The noise that makes the corners of sightings most likely, by expectation maximisation.

Parameters
----------
sightings : sequence of sequence of TagMinimum
    The minima of each sighting, from `tag_minima`; which one is true need not be known.

Raises
------
ValueError
    If no sighting has a minimum.
)";

constexpr const char* kWriteDoc =
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

Warns
-----
UserWarning
    Where the noise of the corners, the size of a tag or the order of the corners is hardly true, and
    for a camera whose observations are left out.
)";

void bind_poses(nb::module_& m) {
  m.def(
      "tag_minima",
      [](const ArrayLike& corners, double size, const CameraModel& camera, CornerOrder order) {
        return tag_minima(in_apriltag_order(CornersAsArray::set(corners, "corners"), order), size,
                          camera);
      },
      "corners"_a, "size"_a, "camera"_a, "order"_a = CornerOrder::apriltag, kMinimaDoc);
  m.def(
      "fit_corner_noise",
      [](const std::vector<std::vector<TagMinimum>>& sightings) {
        const nb::gil_scoped_release unlocked;
        return fit_corner_noise(sightings);
      },
      "sightings"_a, kNoiseDoc);
  m.def(
      "tag_components",
      [](const std::vector<TagMinimum>& minima, const CornerNoise& noise, double least_weight,
         const CameraModel& camera, double bearing_sd_px) {
        std::vector<ObservationComponent> components = tag_components(minima, noise, least_weight);
        add_bearing_error(components, angle_of_pixels(camera, bearing_sd_px));
        return arrays_of(components);
      },
      "minima"_a, "noise"_a, "least_weight"_a, "camera"_a, "bearing_sd_px"_a,
      "Weights, poses and covariances of the posterior of a tag's pose.");
}

void bind_recordings(nb::module_& m) {
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
        std::vector<std::string> warnings = folder.fiducials.warnings;
        for (const std::string& camera : complete_rig(folder)) {
          warnings.push_back(fmt::format(
              "camera '{}' has no pose on the rig and sees no tag together with one that "
              "has, so that its observations are left out",
              camera));
        }
        for (const std::string& text : warnings)
          if (PyErr_WarnEx(PyExc_UserWarning, text.c_str(), 1) != 0) throw nb::python_error();
        write_fiducial_folder(folder, path);
      },
      "path"_a, "sightings"_a, "cameras"_a, "tags"_a, "settings"_a = nb::none(),
      "compress"_a = false, kWriteDoc);
}

}  // namespace

void bind_fiducials(nb::module_& m) {
  bind_distortion(m);
  bind_camera(m);
  bind_noise_of_corners(m);
  bind_fiducial_files(m);
  bind_poses(m);
  bind_recordings(m);
}

}  // namespace posemix::python
