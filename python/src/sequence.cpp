// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/sequence.hpp"

#include <limits>

#include <fmt/ranges.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "record.hpp"
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

constexpr const char* kMaybePoses = "posemix.lie.SE3 | None";

std::string names_of(const Sequence& sequence) {
  std::vector<std::string> names;
  for (const ObjectRecording& object : sequence.objects) names.push_back(object.id);
  return names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "));
}

void bind_recordings(nb::module_& m) {
  using C = Candidate;
  Record<C>(m, "Candidate", "A detection that names the class of the object but not the instance.")
      .field("class_id", &C::class_id, "str", "The class.")
      .field("camera_object", &C::camera_object, "posemix.lie.SE3", "T_camera_object as detected.")
      .field("score", &C::score, "float", "Confidence of the detector; larger is more certain.")
      .constructible(2)
      .done();
  using O = ObjectRecording;
  Record<O>(m, "ObjectRecording", "The recording of one object.")
      .field("id", &O::id, "str", "Name of the object.")
      .field("detections", &O::detections, "posemix.lie.SE3",
             "Shape (n,): T_camera_object by the detector, NaN where it was not detected; see "
             "`with_misses`.")
      .field("relative_truth", &O::relative_truth, kMaybePoses, "Shape (n,): true T_camera_object.")
      .field("world_truth", &O::world_truth, kMaybePoses, "Shape (n,): true T_world_object.")
      .shown_as([](const O& self) {
        const auto known = [](const std::optional<SE3d>& pose) { return pose.has_value(); };
        return fmt::format("<ObjectRecording '{}', {} detections in {} frames>", self.id,
                           std::ranges::count_if(self.detections, known), self.detections.size());
      })
      .constructible(2)
      .done();
}

constexpr const char* kSequenceMore = R"(
Raises
------
ValueError
    When there is no frame, stamps do not increase, an array has the wrong length, two objects share
    an id, or a pose is not finite.

Examples
--------
>>> import numpy as np
>>> from posemix import SE3, ObjectRecording, Sequence
>>> still = SE3.identity((5,))
>>> Sequence(np.arange(5), still, objects=[ObjectRecording("mug", still)])
<Sequence of 5 frames over 4 s, objects mug>
)";

}  // namespace

void bind_sequence(nb::module_& m) {
  bind_recordings(m);
  using S = Sequence;
  Record<S>(
      m, "Sequence",
      "A recording. Arrays over frames have one entry per stamp, NaN in frames without a pose.")
      .field<NumbersAsArray>("stamps", &S::stamps, kFloatArray,
                             "Shape (n,), strictly increasing [s].")
      .field("odometry", &S::odometry, kMaybePoses, "Shape (n,): T_odom_camera.")
      .field("camera_truth", &S::camera_truth, kMaybePoses, "Shape (n,): true T_world_camera.")
      .field("objects", &S::objects, "collections.abc.Sequence[ObjectRecording]",
             "Recordings of the objects.")
      .field("candidates", &S::candidates,
             "collections.abc.Sequence[collections.abc.Sequence[Candidate]]",
             "Detections that name only the class, per frame; none unless given.")
      .field("observations", &S::observations,
             "collections.abc.Sequence[collections.abc.Sequence[Observation]]",
             "Detections that are mixtures, per frame; the multi-object filter uses them in place "
             "of the detections of all objects. None unless given.")
      .field("images", &S::images, "collections.abc.Sequence[collections.abc.Sequence[str]]",
             "Per frame, names of cameras whose images the detectors have searched, also where "
             "they found nothing (\"\" for the only camera). None unless given: which images there "
             "are is then not known, but for those with detections.")
      .shown_as([](const S& self) {
        return fmt::format("<Sequence of {} frames over {:.6g} s, objects {}>", self.stamps.size(),
                           self.stamps.back() - self.stamps.front(), names_of(self));
      })
      .constructible(1, &validate)
      .done(kSequenceMore)
      .def("__len__", [](const S& self) { return self.stamps.size(); });
}

}  // namespace posemix::python
