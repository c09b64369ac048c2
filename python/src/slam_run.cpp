// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <chrono>
#include <limits>
#include <utility>

#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>

#include "posemix/slam/smoothing.hpp"
#include "settings.hpp"
#include "slam.hpp"

namespace posemix::python {

std::function<bool(std::size_t, std::size_t)> progress_of(const nb::object& progress) {
  using Clock = std::chrono::steady_clock;
  const auto wants_frames = !progress.is_none();
  return [&progress, wants_frames, last = Clock::now()](std::size_t done, std::size_t all) mutable {
    const Clock::time_point now = Clock::now();
    if (!wants_frames && now - last < std::chrono::milliseconds(50)) return true;
    last = now;
    const nb::gil_scoped_acquire locked;
    if (PyErr_CheckSignals() != 0) throw nb::python_error();
    return !wants_frames || !progress(done, all).is(nb::bool_(false));
  };
}

namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// Means and covariances of one pose over the frames; NaN for frames in which it is not known.
template <class Pick>
nb::tuple track(const SlamRun& run, Pick pick) {
  const std::size_t n = run.frames.size();
  NewArray means({n, 7});
  NewArray covariances({n, 6, 6});
  std::fill(means.data, means.data + 7 * n, kUnknown);
  std::fill(covariances.data, covariances.data + 36 * n, kUnknown);
  for (std::size_t i = 0; i < n; ++i) {
    const PoseDensity* const density = pick(run.frames[i]);
    if (density == nullptr) continue;
    Wire<SE3d>::write(density->mean(), means.data + 7 * i);
    Eigen::Map<Matrix6d>(covariances.data + 36 * i) = density->covariance();
  }
  return nb::make_tuple(std::move(means.array), std::move(covariances.array));
}

const PoseDensity* at(const std::vector<std::optional<PoseDensity>>& densities, std::size_t j) {
  return j < densities.size() && densities[j] ? &*densities[j] : nullptr;
}

template <class Value>
Array over_frames(const SlamRun& run, Value value) {
  NewArray out({run.frames.size()});
  for (std::size_t i = 0; i < run.frames.size(); ++i) out.data[i] = value(run.frames[i]);
  return std::move(out.array);
}

void bind_run_class(nb::module_& m) {
  nb::class_<SlamRun>(m, "SlamRun")
      .def("__len__", [](const SlamRun& self) { return self.frames.size(); })
      .def("camera",
           [](const SlamRun& self) {
             return track(self, [](const FrameEstimate& frame) { return &frame.camera; });
           })
      .def("object",
           [](const SlamRun& self, std::size_t j) {
             return track(self, [&](const FrameEstimate& frame) { return at(frame.objects, j); });
           })
      .def("relative",
           [](const SlamRun& self, std::size_t j) {
             return track(self, [&](const FrameEstimate& frame) { return at(frame.relative, j); });
           })
      .def("mode_probabilities",
           [](const SlamRun& self, std::size_t j) {
             return over_frames(self, [&](const FrameEstimate& frame) {
               const auto& all = frame.mode_probabilities;
               return j < all.size() ? all[j].value_or(kUnknown) : kUnknown;
             });
           })
      .def("seconds",
           [](const SlamRun& self) {
             return over_frames(self, [](const FrameEstimate& f) { return f.report.seconds; });
           })
      .def("frame",
           [](const SlamRun& self, std::size_t i) {
             if (i >= self.frames.size()) throw nb::index_error();
             return self.frames[i];
           })
      .def("posterior", [](const SlamRun& self) { return self.posterior; })
      .def("pose_indices", [](const SlamRun& self) { return self.pose_indices; })
      .def("alternatives", [](const SlamRun& self) { return self.alternatives; });
}

template <class Run>
SlamRun without_lock(bool record, const nb::object& progress, Run run) {
  RunOptions options{.record_hypotheses = record, .progress = progress_of(progress)};
  const nb::gil_scoped_release unlocked;
  return run(options);
}

void bind_run_functions(nb::module_& m) {
  using Models = std::vector<ObjectModel>;
  m.def(
      "run",
      [](const Sequence& sequence, const PoseDensity& prior, const Models& models,
         const ObjectSlamSettings& settings, bool record, const nb::object& progress) {
        return without_lock(record, progress, [&](const RunOptions& options) {
          return run(sequence, prior, models, settings, options);
        });
      },
      "sequence"_a, "prior"_a, "models"_a, "settings"_a, "record"_a, "progress"_a.none());
  m.def(
      "run_smoothed",
      [](const Sequence& sequence, const PoseDensity& prior, const Models& models,
         const ObjectSlamSettings& settings, const SmoothingSettings& smoothing, bool record,
         const nb::object& progress) {
        return without_lock(record, progress, [&](const RunOptions& options) {
          return run_smoothed(sequence, prior, models, settings, smoothing, options);
        });
      },
      "sequence"_a, "prior"_a, "models"_a, "settings"_a, "smoothing"_a, "record"_a,
      "progress"_a.none());
}

}  // namespace

void bind_slam_run(nb::module_& m) {
  bind_run_class(m);
  bind_run_functions(m);
}

}  // namespace posemix::python
