// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "filter.hpp"

#include <functional>
#include <optional>
#include <variant>

#include <nanobind/stl/function.h>
#include <nanobind/stl/variant.h>

#include "argument.hpp"
#include "array_like.hpp"
#include "posemix/detector/default_noise.hpp"
#include "posemix/filter/predict.hpp"
#include "posemix/slam/object_slam.hpp"
#include "record.hpp"
#include "settings.hpp"
#include "words.hpp"

namespace posemix::python {
namespace {

void bind_enums(nb::module_& m) {
  Words<NoiseUse>(m, "NoiseUse",
                  "Rule by which noise components are combined over the objects seen.")
      .value(NoiseUse::joint, "One component for all visible objects (the midway paper's filter).")
      .value(NoiseUse::per_object, "One component for every object, one object after another.")
      .value(NoiseUse::most_likely,
             "One component per object, but every hypothesis keeps only its likeliest child "
             "(max-mixture).");
  Words<UpdateRule>(m, "UpdateRule", "Rule by which one hypothesis is updated.")
      .value(UpdateRule::linearized, "One linearisation, at the prior mean.")
      .value(UpdateRule::iterated,
             "Several linearisations; consistent when the odometry is bad against the detector.");
  Words<RobustLoss>(m, "RobustLoss", "The loss by which a hypothesis is updated.")
      .value(RobustLoss::none, "The squared Mahalanobis distance.")
      .value(RobustLoss::cauchy, "c^2 log(1 + d^2 / c^2).");
  Words<Summary>(m, "Summary", "Rule by which one estimate is made of the hypotheses.")
      .value(Summary::best, "The hypothesis of the largest weight.")
      .value(Summary::merge_two_largest,
             "The merge of the two largest weights (the midway paper's).")
      .value(Summary::whole_mixture, "The merge of all hypotheses.");
}

void bind_filter_settings(nb::module_& m) {
  using S = GaussianSumSettings;
  Settings<S>(m, "GaussianSumSettings", "Settings of `GaussianSumFilter`.")
      .field("noise_use", &S::noise_use, "NoiseUse", "Rule by which noise components are combined.")
      .field("update", &S::update, "UpdateRule", "Rule by which one hypothesis is updated.")
      .field("robust_loss", &S::robust_loss, "RobustLoss", "Loss by which a hypothesis is updated.")
      .field("cauchy_scale", &S::cauchy_scale, "float",
             "Scale of RobustLoss.cauchy in standard deviations.")
      .field("gate_probability", &S::gate_probability, "float",
             "Quantile beyond which a detection is left out (chi-square, 6); 1: no gate.")
      .field("summary", &S::summary, "Summary",
             "Rule by which one estimate is made of the hypotheses.")
      .field("reduction", &S::reduction, "ReductionSettings", "Reduction of the hypotheses.")
      .field("first_object", &S::first_object, "int",
             "Index of the first object's pose: 2 where the motion is part of the state.")
      .done();
}

/// A `Detection` that owns its noise.
struct OwnedDetection {
  std::size_t object = 0;
  SE3d camera_object;
  DetectorNoise noise = default_detector_noise();
};

void bind_results(nb::module_& m) {
  using D = OwnedDetection;
  Record<D>(m, "Detection", "A detection for `GaussianSumFilter.update`.")
      .field("object", &D::object, "int", "Index of the object's pose in the posterior.")
      .field("camera_object", &D::camera_object, "posemix.lie.SE3", "T_camera_object as detected.")
      .field("noise", &D::noise, "DetectorNoise", "Noise of the detector.")
      .constructible(3)
      .done();
  using R = UpdateReport;
  Record<R>(m, "UpdateReport", "Report of an update on every detection, in the order given.")
      .field("gated", &R::gated, "list[bool]", "Whether each detection was left out by the gate.")
      .field("failed", &R::failed, "list[bool]",
             "Left out because an innovation covariance was not positive definite.")
      .field("nis", &R::nis, "list[float | None]",
             "z^T S^-1 z of the heaviest hypothesis before each detection, under the noise "
             "component that explains it best, of six degrees of freedom.")
      .field("log_evidence", &R::log_evidence, "float",
             "Log of the summed likelihood of the detections used [nats].")
      .field("reductions", &R::reductions, "list[ReductionReport]",
             "Reductions: a single one for joint use, otherwise one per used detection.")
      .field("update_seconds", &R::update_seconds, "float", "Time that updating took [s].")
      .field("reduce_seconds", &R::reduce_seconds, "float", "Time that reducing took [s].")
      .done();
}

constexpr const char* kFilterDoc =
    R"(The Gaussian-sum invariant EKF: predict, update (with a reduction), summarise.

Every hypothesis holds the same poses in the same order; pose 0 is the camera.

Parameters
----------
prior : Mixture or ConcentratedGaussian
    Density over T_world_camera alone, or over the camera and objects jointly.
settings : GaussianSumSettings, optional
    Use of detections, and reduction of hypotheses.

Raises
------
ValueError
    When a setting is out of range, or a pose of the prior more than 100 km from the origin.

References
----------
Midway-merge paper, Algorithm 1.
)";

constexpr const char* kOdometryDoc = R"(T_R <- T_R motion (midway-merge paper, eq. 31).

Parameters
----------
motion : SE3
    T_camera(k-1)_camera(k).
q : array_like, shape (6, 6)
    Noise of the step, right perturbation, camera frame.
)";

constexpr const char* kUpdateDoc =
    R"(Every hypothesis gets a child per noise component, is updated, and all are reduced.

Raises
------
ValueError
    For a detection of the camera, of a pose that does not exist or of one named twice, when a pose
    has 3e6 times the standard deviation of a noise, and when joint use finds detectors whose
    components differ in number or weight.
)";

using Prior = std::variant<Posterior, ConcentratedStack, Mixture<ConcentratedSE3>, ConcentratedSE3>;

Component<ConcentratedStack> stacked(double log_weight, const ConcentratedSE3& density) {
  return {log_weight, ConcentratedStack(PoseStackd({density.mean()}), density.covariance())};
}

/// Converts a prior to a joint mixture; a prior of one pose becomes a mixture over the camera
/// alone.
struct AsPosterior {
  Posterior operator()(const Posterior& prior) const { return prior; }
  Posterior operator()(const ConcentratedStack& prior) const {
    return Posterior::from_stored({{0.0, prior}});
  }
  Posterior operator()(const ConcentratedSE3& prior) const {
    return Posterior::from_stored({stacked(0.0, prior)});
  }
  Posterior operator()(const Mixture<ConcentratedSE3>& prior) const {
    std::vector<Component<ConcentratedStack>> components;
    for (const auto& component : prior.components())
      components.push_back(stacked(component.log_weight, component.density));
    return Posterior::from_stored(std::move(components));
  }
};

UpdateReport update(GaussianSumFilter& filter, const std::vector<OwnedDetection>& owned) {
  std::vector<Detection> detections;
  for (const OwnedDetection& d : owned) detections.push_back({d.object, d.camera_object, &d.noise});
  return filter.update(detections);
}

void bind_predictions(nb::class_<GaussianSumFilter>& filter) {
  using F = GaussianSumFilter;
  filter
      .def(
          "predict",
          [](F& self, const std::function<Hypothesis(Hypothesis)>& motion) {
            self.predict(motion);
          },
          "motion"_a, "Moves every hypothesis by a function of its own.")
      .def(
          "predict_with_odometry",
          [](F& self, const Argument<SE3d>& given, const ArrayLike& q) {
            const SE3d motion = given.as("motion");
            const auto noise = q.as<Matrix6d>("q");
            self.predict(
                [&](Hypothesis h) { return predict_with_odometry(std::move(h), motion, noise); });
          },
          "motion"_a, "q"_a, kOdometryDoc)
      .def(
          "predict_random_walk",
          [](F& self, const ArrayLike& q) {
            const auto noise = q.as<Matrix6d>("q");
            self.predict([&](Hypothesis h) { return predict_random_walk(std::move(h), noise); });
          },
          "q"_a, "Predicts without odometry: the mean stays.")
      .def(
          "predict_constant_velocity",
          [](F& self, double periods, const ArrayLike& q, const ArrayLike& q_motion) {
            const auto noise = q.as<Matrix6d>("q");
            const auto motion_noise = q_motion.as<Matrix6d>("q_motion");
            self.predict([&](Hypothesis h) {
              return predict_constant_velocity(std::move(h), periods, noise, motion_noise);
            });
          },
          "periods"_a, "q"_a, "q_motion"_a,
          "Constant velocity; pose 1 is the camera's motion per reference period.");
}

void bind_filter(nb::module_& m) {
  using F = GaussianSumFilter;
  nb::class_<F> filter(m, "GaussianSumFilter", kFilterDoc);
  filter.def(
      "__init__",
      [](F* self, const Argument<Prior>& given,
         const std::optional<GaussianSumSettings>& settings) {
        const Prior prior = given.as("prior", "a ConcentratedGaussian over poses, or a Mixture");
        new (self) F(std::visit(AsPosterior{}, prior), settings.value_or(GaussianSumSettings{}));
      },
      "prior"_a, "settings"_a = nb::none());
  bind_predictions(filter);
  filter.def("update", &update, "detections"_a, kUpdateDoc)
      .def(
          "add_object",
          [](F& self, const Argument<SE3d>& pose, const DetectorNoise& noise) {
            return self.add_object(pose.as("camera_object"), noise);
          },
          "camera_object"_a, "noise"_a,
          "A new object with its full cross-covariance; the index of its pose.")
      .def(
          "add_independent_object",
          [](F& self, const Argument<SE3d>& pose, const ArrayLike& covariance) {
            return self.add_independent_object(pose.as("camera_object"),
                                               covariance.as<Matrix6d>("covariance"));
          },
          "camera_object"_a, "covariance"_a,
          "A new object with an error independent of all others (world frame); its index.")
      .def_prop_ro(
          "posterior", [](const F& self) { return Posterior(self.posterior()); },
          "The joint mixture over the camera and all objects.")
      .def_prop_ro(
          "settings", [](const F& self) { return frozen(self.settings()); },
          nb::for_getter(nb::sig("def settings(self, /) -> GaussianSumSettings")),
          "A copy of the settings, which cannot be changed.")
      .def("summarise", &F::summarise, "The Gaussian that stands for the posterior.")
      .def("__reduce__",
           [](const F& self) {
             return nb::make_tuple(nb::type<F>(),
                                   nb::make_tuple(Posterior(self.posterior()), self.settings()));
           })
      .def("__repr__", [](const F& self) {
        return fmt::format("<GaussianSumFilter of {} hypotheses over {} poses>",
                           self.posterior().size(), self.posterior()[0].density.mean().size());
      });
}

}  // namespace

void bind_gaussian_sum_filter(nb::module_& m) {
  bind_enums(m);
  bind_filter_settings(m);
  bind_results(m);
  bind_filter(m);
}

}  // namespace posemix::python
