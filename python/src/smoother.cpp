// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/smoothing.hpp"

#include <nanobind/stl/vector.h>

#include "argument.hpp"
#include "copies.hpp"
#include "frame_input.hpp"

namespace posemix::python {
namespace {

constexpr const char* kSmootherDoc =
    R"(Object SLAM with smoothed estimates, each reported some frames later.

Parameters
----------
camera, objects, settings
    As for `ObjectSlam`; the filter must be the multi-object filter.
smoothing : SmoothingSettings
    Number of frames that the smoother looks ahead.
record_hypotheses : bool
    Whether estimates have the alternatives of every object.

Raises
------
ValueError
    As for `ObjectSlam`, when a setting is out of range, when the filter is not the multi-object filter,
    and when it only considers the camera.
)";

}  // namespace

void bind_smoother(nb::module_& m) {
  using S = FixedLagSmoother;
  nb::class_<S> smoother(m, "FixedLagSmoother", kSmootherDoc);
  smoother.def(
      "__init__",
      [](S* self, const Argument<ConcentratedSE3>& camera, const Argument<Models>& objects,
         const SmoothingSettings& smoothing, const std::optional<ObjectSlamSettings>& settings,
         bool record) {
        new (self) S(camera.as("camera", kOneDensity), models_of(objects, "objects"),
                     settings.value_or(ObjectSlamSettings{}), smoothing, record);
      },
      "camera"_a, "objects"_a, "smoothing"_a, "settings"_a = nb::none(),
      "record_hypotheses"_a = false);
  smoother
      .def(
          "step",
          [](S& self, const Argument<NamedInput>& input) {
            return self.step(input.as("input", "a FrameInput").of(self.slam().objects()));
          },
          "input"_a,
          "Processes the next frame; returns the estimate of the frame `lag_frames` earlier, if "
          "there is one.\n\n"
          "Raises\n------\nValueError\n    As for `ObjectSlam.step`, and for candidates.\n")
      .def("finish", &S::finish,
           "The estimates of the frames that have not been reported, after the last step.")
      .def_prop_ro(
          "slam", [](const S& self) { return ObjectSlam(self.slam()); },
          "A copy of the filter, which is at the last frame processed.")
      .def_prop_ro(
          "joint", [](const S& self) { return self.joint(); },
          "Joint density at the last frame reported: camera, its motion under constant velocity, "
          "objects.");
  with_copies(smoother);
}

}  // namespace posemix::python
