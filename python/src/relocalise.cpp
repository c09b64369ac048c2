// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/relocalise.hpp"

#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "posemix/slam/object_slam.hpp"
#include "posemix/slam/stamped_slam.hpp"
#include "record.hpp"
#include "settings.hpp"
#include "slam.hpp"
#include "words.hpp"

namespace posemix::python {
namespace {

constexpr const char* kRelocaliseDoc =
    R"(The pose of an old map in the world of a new run, from the objects that are in both.

They are those of one id, or of one class, where it is found which instance is which. Every object may
be at any of its hypotheses in both maps, up to its symmetries, and some may have been moved since.
Objects that move take no part.

Parameters
----------
old_map : ObjectSlam or StampedSlam
    The old map, as loaded from a file.
now : ObjectSlam or StampedSlam
    The new run, at its last estimate.
settings : RelocaliseSettings, optional
    When objects agree, and when their pose counts as found.

Returns
-------
Relocalisation
    The pose, where it was found, and every object of the old map in the new world.

Raises
------
ValueError
    When a setting is out of range, and for another tracker than the multi-object filter.

Examples
--------
>>> from posemix import (SE3, ConcentratedGaussian, FrameInput, ObjectModel, ObjectSlam, models_with_priors,
...                      pose_covariance, relocalise)
>>> mug, box, jar = (SE3.exp(twist) for twist in ([0, 0, 0, 0, 0, 1], [0, 1, 0, 0.3, 0, 1], [1, 0, 0, 0, 0.3, 1]))
>>> models = [ObjectModel(id=name) for name in ("mug", "box", "jar")]
>>> start = ConcentratedGaussian(SE3(), pose_covariance(0.001, 0.002))
>>> old = ObjectSlam(start, models)
>>> moved = SE3.exp([0, 0, 0.5, 0.2, 0, 0])
>>> now = ObjectSlam(start, models)
>>> for _ in range(10):
...     _ = old.step(FrameInput(0.1, SE3(), {"mug": mug, "box": box, "jar": jar}))
...     _ = now.step(FrameInput(0.1, SE3(), {"mug": moved * mug, "box": moved * box}))
>>> found = relocalise(old, now)
>>> found.outcome, [one.object for one in found.objects]
(RelocaliseOutcome.found, ['mug', 'box', 'jar'])
>>> found.new_old.mean.is_approx(moved, 1e-9)
True
>>> known = models_with_priors(old, found)
>>> known[2].id, known[2].prior is not None
('jar', True)
)";

/// A copy of the tracker, on which another thread may go on meanwhile.
/// @throws InvalidInput naming the argument for another tracker than the multi-object filter
MultiObjectSlam tracker_in(nb::handle given, const char* name) {
  if (nb::isinstance<StampedSlam>(given)) return nb::cast<const StampedSlam&>(given).slam();
  if (nb::isinstance<ObjectSlam>(given)) {
    const auto& slam = nb::cast<const ObjectSlam&>(given);
    if (const auto* tracker = std::get_if<MultiObjectSlam>(&slam.tracker())) return *tracker;
    throw InvalidInput(
        fmt::format("{} has another tracker, expected the multi-object filter", name));
  }
  throw nb::type_error(fmt::format("{} is of type {}; expected an ObjectSlam or a StampedSlam",
                                   name, nb::cast<std::string>(given.type().attr("__name__")))
                           .c_str());
}

void bind_relocalise_settings(nb::module_& m) {
  using S = RelocaliseSettings;
  Settings<S>(m, "RelocaliseSettings", "Settings of `relocalise`.")
      .field("least_objects", &S::least_objects, "int", "Fewer objects that agree are not enough.")
      .field("least_probability", &S::least_probability, "float",
             "Least probability of the best one of poses that differ, which are ambiguous else.")
      .field("agreement_probability", &S::agreement_probability, "float",
             "Quantile of their error (chi-square, 6 degrees of freedom) within which two objects "
             "agree.")
      .field("moved_probability", &S::moved_probability, "float",
             "Probability that an object is not where it was, but anywhere in `volume_m3`.")
      .field("volume_m3", &S::volume_m3, "float", "Volume in which an object may have moved [m^3].")
      .field("largest_rotation_sd_rad", &S::largest_rotation_sd_rad, "float",
             "Standard deviation of the rotation between the worlds about any axis beyond which it "
             "is taken as undetermined [rad].")
      .field("least_existence", &S::least_existence, "float",
             "Objects that exist with less than this probability take no part.")
      .done();
}

void bind_relocalisation(nb::module_& m) {
  using O = RelocaliseOutcome;
  Words<O>(m, "RelocaliseOutcome", "Outcome of `relocalise`.")
      .value(O::found, "The pose was found.")
      .value(O::too_few_shared, "Fewer objects are in both maps than needed.")
      .value(O::too_few_agree, "Fewer agree on one pose than needed.")
      .value(O::undetermined, "Those that agree leave the rotation free.")
      .value(O::ambiguous, "Another pose is about as probable.");
  using A = AgreedObject;
  Record<A>(m, "AgreedObject", "An object of the old map and the one of the new run that it is.")
      .field("old_object", &A::old_object, "str", "Id in the old map.")
      .field("old_hypothesis", &A::old_hypothesis, "int", "Index among its hypotheses there.")
      .field("new_object", &A::new_object, "str", "Id in the new run.")
      .field("new_hypothesis", &A::new_hypothesis, "int", "Index among its hypotheses there.")
      .field("squared_distance", &A::squared_distance, "float",
             "Squared distance from where all others expect it, in standard deviations.")
      .done();
  using R = RelocatedObject;
  Record<R>(m, "RelocatedObject", "An object of the old map in the new world.")
      .made_from([] {
        return R{.object = {},
                 .world = unit_density(),
                 .given_camera = Matrix6d::Identity(),
                 .probability = 0.0,
                 .is_agreed = false};
      })
      .field("object", &R::object, "str", "Id in the old map.")
      .field("world", &R::world, "ConcentratedGaussian",
             "T_newworld_object, with all that both maps know of it.")
      .field("given_camera", &R::given_camera, "numpy.ndarray",
             "Covariance of `world` (shape (6, 6)) where the camera of the new run is at its "
             "estimate, without what the errors of both have in common.")
      .field("probability", &R::probability, "float", "Probability that it is there.")
      .field("is_agreed", &R::is_agreed, "bool", "Whether it is one of `Relocalisation.agreed`.")
      .done();
  using L = Relocalisation;
  Record<L>(m, "Relocalisation", "Result of `relocalise`.")
      .field("outcome", &L::outcome, "RelocaliseOutcome", "Outcome of the search.")
      .field("new_old", &L::new_old, "ConcentratedGaussian | None",
             "T_newworld_oldworld with its covariance; None where it was not found.")
      .field("probability", &L::probability, "float",
             "Probability of the best pose among all that were found.")
      .field("shared", &L::shared, "int",
             "Number of objects of the new run that the old map may have.")
      .field("agreed", &L::agreed, "list[AgreedObject]",
             "Objects that agree on the best pose, found or not.")
      .field("disagreeing", &L::disagreeing, "list[str]",
             "Ids of objects of the new run that are elsewhere now.")
      .field("objects", &L::objects, "list[RelocatedObject]",
             "Objects of the old map that stand still, but for those that are elsewhere; empty "
             "where the pose was not found.")
      .done();
}

}  // namespace

void bind_relocalise(nb::module_& m) {
  bind_relocalise_settings(m);
  bind_relocalisation(m);
  m.def(
      "relocalise",
      [](const nb::object& old_map, const nb::object& now,
         const std::optional<RelocaliseSettings>& settings) {
        const MultiObjectSlam before = tracker_in(old_map, "old_map");
        const MultiObjectSlam after = tracker_in(now, "now");
        const nb::gil_scoped_release unlocked;
        return relocalise(before, after, settings.value_or(RelocaliseSettings{}));
      },
      "old_map"_a, "now"_a, "settings"_a = nb::none(),
      nb::sig("def relocalise(old_map: ObjectSlam | StampedSlam, now: ObjectSlam | StampedSlam, "
              "settings: RelocaliseSettings | None = None) -> Relocalisation"),
      kRelocaliseDoc);
  m.def(
      "models_with_priors",
      [](const nb::object& old_map, const Relocalisation& relocalisation) {
        return models_with_priors(tracker_in(old_map, "old_map"), relocalisation);
      },
      "old_map"_a, "relocalisation"_a,
      nb::sig("def models_with_priors(old_map: ObjectSlam | StampedSlam, relocalisation: "
              "Relocalisation) -> list[ObjectModel]"),
      "Models of the old map with their places in the new world as priors.\n\n"
      "They are for a tracker that begins where the new run has its camera, exactly there, and "
      "have the covariances `RelocatedObject.given_camera`. Models of objects that were not "
      "relocated have no prior.\n\n"
      "Raises\n------\nValueError\n    Where the pose was not found.\n");
}

}  // namespace posemix::python
