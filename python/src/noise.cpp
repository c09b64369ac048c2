// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/detector/detector_noise.hpp"

#include <nanobind/stl/tuple.h>

#include "array_like.hpp"
#include "density.hpp"
#include "posemix/base/range.hpp"
#include "posemix/config/noise_toml.hpp"
#include "posemix/detector/default_noise.hpp"
#include "posemix/detector/object_sensor.hpp"
#include "settings.hpp"
#include "sides.hpp"
#include "words.hpp"

namespace posemix::python {
namespace {

void bind_parts(nb::module_& m) {
  Words<NoiseFrame>(m, "NoiseFrame",
                    "Axes of a noise covariance; rotations are about the detected mode's "
                    "origin.")
      .value(NoiseFrame::object, "Y = T_camera_object offset Exp(n), n along the mode's own axes.")
      .value(NoiseFrame::camera, "Axes of the camera.")
      .value(NoiseFrame::ray,
             "Axes with z along the viewing ray, and translations in units of the range.");
  Words<GivenCovariance>(m, "GivenCovariance",
                         "Use of the covariance that an observation brings itself.")
      .value(GivenCovariance::scaled,
             "The covariance of the white error, times the scale that is learned.")
      .value(GivenCovariance::as_given, "The covariance of the white error.")
      .value(GivenCovariance::ignored, "Nothing: the white error is that of the noise.");
  using C = NoiseComponent;
  Settings<C>(m, "NoiseComponent",
              "One component of a detector's error: Y = T_camera_object offset Exp(n).")
      .field("weight", &C::weight, "float", "Probability of the component.")
      .field("covariance", &C::covariance, "numpy.typing.ArrayLike",
             "Shape (6, 6) [rad, m; in the frame of the ray as a fraction of the range].")
      .field("frame", &C::frame, "NoiseFrame", "Axes of the covariance.")
      .field("offset", &C::offset, "posemix.lie.SE3",
             "Pose of the detected mode in the object's frame.")
      .field("run_length", &C::run_length, "float",
             "Number of successive detections with the same error; above one the component is one "
             "of gross errors.")
      .done();
  Settings<Clutter>(
      m, "Clutter",
      "A detection that does not depend on the object: uniform over rotations and a volume.")
      .field("weight", &Clutter::weight, "float", "Probability of clutter.")
      .field("volume_m3", &Clutter::volume_m3, "float", "The volume [m^3].")
      .done();
  using D = NoiseDependence;
  Settings<SlowError>(
      m, "SlowError",
      "The slow part of a detector's error, a stationary Gaussian process with the "
      "correlation\nexp(-angle / correlation_angle_rad - time / correlation_time_s).")
      .field("covariance", &SlowError::covariance, "numpy.typing.ArrayLike",
             "Shape (6, 6), in frame and units of the components.")
      .field("correlation_time_s", &SlowError::correlation_time_s, "float",
             "Correlation time [s]; may be infinite.")
      .field("correlation_angle_rad", &SlowError::correlation_angle_rad, "float",
             "Correlation angle of the viewing direction, seen from the object [rad]; may be "
             "infinite.")
      .done();
  Settings<D>(m, "NoiseDependence", "Dependence of successive detections of an object.")
      .field("slow", &D::slow, "SlowError | None",
             "The slow error; None: the errors of successive detections are independent.")
      .field("common", &D::common, "numpy.typing.ArrayLike | None",
             "Shape (6, 6): covariance of the error that all detections of a recording have in "
             "common, along the object's axes [rad, m].")
      .field("mode_time_s", &D::mode_time_s, "float",
             "Time for which a detector stays with one mode or with clutter [s].")
      .field("is_typical", &D::is_typical, "bool",
             "Whether the numbers are those of detectors in general and not of this one.")
      .field("given_covariance", &D::given_covariance, "GivenCovariance",
             "Use of the covariance that an observation brings itself: `scaled`, the covariance of "
             "the white error times the scale that is learned; `as_given`; `ignored`.")
      .done();
}

bool same_noise(const DetectorNoise& a, nb::handle other) {
  if (!nb::isinstance<DetectorNoise>(other)) return false;
  const DetectorNoise& b = *nb::inst_ptr<DetectorNoise>(other);
  return nb::cast(a.components()).equal(nb::cast(b.components())) &&
         nb::cast(a.clutter()).equal(nb::cast(b.clutter())) &&
         nb::cast(a.dependence()).equal(nb::cast(b.dependence()));
}

constexpr const char* kDetectorNoiseDoc =
    R"(The error of one detector on one class of objects: a mixture of components and clutter.

Parameters
----------
components : list of NoiseComponent
    At least one; weights are normalised with clutter's.
clutter : Clutter, optional
    Detections of nothing; weight zero unless given.
dependence : NoiseDependence, optional
    Dependence of successive detections.

Raises
------
ValueError
    Naming the component whose weight is not positive or whose covariance is not positive definite.

References
----------
Midway-merge paper, eq. 33.
)";

void bind_detector_noise(nb::module_& m) {
  using D = DetectorNoise;
  nb::class_<D> noise(m, "DetectorNoise", kDetectorNoiseDoc);
  noise.def(
      "__init__",
      [](D* self, const std::vector<NoiseComponent>& components,
         const std::optional<Clutter>& clutter, const std::optional<NoiseDependence>& dependence) {
        new (self)
            D(components, clutter.value_or(Clutter{}), dependence.value_or(NoiseDependence{}));
      },
      "components"_a, "clutter"_a = nb::none(), "dependence"_a = nb::none());
  noise.def_prop_ro(
      "components", [](const D& self) { return frozen(self.components()); },
      nb::for_getter(
          nb::sig("def components(self, /) -> collections.abc.Sequence[NoiseComponent]")),
      "Copies of the components, which cannot be changed.");
  noise.def_prop_ro(
      "clutter", [](const D& self) { return frozen(self.clutter()); },
      nb::for_getter(nb::sig("def clutter(self, /) -> Clutter")),
      "A copy of clutter, which cannot be changed.");
  noise.def_prop_ro(
      "dependence", [](const D& self) { return frozen(self.dependence()); },
      nb::for_getter(nb::sig("def dependence(self, /) -> NoiseDependence")),
      "A copy of the dependence, which cannot be changed.");
  noise.def_prop_ro("log_clutter_density", &D::log_clutter_density,
                    "Log of clutter's weight times its density [nats]; -inf for weight zero.");
  noise.def_prop_ro("is_white", &D::is_white,
                    "Whether the errors of successive detections are independent.");
  noise.def("as_white", &D::as_white,
            "The model for filters that take successive errors for independent: slow error and "
            "error in common are a part of every component.");
  noise.def("single_gaussian", &D::single_gaussian,
            "The one Gaussian with the second moment of the components without an offset.");
  noise.def(
      "to_toml",
      [](const D& self, const std::string& name) { return format_noise_toml(name, self); },
      "name"_a = "detector", "The table `[noise.NAME]` of a sequence file with all digits.");
  noise.def("__eq__", &same_noise, nb::sig("def __eq__(self, other: object, /) -> bool"));
  noise.def("__getstate__", [](const D& self) {
    return nb::make_tuple(self.components(), self.clutter(), self.dependence());
  });
  noise.def(
      "__setstate__",
      [](D& self, const std::tuple<std::vector<NoiseComponent>, Clutter, NoiseDependence>& state) {
        new (&self) D(std::get<0>(state), std::get<1>(state), std::get<2>(state));
      });
  noise.def("__repr__", [](const D& self) {
    std::string weights;
    for (const NoiseComponent& c : self.components())
      weights +=
          fmt::format("{}{:.4g} {}", weights.empty() ? "" : ", ", c.weight, word_of(c.frame));
    return fmt::format("<DetectorNoise of {}: {}; clutter {:.4g}>", self.components().size(),
                       weights, self.clutter().weight);
  });
  noise.attr("__hash__") = nb::none();
}

constexpr const char* kPoseCovarianceDoc =
    R"(Diagonal covariance from standard deviations about and along x, y, z.

Parameters
----------
rotation_sd_rad, translation_sd_m : array_like, shape (3,) or ()
    Standard deviations [rad, m]; a single one is used for all axes.

Returns
-------
ndarray, shape (6, 6)

Examples
--------
>>> from posemix import pose_covariance
>>> pose_covariance(0.1, [0.02, 0.02, 0.5]).diagonal().round(4)
array([0.01  , 0.01  , 0.01  , 0.0004, 0.0004, 0.25  ])
)";

void bind_sensor(nb::module_& m) {
  using S = ObjectSensor;
  Settings<S>(m, "ObjectSensor", "The detector's view of one object: noise and symmetries.",
              [] { return ObjectSensor{.noise = default_detector_noise()}; })
      .field("noise", &S::noise, "DetectorNoise", "The error of its detections.")
      .field("symmetries", &S::symmetries, "SymmetryGroup", "The poses that look the same.")
      .field("noise_scale", &S::noise_scale, "numpy.typing.ArrayLike",
             "Shape (6,): factors of the noise's standard deviations along its own axes.")
      .field("slow_scale", &S::slow_scale, "numpy.typing.ArrayLike",
             "Shape (6,): the same for the slow part of the error.")
      .field("other_detectors", &S::other_detectors, "list[DetectorNoise]",
             "Noise of further detectors of the object; their slow error is the same one, each in "
             "its own units.")
      .field("slow_units", &S::slow_units, "numpy.typing.ArrayLike | None",
             "Shape (6, 6): from the slow error of the object's first detector that has one to "
             "that of this detector; None is the identity.")
      .done();
  m.def(
      "pose_covariance",
      [](const ArrayLike& rotation, const ArrayLike& translation) {
        const Eigen::Vector3d turn = Sides::set(rotation, "rotation_sd_rad");
        const Eigen::Vector3d shift = Sides::set(translation, "translation_sd_m");
        for (const double sd : turn) kNotNegative.check(sd, "rotation_sd_rad");
        for (const double sd : shift) kNotNegative.check(sd, "translation_sd_m");
        return matrix_array(pose_covariance(turn, shift));
      },
      "rotation_sd_rad"_a, "translation_sd_m"_a, kPoseCovarianceDoc);
  m.def("default_detector_noise", &default_detector_noise,
        "The default noise of detectors that use single images.\n\n"
        "Rotation about the camera's axes 7.5 deg and about the viewing ray 2 deg, translation "
        "0.7 % of the range across\nthe ray and 4.5 % along it; a second component 2.7 times as "
        "wide; and clutter.\n");
  m.def("along_camera", &along_camera, "noise"_a, "camera_object"_a,
        "The component with covariances along the camera's axes [rad, m], for an object at "
        "`camera_object`.\n\n"
        "Parameters\n----------\nnoise : NoiseComponent\n"
        "    Of NoiseFrame.ray or any other, which stays as it is.\n"
        "camera_object : SE3\n    T_camera_object.\n");
}

}  // namespace

void bind_noise(nb::module_& m) {
  bind_parts(m);
  bind_detector_noise(m);
  bind_sensor(m);
}

}  // namespace posemix::python
