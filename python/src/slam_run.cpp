// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <chrono>

#include <nanobind/stl/string.h>
#include <nanobind/stl/variant.h>

#include "posemix/slam/job.hpp"
#include "posemix/slam/smoothing.hpp"
#include "record.hpp"
#include "run_objects.hpp"

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

/// One pose over the frames, NaN where it is not known: a PoseTrack.
template <class Pick>
nb::object track(const RecordedRun& run, Pick pick) {
  const std::size_t n = run.frames.size();
  MaybePoses means(n);
  NewArray covariances({n, 6, 6});
  std::fill(covariances.data, covariances.data + 36 * n, kUnknown);
  for (std::size_t i = 0; i < n; ++i) {
    const PoseDensity* const density = pick(run.frames[i]);
    if (density == nullptr) continue;
    means[i] = density->mean();
    Eigen::Map<Matrix6d>(covariances.data + 36 * i) = density->covariance();
  }
  const nb::object made = nb::module_::import_("posemix.runs").attr("PoseTrack");
  return made(PoseArray::of(rows_of(means), {n}), std::move(covariances.array));
}

const PoseDensity* at(const std::vector<std::optional<PoseDensity>>& densities, std::size_t j) {
  return j < densities.size() && densities[j] ? &*densities[j] : nullptr;
}

FrameEstimate frame_at(const RecordedRun& run, std::ptrdiff_t frame) {
  const std::ptrdiff_t n = std::ssize(run.frames);
  const std::ptrdiff_t at = frame < 0 ? frame + n : frame;
  if (at < 0 || at >= n)
    throw nb::index_error(fmt::format("there is no frame {} of {}", frame, n).c_str());
  return run.frames[static_cast<std::size_t>(at)];
}

std::string ids_text(const RecordedRun& run) {
  return run.ids.empty() ? "none" : fmt::format("{}", fmt::join(run.ids, ", "));
}

constexpr const char* kRunDoc =
    R"(The result of `run`. ``run[i]`` is the `FrameEstimate` of frame i.

A run that a progress callback stopped is shorter than the recording.
)";

constexpr const char* kTrackSignature = "(self, object: int | str) -> posemix.runs.PoseTrack";

void bind_tracks(nb::class_<RecordedRun>& run) {
  using R = RecordedRun;
  using Frame = FrameEstimate;
  const auto tracked = [&](const char* name, auto member, const char* text) {
    run.def(name, of_object([member](const R& self, std::size_t j) {
              return track(self, [&](const Frame& frame) { return at(frame.*member, j); });
            }),
            "object"_a, nb::sig(kept(fmt::format("def {}{}", name, kTrackSignature))), text);
  };
  run.def_prop_ro(
      "camera",
      [](const R& self) { return track(self, [](const Frame& frame) { return &frame.camera; }); },
      nb::for_getter(nb::sig("def camera(self, /) -> posemix.runs.PoseTrack")), "T_world_camera.");
  tracked("object", &Frame::objects,
          "T_world_object over the frames, of an object by index or id.");
  tracked("relative", &Frame::relative, "T_camera_object, with the cross-covariance.");
  run.def("mode_probabilities", of_object([](const R& self, std::size_t j) {
            return over_frames(self, [&](const Frame& frame) {
              const auto& all = frame.mode_probabilities;
              return j < all.size() ? all[j].value_or(kUnknown) : kUnknown;
            });
          }),
          "object"_a,
          "Probability that the estimate is on the right mode, shape (n,); NaN if unknown.");
}

void bind_run_class(nb::module_& m) {
  using R = RecordedRun;
  nb::class_<R> run(m, "SlamRun", kRunDoc);
  bind_tracks(run);
  bind_run_health(run);
  run.def("__len__", [](const R& self) { return self.frames.size(); })
      .def("__getitem__", &frame_at, "frame"_a)
      .def(
          "__iter__", [](nb::handle self) { return nb::steal(PySeqIter_New(self.ptr())); },
          nb::sig("def __iter__(self) -> collections.abc.Iterator[FrameEstimate]"))
      .def_prop_ro(
          "frames", [](const R& self) { return self.frames; },
          "The estimates of all frames; `camera`, `object` and `relative` are faster.")
      .def_prop_ro(
          "stamps", [](const R& self) { return NumbersAsArray::get(self.stamps); },
          nb::for_getter(nb::sig(kept(fmt::format("def stamps(self, /) -> {}", kFloatArray)))),
          "Times of the frames, shape (n,) [s].")
      .def_prop_ro(
          "ids", [](const R& self) { return self.ids; }, "Ids of the objects.")
      .def_prop_ro(
          "seconds",
          [](const R& self) {
            return over_frames(self, [](const FrameEstimate& f) { return f.report.seconds; });
          },
          nb::rv_policy::move, "Time taken per frame, shape (n,) [s].")
      .def_prop_ro(
          "posterior", [](const R& self) { return self.posterior; },
          "The joint posterior of the last frame.")
      .def_prop_ro(
          "pose_indices", [](const R& self) { return self.pose_indices; },
          "Index of every object's pose in the posterior.")
      .def("hypotheses", of_object([](const R& self, std::size_t j) {
             return j < self.hypotheses.size() ? self.hypotheses[j]
                                               : std::vector<ObjectHypothesis>();
           }),
           "object"_a,
           "Hypotheses of an object, by index or id, at the last frame, with the multi-object "
           "filter; none with another.")
      .def_prop_ro(
          "cameras", [](const R& self) { return frozen(self.cameras); },
          nb::for_getter(nb::sig("def cameras(self, /) -> collections.abc.Sequence[BodyCamera]")),
          "Cameras of a rig as they are known at the last frame, with the multi-object filter.")
      .def_prop_ro(
          "alternatives",
          [](const R& self) {
            if (PyErr_WarnEx(PyExc_DeprecationWarning,
                             "SlamRun.alternatives is now SlamRun.hypotheses(object)", 1) != 0)
              throw nb::python_error();
            return self.hypotheses;
          },
          "The old name of `hypotheses`, a list of the hypotheses of every object.")
      .def("__copy__", [](const nb::object& self) { return self; })
      .def("__deepcopy__", [](const nb::object& self, const nb::dict& /*memo*/) { return self; })
      .def(
          "_repr_html_",
          [](const nb::object& self) {
            return nb::module_::import_("posemix.runs").attr("run_html")(self);
          },
          nb::sig("def _repr_html_(self) -> str"),
          "A table of the last frame's estimates, for notebooks.")
      .def("__repr__", [](const R& self) {
        return fmt::format("<SlamRun of {} frames, objects {}>", self.frames.size(),
                           ids_text(self));
      });
}

/// What a run starts from, taken from its arguments.
struct Recorded {
  Sequence sequence;
  PoseDensity prior;
  Models models;

  Recorded(const Argument<Sequence>& recording, const Argument<PoseDensity>& camera,
           const Argument<Models>& objects)
      : sequence(recording.as("sequence", "a Sequence or a SlamJob")),
        prior(camera.as("camera_prior", kOneDensity)),
        models(models_of(objects, "models")) {}
};

template <class Run>
RecordedRun recorded(const Sequence& sequence, bool record, const nb::object& progress, Run run) {
  const RunOptions options{.record_hypotheses = record, .progress = progress_of(progress)};
  const nb::gil_scoped_release unlocked;
  RecordedRun done{run(options)};
  done.stamps.assign(sequence.stamps.begin(), sequence.stamps.begin() + std::ssize(done.frames));
  for (const ObjectRecording& object : sequence.objects) done.ids.push_back(object.id);
  return done;
}

constexpr const char* kRunSmoothedSignature =
    "def run_smoothed(sequence: Sequence, "
    "camera_prior: posemix.density.ConcentratedGaussian[posemix.lie.SE3], "
    "models: collections.abc.Sequence[ObjectModel], smoothing: SmoothingSettings | None = None, "
    "settings: ObjectSlamSettings | None = None, *, record_hypotheses: bool = False, "
    "progress: collections.abc.Callable[[int, int], bool | None] | None = None) -> SlamRun";

constexpr const char* kRunSmoothedDoc =
    R"(Runs object SLAM with smoothed estimates, which use later frames too.

Parameters
----------
sequence, camera_prior, models, settings, record_hypotheses, progress
    As for `run`.
smoothing : SmoothingSettings, optional
    Number of frames that the smoother looks ahead; to the end unless given.

Raises
------
ValueError
    As for `run` and `FixedLagSmoother`.
)";

void bind_run_functions(nb::module_& m) {
  m.def(
      "run_job",
      [](const SlamJob& job, bool record, const nb::object& progress) {
        return recorded(job.sequence, record, progress,
                        [&](const RunOptions& options) { return run(job, options); });
      },
      "job"_a, "record"_a, "progress"_a.none());
  m.def(
      "run",
      [](const Argument<Sequence>& sequence, const Argument<PoseDensity>& prior,
         const Argument<Models>& models, const std::optional<ObjectSlamSettings>& settings,
         bool record, const nb::object& progress) {
        const Recorded given(sequence, prior, models);
        return recorded(given.sequence, record, progress, [&](const RunOptions& options) {
          return run(given.sequence, given.prior, given.models,
                     settings.value_or(ObjectSlamSettings{}), options);
        });
      },
      "sequence"_a, "prior"_a, "models"_a, "settings"_a.none(), "record"_a, "progress"_a.none());
  m.def(
      "run_smoothed",
      [](const Argument<Sequence>& sequence, const Argument<PoseDensity>& prior,
         const Argument<Models>& models, const std::optional<SmoothingSettings>& smoothing,
         const std::optional<ObjectSlamSettings>& settings, bool record,
         const nb::object& progress) {
        const Recorded given(sequence, prior, models);
        return recorded(given.sequence, record, progress, [&](const RunOptions& options) {
          return run_smoothed(given.sequence, given.prior, given.models,
                              settings.value_or(ObjectSlamSettings{}),
                              smoothing.value_or(SmoothingSettings{}), options);
        });
      },
      "sequence"_a, "camera_prior"_a, "models"_a, "smoothing"_a = nb::none(),
      "settings"_a = nb::none(), nb::kw_only(), "record_hypotheses"_a = false,
      "progress"_a = nb::none(), nb::sig(kRunSmoothedSignature), kRunSmoothedDoc);
}

}  // namespace

void bind_slam_run(nb::module_& m) {
  bind_run_class(m);
  bind_run_functions(m);
}

}  // namespace posemix::python
