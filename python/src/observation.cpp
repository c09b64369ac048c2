// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/detector/observation.hpp"

#include "arrays.hpp"
#include "record.hpp"

namespace posemix::python {

void bind_observation(nb::module_& m) {
  using C = ObservationComponent;
  Record<C>(m, "ObservationComponent", "One of the poses that a detector takes for possible.")
      .field("pose", &C::pose, "posemix.lie.SE3", "T_camera_object.")
      .field("weight", &C::weight, "float", "Weight; those of an observation sum to one.")
      .field("covariance", &C::covariance, "numpy.typing.ArrayLike | None",
             "Shape (6, 6): covariance of the white error n of T_camera_object Exp(n), along the "
             "object's axes [rad, m]. None: that of the detector's noise.")
      .constructible(1)
      .done();
  using O = Observation;
  Record<O>(m, "Observation",
            "One sighting of one object: poses that exclude each other, with weights.")
      .field("components", &O::components, "collections.abc.Sequence[ObservationComponent]",
             "The poses; their weights sum to one.")
      .field("object", &O::object, "str",
             "Id of the object model; empty where only the class is known.")
      .field("class_id", &O::class_id, "str", "Class of the object, where `object` is empty.")
      .field("clutter", &O::clutter, "float | None",
             "Probability that the observation is of no object; None: that of the detector's "
             "noise.")
      .field("camera", &O::camera, "str", "Name of the camera of a rig.")
      .field("detector", &O::detector, "str", "Name of the detector.")
      .field("stamp_s", &O::stamp_s, "float", "Time of the image [s].")
      .field("score", &O::score, "float | None", "The detector's confidence in the sighting.")
      .constructible(1, [](const O& observation) { validate(observation); })
      .done(R"(
Raises
------
ValueError
    When there is no component, a weight is negative or their sum not one, a covariance not symmetric
    positive definite, or the probability of clutter not above 0 and at most 1 - 1e-9; it names the component.

Examples
--------
>>> from posemix import SE3, Observation, ObservationComponent
>>> cup = Observation([ObservationComponent(SE3.exp([0, 0, 0, 0, 0, 0.8]))], class_id="cup")
>>> cup.components[0].weight
1.0
)");
}

}  // namespace posemix::python
