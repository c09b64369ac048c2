// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "frame_input.hpp"

#include <fmt/ranges.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/string.h>

#include "record.hpp"

namespace posemix::python {

FrameInput NamedInput::of(const std::vector<ObjectModel>& models) const {
  if (const auto* poses = std::get_if<MaybePoses>(&detections))
    return {dt, motion, *poses, candidates, observations, images, camera, frames};
  std::map<std::string, SE3d> left = std::get<0>(detections);
  // An entry for every object is an image, even where it shows none.
  if (left.empty()) return {dt, motion, {}, candidates, observations, images, camera, frames};
  MaybePoses poses;
  std::vector<std::string> ids;
  for (const ObjectModel& model : models) {
    const auto found = left.find(model.id);
    poses.push_back(found == left.end() ? std::nullopt : std::optional(found->second));
    if (found != left.end()) left.erase(found);
    ids.push_back(model.id);
  }
  if (!left.empty()) {
    throw InvalidInput(fmt::format("no object is called '{}'; expected one of {}",
                                   left.begin()->first, fmt::join(ids, ", ")));
  }
  return {dt, motion, std::move(poses), candidates, observations, images, camera, frames};
}

template <>
struct SettingValue<Detections> {
  static nb::object get(const Detections& value) {
    if (const auto* by_id = std::get_if<0>(&value)) return nb::cast(*by_id);
    return PoseArray::of(rows_of(std::get<1>(value)), {std::get<1>(value).size()}).made;
  }
  static Detections set(nb::handle value, const std::string& name) {
    if (!nb::hasattr(value, "keys")) return SettingValue<MaybePoses>::set(value, name);
    std::map<std::string, SE3d> by_id;
    for (const nb::handle key : value.attr("keys")()) {
      const auto id = nb::cast<std::string>(key);
      by_id.emplace(id, pose_of(nb::object(value[key]), fmt::format("{}['{}']", name, id)));
    }
    return by_id;
  }
  static nb::object frozen(const Detections& value) { return get(value); }
  static bool same(const Detections& a, const Detections& b) {
    return text(a) == text(b) && get(a).type().is(get(b).type());
  }
  static std::string text(const Detections& value) { return nb::repr(get(value)).c_str(); }
};

void bind_frame_input(nb::module_& m) {
  using N = NamedInput;
  Record<N>(m, "FrameInput",
            "Input of one frame. In the first frame `dt` and `motion` are ignored.")
      .field("dt", &N::dt, "float", "Time since the last frame, positive [s].")
      .field("motion", &N::motion, "posemix.lie.SE3 | None",
             "T_camera(k-1)_camera(k), from odometry.")
      .field(
          "detections", &N::detections,
          "collections.abc.Sequence[posemix.lie.SE3 | None] | "
          "collections.abc.Mapping[str, posemix.lie.SE3] | posemix.lie.SE3",
          "T_camera_object, one entry per object model; a mapping from ids holds those that were "
          "detected, and an empty one says nothing of an image.")
      .field("candidates", &N::candidates, "collections.abc.Sequence[Candidate]",
             "Detections that name a class, for the multi-object filter.")
      .field("observations", &N::observations, "collections.abc.Sequence[Observation]",
             "Detections that are mixtures, of an object model or of a class, for the multi-object "
             "filter; their stamps are not looked at.")
      .field(
          "images", &N::images, "collections.abc.Sequence[str]",
          "Names of cameras whose images show none of the objects, next to those of observations "
          "and candidates: what is in view and is not detected may be gone.")
      .field("camera", &N::camera, "posemix.lie.SE3 | None",
             "T_world_camera as it is given, for `MotionModel.given`.")
      .field("frames", &N::frames, "collections.abc.Sequence[KnownFrame | None]",
             "T_world_frame of the frames that may hold objects, in the order of the settings, or "
             "none at all; None: where it was.")
      .constructible(0)
      .done();
}

}  // namespace posemix::python
