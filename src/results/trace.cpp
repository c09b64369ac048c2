// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <fmt/format.h>

#include "hypothesis_texts.hpp"
#include "io/json_writer.hpp"
#include "io/sha256.hpp"
#include "posemix/base/error.hpp"
#include "posemix/results/results.hpp"
#include "slam/run_checks.hpp"
#include "trace_track.hpp"
#include "trace_writer.hpp"

namespace posemix {
namespace {

using namespace internal;

Json conventions() {
  return {
      {"pose", "[tx, ty, tz, qx, qy, qz, qw], metres and unit quaternion"},
      {"sd",
       "[rx, ry, rz, tx, ty, tz], radians and metres: square roots of the covariance diagonal of "
       "xi in "
       "X = Exp(xi) X0, in the reference frame"},
      {"position_covariance",
       "[xx, xy, xz, yy, yz, zz], square metres: of the position in the reference frame, to first "
       "order"},
      {"covariance",
       "upper triangle row by row of the covariance of xi = [rotation, translation] in X = Exp(xi) "
       "X0"},
      {"camera", "T_world_camera"},
      {"world", "T_world_object"},
      {"relative", "T_camera_object"},
      {"detection", "T_camera_object"},
      {"hypotheses",
       "poses of the camera, then of the objects in the order of `order`; weights as fractions of "
       "the whole mixture"}};
}

void write_camera(JsonWriter& out, const SlamJob& job, const SlamRun& run) {
  const TraceTrackWriter track(run, ErrorReduction(), job.sequence.camera_truth,
                               [](const FrameEstimate& frame) { return &frame.camera; });
  out.key("camera");
  out.begin_object();
  track.write(out);
  out.end_object();
}

void write_head(JsonWriter& out, const SlamJob& job, const SlamRun& run) {
  out.entry("schema", kTraceSchema);
  out.entry("type", "posemix.trace");
  out.entry("name", job.name);
  out.entry("method", job.method);
  out.entry("conventions", conventions());
  out.entry("frames", run.frames.size());
  const std::vector<double>& stamps = job.sequence.stamps;
  out.array("stamps_s", stamps.size(), [&](std::size_t k) { return Json(stamps[k]); });
  out.array("order", job.models.size(), [&](std::size_t j) { return Json(job.models[j].id); });
}

void write_joint(JsonWriter& out, const SlamJob& job, const SlamRun& run,
                 const HypothesisTexts* hypotheses) {
  if (hypotheses == nullptr) {
    return out.array("hypotheses", run.frames.size(), [&](std::size_t k) {
      return joint_hypotheses_json(run.frames[k], job.trace_hypotheses);
    });
  }
  out.key("hypotheses");
  out.begin_array();
  hypotheses->copy_joint([&](std::string_view text) { out.raw(text); });
  out.end_array();
}

}  // namespace

std::string internal::write_trace(const SlamJob& job, const SlamRun& run,
                                  const HypothesisTexts* hypotheses, const TextSink& sink) {
  require_fit(job, run);
  if (hypotheses != nullptr && hypotheses->frames() != run.frames.size()) {
    throw InvalidInput(fmt::format("results: got recorded hypotheses of {} frames, expected {}",
                                   hypotheses->frames(), run.frames.size()));
  }
  Sha256 hash;
  JsonWriter out([&](std::string_view text) {
    hash.add(text);
    sink(text);
  });
  out.begin_object();
  write_head(out, job, run);
  write_camera(out, job, run);
  out.key("objects");
  out.begin_object();
  for (std::size_t object = 0; object < job.models.size(); ++object) {
    out.key(job.models[object].id);
    write_trace_object(out, job, run, object, hypotheses);
  }
  out.end_object();
  out.array("merges", run.frames.size(),
            [&](std::size_t k) { return Json(run.frames[k].report.merges); });
  write_joint(out, job, run, hypotheses);
  out.flush();
  std::string id = hash.digits().substr(0, kRunDigits);
  sink(fmt::format(",\"run\":\"{}\"}}\n", id));
  return id;
}

std::string format_trace(const SlamJob& job, const SlamRun& run) {
  std::string text;
  internal::write_trace(job, run, nullptr, [&](std::string_view piece) { text += piece; });
  return text;
}

}  // namespace posemix
