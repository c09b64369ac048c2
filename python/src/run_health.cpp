// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <nanobind/stl/string.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include "run_objects.hpp"

namespace posemix::python {
namespace {

/// Rows of `width` numbers per frame, NaN where there are none; no column where no frame has any.
template <class Pick>
Array rows_over_frames(const RecordedRun& run, Pick pick) {
  std::size_t width = 0;
  for (const FrameEstimate& frame : run.frames) width = std::max(width, pick(frame).size());
  NewArray out({run.frames.size(), width});
  for (std::size_t i = 0; i < run.frames.size(); ++i) {
    const std::vector<double> row = pick(run.frames[i]);
    for (std::size_t k = 0; k < width; ++k)
      out.data[i * width + k] = k < row.size() ? row[k] : kUnknown;
  }
  return std::move(out.array);
}

}  // namespace

void bind_run_health(nb::class_<RecordedRun>& run) {
  using R = RecordedRun;
  run.def("existences", of_object([](const R& self, std::size_t j) {
            return over_frames(self, [&](const FrameEstimate& frame) {
              const auto& all = frame.existences;
              return j < all.size() ? all[j].value_or(kUnknown) : kUnknown;
            });
          }),
          "object"_a, "Probability that the object exists, shape (n,); NaN if unknown.");
  run.def("healths", of_object([](const R& self, std::size_t j) {
            std::vector<TrackHealth> all;
            for (const FrameEstimate& frame : self.frames)
              all.push_back(j < frame.healths.size() ? frame.healths[j] : TrackHealth::none);
            return all;
          }),
          "object"_a, "State of the track in every frame.");
  run.def("motion_models", of_object([](const R& self, std::size_t j) {
            return rows_over_frames(self, [&](const FrameEstimate& frame) {
              const auto& all = frame.motion_models;
              return j < all.size() ? all[j] : std::vector<double>();
            });
          }),
          "object"_a,
          "Probability of every model of motion, shape (n, m), m = 0 for an object that does not "
          "move; NaN before it was seen.");
  run.def("twists", of_object([](const R& self, std::size_t j) {
            return rows_over_frames(self, [&](const FrameEstimate& frame) {
              const auto& all = frame.twists;
              if (j >= all.size() || !all[j]) return std::vector<double>();
              return std::vector<double>(all[j]->mean.begin(), all[j]->mean.end());
            });
          }),
          "object"_a,
          "Turning rate [rad/s] and velocity [m/s] along the world's axes, shape (n, 6); NaN "
          "before the object was seen, and no column for an object that does not move.");
}

}  // namespace posemix::python
