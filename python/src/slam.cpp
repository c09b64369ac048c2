// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "slam.hpp"

#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>

#include "posemix/slam/smoothing.hpp"
#include "settings.hpp"

namespace posemix::python {

nb::dict report_dict(const FrameReport& report) {
  nb::dict dict;
  dict["statuses"] = report.statuses;
  dict["candidates"] = list_of(report.candidates, [](const CandidateReport& candidate) {
    return nb::make_tuple(candidate.status, candidate.object, candidate.recycled);
  });
  dict["update"] = report.update;
  dict["merges"] = report.merges;
  dict["seconds"] = report.seconds;
  return dict;
}

namespace {

using CandidateRow = std::tuple<std::string, SE3d, double>;

std::vector<Candidate> candidates_of(const std::vector<CandidateRow>& rows) {
  std::vector<Candidate> all;
  for (const auto& [class_id, pose, score] : rows) all.push_back({class_id, pose, score});
  return all;
}

FrameInput input_of(double dt, const std::optional<SE3d>& odometry, const Rows& detections,
                    const std::vector<CandidateRow>& candidates) {
  return {dt, odometry, maybe_poses(detections, "detections"), candidates_of(candidates)};
}

nb::object maybe_estimate(const std::optional<FrameEstimate>& estimate) {
  return estimate ? nb::object(estimate_dict(*estimate)) : nb::object(nb::none());
}

void bind_object_slam(nb::module_& m) {
  using S = ObjectSlam;
  nb::class_<S>(m, "ObjectSlam")
      .def(nb::init<const ConcentratedSE3&, std::vector<ObjectModel>, const ObjectSlamSettings&>())
      .def("start",
           [](S& self, const Rows& detections, const std::vector<CandidateRow>& candidates) {
             return report_dict(
                 self.start(maybe_poses(detections, "detections"), candidates_of(candidates)));
           })
      .def(
          "step",
          [](S& self, double dt, const std::optional<SE3d>& odometry, const Rows& detections,
             const std::vector<CandidateRow>& candidates) {
            return report_dict(self.step(input_of(dt, odometry, detections, candidates)));
          },
          "dt"_a, "odometry"_a.none(), "detections"_a, "candidates"_a)
      .def("posterior", &S::posterior)
      .def("estimate", [](const S& self) { return self.estimate(); })
      .def("pose_index", &S::pose_index)
      .def("multi_object",
           [](const S& self) -> std::optional<MultiObjectFilter> {
             if (self.multi_object() == nullptr) return std::nullopt;
             return *self.multi_object();
           })
      .def("objects", [](const S& self) { return self.objects(); })
      .def("detections", &S::detections)
      .def("copy", [](const S& self) { return S(self); });
}

void bind_smoother(nb::module_& m) {
  using S = FixedLagSmoother;
  nb::class_<S>(m, "FixedLagSmoother")
      .def(nb::init<const ConcentratedSE3&, std::vector<ObjectModel>, const ObjectSlamSettings&,
                    const SmoothingSettings&, bool>())
      .def("start",
           [](S& self, const Rows& detections) {
             return maybe_estimate(self.start(maybe_poses(detections, "detections")));
           })
      .def(
          "step",
          [](S& self, double dt, const std::optional<SE3d>& odometry, const Rows& detections,
             const std::vector<CandidateRow>& candidates) {
            return maybe_estimate(self.step(input_of(dt, odometry, detections, candidates)));
          },
          "dt"_a, "odometry"_a.none(), "detections"_a, "candidates"_a)
      .def("finish",
           [](S& self) {
             return list_of(self.finish(), [](const FrameEstimate& e) { return estimate_dict(e); });
           })
      .def("copy", [](const S& self) { return S(self); })
      .def("slam", [](const S& self) { return ObjectSlam(self.slam()); })
      .def("joint", [](const S& self) { return self.joint(); });
}

void bind_association_functions(nb::module_& m) {
  m.def("associate", [](const std::vector<ConcentratedSE3>& instances,
                        const std::vector<CandidateRow>& rows, const NoiseComponent& noise,
                        const SymmetryGroup& symmetries, const AssociationSettings& settings) {
    const std::vector<Candidate> candidates = candidates_of(rows);
    return list_of(associate(instances, candidates, noise, symmetries, settings),
                   [](const Association& a) {
                     return nb::make_tuple(a.status, a.instance, a.camera_object, a.cost);
                   });
  });
  m.def("least_cost_assignment",
        [](const Eigen::MatrixXd& cost) { return least_cost_assignment(cost); });
}

}  // namespace

void bind_slam(nb::module_& m) {
  bind_object_slam(m);
  bind_smoother(m);
  bind_association_functions(m);
}

}  // namespace posemix::python
