// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/sequence.hpp"

#include <cmath>
#include <limits>
#include <tuple>

#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include "slam.hpp"

namespace posemix::python {

MaybePoses maybe_poses(const Rows& rows, const std::string& name) {
  require_columns(rows, 7, name.c_str());
  MaybePoses poses(rows.shape(0));
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Eigen::Map<const Eigen::Matrix<double, 7, 1>> row(rows.data() + 7 * i);
    if (row.array().isNaN().all()) continue;
    if (!row.allFinite()) {
      throw InvalidInput(fmt::format(
          "{}: pose {} is not finite; expected a pose, or NaN throughout for a miss", name, i));
    }
    poses[i] = Wire<SE3d>::read(row.data());
  }
  return poses;
}

Array rows_of(const MaybePoses& poses) {
  NewArray out({poses.size(), 7});
  for (std::size_t i = 0; i < poses.size(); ++i) {
    double* const row = out.data + 7 * i;
    std::fill(row, row + 7, std::numeric_limits<double>::quiet_NaN());
    if (poses[i]) Wire<SE3d>::write(*poses[i], row);
  }
  return std::move(out.array);
}

namespace {

using ObjectRows = std::tuple<std::string, Rows, Rows, Rows>;
using CandidateRow = std::tuple<std::string, SE3d, double>;

Sequence sequence_of(const Numbers& stamps, const Rows& odometry, const Rows& camera_truth,
                     const std::vector<ObjectRows>& objects,
                     const std::vector<std::vector<CandidateRow>>& candidates) {
  Sequence sequence;
  sequence.stamps.assign(stamps.data(), stamps.data() + stamps.shape(0));
  sequence.odometry = maybe_poses(odometry, "odometry");
  sequence.camera_truth = maybe_poses(camera_truth, "camera_truth");
  for (const auto& [id, detections, relative, world] : objects) {
    sequence.objects.push_back({id, maybe_poses(detections, "detections of '" + id + "'"),
                                maybe_poses(relative, "relative_truth of '" + id + "'"),
                                maybe_poses(world, "world_truth of '" + id + "'")});
  }
  for (const auto& frame : candidates) {
    std::vector<Candidate>& all = sequence.candidates.emplace_back();
    for (const auto& [class_id, pose, score] : frame) all.push_back({class_id, pose, score});
  }
  validate(sequence);
  return sequence;
}

nb::tuple parts_of(const Sequence& sequence) {
  NewArray stamps({sequence.stamps.size()});
  std::ranges::copy(sequence.stamps, stamps.data);
  const nb::list objects = list_of(sequence.objects, [](const ObjectRecording& object) {
    return nb::make_tuple(object.id, rows_of(object.detections), rows_of(object.relative_truth),
                          rows_of(object.world_truth));
  });
  const nb::list candidates = list_of(sequence.candidates, [](const std::vector<Candidate>& frame) {
    return list_of(frame, [](const Candidate& c) {
      return nb::make_tuple(c.class_id, c.camera_object, c.score);
    });
  });
  return nb::make_tuple(std::move(stamps.array), rows_of(sequence.odometry),
                        rows_of(sequence.camera_truth), objects, candidates);
}

}  // namespace

void bind_sequence(nb::module_& m) {
  nb::class_<Sequence>(m, "Sequence")
      .def("__init__",
           [](Sequence* self, const Numbers& stamps, const Rows& odometry, const Rows& camera_truth,
              const std::vector<ObjectRows>& objects,
              const std::vector<std::vector<CandidateRow>>& candidates) {
             new (self) Sequence(sequence_of(stamps, odometry, camera_truth, objects, candidates));
           })
      .def("parts", &parts_of);
}

}  // namespace posemix::python
