// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/existence.hpp"

#include <fmt/format.h>
#include <nanobind/stl/vector.h>

#include "copies.hpp"
#include "posemix/base/range.hpp"
#include "posemix/slam/instance_tracks.hpp"
#include "record.hpp"
#include "settings.hpp"
#include "words.hpp"

namespace posemix::python {
namespace {

constexpr const char* kExistenceDoc =
    R"(Probability that one instance exists: an object with an unknown probability of detection, or clutter with one.

An instance begins with a detection. `MultiObjectSlamSettings.existence` sets what object SLAM does.

Parameters
----------
settings : ExistenceSettings, optional
    Rates of detection, and times.

Raises
------
ValueError
    When a setting is out of range.

Examples
--------
>>> from posemix import Existence, Sighting
>>> existence = Existence()
>>> for _ in range(5):
...     existence.predict(1.0)
...     existence.update(Sighting.detected, 1.0)
>>> bool(existence.probability > 0.9)
True
)";

constexpr const char* kFitDoc =
    R"(Settings of existence as learned from instances of recordings with truth.

Parameters
----------
counts : sequence of InstanceCounts
    Detections of every instance, at least two of objects and two of clutter.
settings : ExistenceSettings, optional
    Settings before, which count as a weak prior.

Returns
-------
ExistenceSettings
    The same with other `birth_probability`, `object_rate` and `clutter_rate`.

Raises
------
ValueError
    For counts that are negative, not finite or more detections than images, and for too few instances.
)";

void bind_enums(nb::module_& m) {
  Words<TrackHealth>(m, "TrackHealth",
                     "State of the track of one object; where several hold, the last one of them.")
      .value(TrackHealth::none, "The object was never seen.")
      .value(TrackHealth::tentative, "The object is not confirmed.")
      .value(TrackHealth::good,
             "The object is confirmed, on one mode, and detections are as the noise says.")
      .value(TrackHealth::ambiguous, "The estimate may be on another mode.")
      .value(TrackHealth::inconsistent,
             "Detections are beyond the band of the noise, or most are doubted.")
      .value(TrackHealth::lost, "The object should be seen, and is not.");
  nb::enum_<Sighting>(m, "Sighting", "Result of one image for an instance.")
      .value("detected", Sighting::detected, "The instance was detected.")
      .value("missed", Sighting::missed, "The instance was in view, and not detected.")
      .value("out_of_view", Sighting::out_of_view, "The instance could not be detected.");
}

void bind_settings(nb::module_& m) {
  using B = BetaDistribution;
  Settings<B>(m, "BetaDistribution",
              "Beta distribution of a rate, with the density proportional to r^(a-1) (1-r)^(b-1).")
      .field("a", &B::a, "float", "First parameter, positive.")
      .field("b", &B::b, "float", "Second parameter, positive.")
      .done();
  using E = ExistenceSettings;
  Settings<E>(m, "ExistenceSettings", "Settings of the existence of instances.")
      .field("birth_probability", &E::birth_probability, "float",
             "Probability that a detection of no known instance is of an object of its class.")
      .field("object_rate", &E::object_rate, "BetaDistribution",
             "Distribution over objects of the probability per image that one in view is detected.")
      .field("clutter_rate", &E::clutter_rate, "BetaDistribution",
             "The same for what the detector takes for an object.")
      .field("visible_time_s", &E::visible_time_s, "float",
             "Mean time after which an object in view becomes hidden [s].")
      .field("hidden_time_s", &E::hidden_time_s, "float",
             "Mean time after which a hidden object appears again [s].")
      .field("lifetime_s", &E::lifetime_s, "float",
             "Mean time for which an object stays where it is [s].")
      .field("look_time_s", &E::look_time_s, "float",
             "Time [s] within which images tell the same: one that follows by t counts as 1 - "
             "exp(-t / look_time_s) of an image.")
      .field("exclusion_m", &E::exclusion_m, "float",
             "Distance within which two instances of classes do not both exist [m].")
      .field("confirmed_probability", &E::confirmed_probability, "float",
             "Probability from which an instance is confirmed.")
      .field("deleted_probability", &E::deleted_probability, "float",
             "Probability below which an instance of a class is forgotten.")
      .done();
  using H = HealthSettings;
  Settings<H>(m, "HealthSettings", "Settings of `TrackHealth`.")
      .field("mode_probability", &H::mode_probability, "float",
             "Probability of the mode below which a track is ambiguous.")
      .field("window_detections", &H::window_detections, "float",
             "Number of detections over which innovations are averaged.")
      .field("band_probability", &H::band_probability, "float",
             "Quantile of its distribution at which the mean square innovation may be.")
      .field("lost_probability", &H::lost_probability, "float",
             "Probability to be in sight below which a track is lost.")
      .field("register_again_s", &H::register_again_s, "float",
             "Time for which a track is lost or inconsistent until it should be registered again "
             "[s].")
      .done();
  using C = InstanceCounts;
  Record<C>(m, "InstanceCounts", "Number of detections of one instance since its first one.")
      .field("images", &C::images, "float",
             "Images in which it was in view, each as the part of a look that it is.")
      .field("detections", &C::detections, "float", "Detections in these.")
      .field("is_object", &C::is_object, "bool",
             "Whether it was an object of its class, by the truth of a recording.")
      .constructible(0)
      .done();
}

ExistenceSettings or_default(const std::optional<ExistenceSettings>& settings) {
  return settings.value_or(ExistenceSettings{});
}

/// An Existence with its settings.
struct NamedExistence {
  ExistenceSettings settings;
  Existence existence;

  explicit NamedExistence(const ExistenceSettings& given) : settings(given), existence(given) {}
};

void bind_class(nb::module_& m) {
  using N = NamedExistence;
  nb::class_<N> existence(m, "Existence", kExistenceDoc);
  existence
      .def(
          "__init__",
          [](N* self, const std::optional<ExistenceSettings>& settings) {
            new (self) N(or_default(settings));
          },
          "settings"_a = nb::none())
      .def(
          "predict",
          [](N& self, double dt) {
            kNotNegative.check(dt, "dt");
            self.existence.predict(dt, self.settings);
          },
          "dt"_a, "Lets `dt` seconds pass.")
      .def(
          "update",
          [](N& self, Sighting sighting, double dt) {
            kNotNegative.check(dt, "dt");
            self.existence.update(sighting, dt, self.settings);
          },
          "sighting"_a, "dt"_a, "Takes in one image, `dt` seconds after the last one.")
      .def_prop_ro(
          "probability", [](const N& self) { return self.existence.probability(); },
          "Probability that the instance is an object that is there.")
      .def_prop_ro(
          "visible_probability", [](const N& self) { return self.existence.visible_probability(); },
          "Probability that it is hidden by nothing and not gone.")
      .def_prop_ro(
          "detection_probability",
          [](const N& self) { return self.existence.detection_probability(); },
          "Mean of the probability per image with which it is detected while it is visible.")
      .def("__repr__", [](const N& self) {
        return fmt::format("<Existence {:.4g}>", self.existence.probability());
      });
  with_copies(existence);
  m.def(
      "fit_existence",
      [](const std::vector<InstanceCounts>& counts,
         const std::optional<ExistenceSettings>& settings) {
        return fit_existence(counts, or_default(settings));
      },
      "counts"_a, "settings"_a = nb::none(), kFitDoc);
}

}  // namespace

void bind_existence(nb::module_& m) {
  bind_enums(m);
  bind_settings(m);
  bind_class(m);
}

}  // namespace posemix::python
