// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/fuse_views.hpp"

#include <nanobind/stl/map.h>

#include "mixture.hpp"
#include "record.hpp"
#include "settings.hpp"
#include "slam.hpp"

namespace posemix::python {
namespace {

constexpr const char* kFuseViewsDoc =
    R"(The objects that the observations of several views are of.

Errors of views are correlated by the angle between them, as far as the noise of the detector has a
slow error; cases with clutter, and with a pose at the right place in a wrong orientation, are kept.

Parameters
----------
views : sequence of View
    Images with their camera poses, which are taken for exact.
classes : dict of str to ViewClass, optional
    Noise and symmetries by class, or by object where observations name one.
settings : FuseViewsSettings, optional
    Association and fusion.

Returns
-------
list of FusedInstance
    In the order of falling probability.

Raises
------
ValueError
    For an observation that is not valid or has neither object nor class, naming view and observation.

Examples
--------
>>> from posemix import SE3, Observation, ObservationComponent, View, fuse_views
>>> pose = SE3.exp([0, 0, 0, 0, 0, 0.8])
>>> side = SE3.exp([0, 0, 0, 0.1, 0, 0])
>>> views = [View(camera, [Observation([ObservationComponent(camera.inverse() * pose)],
...                                    class_id="cup")]) for camera in (SE3(), side)]
>>> cup = fuse_views(views)[0]
>>> cup.class_id, len(cup.support)
('cup', 2)
)";

FusedInstance blank_instance() {
  return {.density = Mixture<ConcentratedSE3>({{0.0, unit_density()}})};
}

void bind_view_settings(nb::module_& m) {
  using S = FuseViewsSettings;
  Settings<S>(m, "FuseViewsSettings", "Settings of `fuse_views`.")
      .field("detection_probability", &S::detection_probability, "float",
             "Probability that an object of the scene is detected in a view.")
      .field("turned_share", &S::turned_share, "float",
             "The part of the clutter that is at the place of the object, in any orientation.")
      .field("gate_probability", &S::gate_probability, "float",
             "Observations further apart than this part of the distribution of the difference of "
             "their positions are of different objects.")
      .field("mode_angle_rad", &S::mode_angle_rad, "float",
             "Views within this angle of each other count as about one in the weights of modes; 0: "
             "all "
             "count [rad].")
      .field("least_separation_m", &S::least_separation_m, "float",
             "Distance within which the less probable of two instances is dropped [m].")
      .field("max_hypotheses", &S::max_hypotheses, "int", "Hypotheses kept in a fusion.")
      .field("max_association_hypotheses", &S::max_association_hypotheses, "int",
             "Hypotheses kept in the association.")
      .field("max_components", &S::max_components, "int", "Components kept of an instance.")
      .field("prune_below", &S::prune_below, "float", "Least weight of a component.")
      .field("use_given_covariances", &S::use_given_covariances, "bool",
             "Whether covariances of observations replace the white error of the noise.")
      .done();
  using C = ViewClass;
  Settings<C>(m, "ViewClass", "Detector noise and symmetries of one class of objects.")
      .field("noise", &C::noise, "posemix.noise.DetectorNoise", "Noise of the detector.")
      .field("symmetries", &C::symmetries, "SymmetryGroup", "Symmetries of the object.")
      .done();
}

void bind_views(nb::module_& m) {
  using V = View;
  Record<V>(m, "View", "One image of known camera pose.")
      .field("world_camera", &V::world_camera, "posemix.lie.SE3", "T_world_camera, exact.")
      .field("observations", &V::observations, "collections.abc.Sequence[Observation]",
             "Detections in the image.")
      .constructible(1)
      .done();
  using P = ViewSupport;
  Record<P>(m, "ViewSupport", "The observation of one view that an instance took.")
      .field("view", &P::view, "int", "Index of the view.")
      .field("observation", &P::observation, "int", "Index of the observation in the view.")
      .field("probability", &P::probability, "float",
             "Probability, given the leading mode, that one of its poses is of it.")
      .done();
  using I = FusedInstance;
  Record<I>(m, "FusedInstance", "An object of the scene.")
      .field("class_id", &I::class_id, "str",
             "Class of the object, or its id where observations name one.")
      .field("density", &I::density,
             "posemix.mixture.Mixture[posemix.density.ConcentratedGaussian[posemix.lie.SE3]]",
             "T_world_object, the heaviest component first.")
      .field("probability", &I::probability, "float",
             "Probability that there is an object, and not only clutter.")
      .field("supporting_views", &I::supporting_views, "float",
             "Number of views that agree on the leading mode.")
      .field("support", &I::support, "collections.abc.Sequence[ViewSupport]",
             "The observations it took, in the order of the views.")
      .made_from(blank_instance)
      .done();
}

}  // namespace

void bind_fuse_views(nb::module_& m) {
  bind_view_settings(m);
  bind_views(m);
  m.def(
      "fuse_views",
      [](const std::vector<View>& views, const std::optional<ViewClasses>& classes,
         const std::optional<FuseViewsSettings>& settings) {
        const nb::gil_scoped_release unlocked;
        return fuse_views(views, classes.value_or(ViewClasses{}),
                          settings.value_or(FuseViewsSettings{}));
      },
      "views"_a, "classes"_a = nb::none(), "settings"_a = nb::none(), kFuseViewsDoc);
}

}  // namespace posemix::python
