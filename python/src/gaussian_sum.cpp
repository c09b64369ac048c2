// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "filter.hpp"

#include <nanobind/stl/function.h>

#include "posemix/filter/predict.hpp"
#include "settings.hpp"

namespace posemix::python {
namespace {

void bind_enums(nb::module_& m) {
  nb::enum_<NoiseUse>(m, "NoiseUse", "How noise components are combined over the objects seen.")
      .value("joint", NoiseUse::joint, "One for all visible objects (the midway paper's filter).")
      .value("per_object", NoiseUse::per_object, "One for every object, one after another.")
      .value("most_likely", NoiseUse::most_likely,
             "The same, but a hypothesis keeps only the likeliest child (max-mixture).");
  nb::enum_<UpdateRule>(m, "UpdateRule", "How one hypothesis is updated.")
      .value("linearized", UpdateRule::linearized, "Once, at the prior mean.")
      .value("iterated", UpdateRule::iterated,
             "By iteration; consistent when the odometry is bad against the detector.");
  nb::enum_<RobustLoss>(m, "RobustLoss", "The loss by which a hypothesis is updated.")
      .value("none", RobustLoss::none, "The squared Mahalanobis distance.")
      .value("cauchy", RobustLoss::cauchy, "c^2 log(1 + d^2 / c^2).");
  nb::enum_<Summary>(m, "Summary", "What is reported as the estimate.")
      .value("best", Summary::best, "The hypothesis of the largest weight.")
      .value("merge_two_largest", Summary::merge_two_largest,
             "The merge of the two largest weights (the midway paper's).")
      .value("whole_mixture", Summary::whole_mixture, "The merge of all hypotheses.");
}

void bind_filter_settings(nb::module_& m) {
  using S = GaussianSumSettings;
  Settings<S>(m, "GaussianSumSettings", "Settings of `GaussianSumFilter`.")
      .field("noise_use", &S::noise_use, "NoiseUse", "How noise components are combined.")
      .field("update", &S::update, "UpdateRule", "How one hypothesis is updated.")
      .field("robust_loss", &S::robust_loss, "RobustLoss", "By which it is updated.")
      .field("cauchy_scale", &S::cauchy_scale, "float",
             "Of RobustLoss.cauchy, standard deviations.")
      .field("gate_probability", &S::gate_probability, "float",
             "Quantile beyond which a detection is left out (chi-square, 6); 1: no gate.")
      .field("summary", &S::summary, "Summary", "What is reported.")
      .field("reduction", &S::reduction, "ReductionSettings", "Of the hypotheses.")
      .field("first_object", &S::first_object, "int",
             "Index of the first object's pose: 2 where the motion is part of the state.")
      .done();
}

UpdateReport update(GaussianSumFilter& filter, const std::vector<std::size_t>& objects,
                    const PoseArray& poses, const std::vector<DetectorNoise>& noise) {
  if (objects.size() != poses.size() || objects.size() != noise.size()) {
    throw InvalidInput(fmt::format("{} objects, {} poses and {} noises; expected as many of each",
                                   objects.size(), poses.size(), noise.size()));
  }
  std::vector<Detection> detections;
  for (std::size_t i = 0; i < objects.size(); ++i)
    detections.push_back({objects[i], poses[i], &noise[i]});
  return filter.update(detections);
}

void bind_predictions(nb::class_<GaussianSumFilter>& filter) {
  using F = GaussianSumFilter;
  filter
      .def("predict",
           [](F& self, const std::function<Hypothesis(Hypothesis)>& motion) {
             self.predict(motion);
           })
      .def("predict_with_odometry",
           [](F& self, const SE3d& motion, const Matrix6d& q) {
             self.predict(
                 [&](Hypothesis h) { return predict_with_odometry(std::move(h), motion, q); });
           })
      .def("predict_random_walk",
           [](F& self, const Matrix6d& q) {
             self.predict([&](Hypothesis h) { return predict_random_walk(std::move(h), q); });
           })
      .def("predict_constant_velocity",
           [](F& self, double periods, const Matrix6d& q, const Matrix6d& q_motion) {
             self.predict([&](Hypothesis h) {
               return predict_constant_velocity(std::move(h), periods, q, q_motion);
             });
           });
}

void bind_filter(nb::module_& m) {
  using F = GaussianSumFilter;
  nb::class_<F> filter(m, "GaussianSumFilter");
  filter.def(nb::init<Posterior, GaussianSumSettings>());
  bind_predictions(filter);
  filter
      .def("update",
           [](F& self, const std::vector<std::size_t>& objects, const PoseArray& poses,
              const std::vector<DetectorNoise>& noise) {
             return report_dict(update(self, objects, poses, noise));
           })
      .def("add_object", [](F& self, const SE3d& pose,
                            const DetectorNoise& noise) { return self.add_object(pose, noise); })
      .def("add_independent_object",
           [](F& self, const SE3d& pose, const Matrix6d& covariance) {
             return self.add_independent_object(pose, covariance);
           })
      .def("posterior", [](const F& self) { return self.posterior(); })
      .def("settings", [](const F& self) { return self.settings(); })
      .def("summarise", &F::summarise);
}

}  // namespace

void bind_gaussian_sum_filter(nb::module_& m) {
  bind_enums(m);
  bind_filter_settings(m);
  bind_filter(m);
}

}  // namespace posemix::python
