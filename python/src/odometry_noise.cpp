// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <variant>

#include <nanobind/stl/array.h>
#include <nanobind/stl/variant.h>
#include <nanobind/typing.h>

#include "posemix/config/noise_toml.hpp"
#include "posemix/detector/noise_fit.hpp"
#include "posemix/detector/odometry_noise.hpp"
#include "record.hpp"
#include "settings.hpp"
#include "slam.hpp"

namespace posemix::python {
namespace {

constexpr const char* kOdometryDoc =
    R"(Learns the random walk of the odometry and the jitter of the ground truth from the growth of the error with time.

Parameters
----------
recordings : Sequence or iterable of Sequence
    Recordings; those without `odometry` or `camera_truth` are left out.
settings : OdometryNoiseSettings, optional
    Lengths of the windows, number of samples for the standard errors.

Raises
------
ValueError
    If no recording has a window with odometry and ground truth at both ends.
)";

}  // namespace

void bind_odometry_noise(nb::module_& m) {
  using S = OdometryNoiseSettings;
  Settings<S>(m, "OdometryNoiseSettings", "Settings of `fit_odometry_noise`.")
      .field("windows_s", &S::windows_s, "collections.abc.Sequence[float]",
             "Lengths of the windows [s].")
      .field("scene_distance_m", &S::scene_distance_m, "float | None",
             "Distance of the scene [m]; None: estimated.")
      .field("bootstrap", &S::bootstrap, "int", "Samples of recordings for the standard errors.")
      .field("seed", &S::seed, "int", "Seed of these samples.")
      .done();
  using W = OdometryWindow;
  Record<W>(m, "OdometryWindow", "The error of the relative pose over windows of one length.")
      .field("seconds", &W::seconds, "float", "Length of the windows [s].")
      .field("independent", &W::independent, "float", "Number of windows that do not overlap.")
      .field("variance", &W::variance, kFloatArray,
             "Shape (6,) [rad^2, m^2], axes of the camera at the end.")
      .field("fitted", &W::fitted, kFloatArray, "Shape (6,): the variance by the fitted model.")
      .done();
  using O = OdometryNoise;
  Record<O>(
      m, "OdometryNoise",
      "The noise of odometry, of a point that moves with the camera, along the camera's axes.")
      .field("sd_per_sqrt_s", &O::sd_per_sqrt_s, kFloatArray,
             "Shape (6,): random walk, per square root of a second [rad, m].")
      .field("jitter_sd", &O::jitter_sd, kFloatArray,
             "Shape (6,): white jitter of the truth [rad, m].")
      .field("sd_per_sqrt_s_error", &O::sd_per_sqrt_s_error, kFloatArray,
             "Shape (6,): standard error; NaN for fewer than two recordings.")
      .field("jitter_sd_error", &O::jitter_sd_error, kFloatArray, "Shape (6,): standard error.")
      .field("windows", &O::windows, "list[OdometryWindow]", "Windows of all lengths.")
      .field("recordings", &O::recordings, "int", "Number of recordings.")
      .field("scene_distance_m", &O::scene_distance_m, "float",
             "Distance on the optical axis of the point whose noise this is.")
      .field("scene_distance_error_m", &O::scene_distance_error_m, "float",
             "Standard error; NaN where the distance was given.")
      .done()
      .def(
          "to_toml", [](const O& self) { return format_odometry_toml(self); },
          "The table `[motion]` of a sequence file, with comments.");
  using Recordings = std::variant<Sequence, nb::typed<nb::iterable, Sequence>>;
  m.def(
      "fit_odometry_noise",
      [](const Recordings& recordings, const std::optional<S>& settings) {
        std::vector<OdometryRecording> all;
        const auto add = [&](const Sequence& s) {
          if (s.odometry.empty() || s.camera_truth.empty()) return;
          all.push_back({std::to_string(all.size()), s.stamps, s.odometry, s.camera_truth});
        };
        if (const auto* one = std::get_if<Sequence>(&recordings)) {
          add(*one);
        } else {
          std::size_t i = 0;
          for (const nb::handle each : std::get<1>(recordings)) {
            const Argument<Sequence> entry{nb::borrow(each)};
            add(entry.as(fmt::format("recordings[{}]", i++), "a Sequence"));
          }
        }
        const nb::gil_scoped_release unlocked;
        return fit_odometry_noise(all, settings.value_or(S{}));
      },
      "recordings"_a, "settings"_a = nb::none(), kOdometryDoc);
}

}  // namespace posemix::python
