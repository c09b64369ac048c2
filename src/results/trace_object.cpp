// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>

#include "hypothesis_texts.hpp"
#include "posemix/results/results.hpp"
#include "trace_track.hpp"
#include "trace_writer.hpp"

namespace posemix::internal {
namespace {

Json vector_of(const Eigen::Vector3d& vector) { return json_vector(vector, kPoseDigits); }

/// The symmetries of an object: its motions, and the axes of free rotation.
Json symmetries_of(const SymmetryGroup& group) {
  Json elements = Json::array();
  for (const SE3d& element : group.elements()) elements.push_back(json_pose(element, kPoseDigits));
  Json axes = Json::array();
  for (const SymmetryAxis& axis : group.axes()) {
    axes.push_back({{"direction", vector_of(axis.direction)}, {"point_m", vector_of(axis.point)}});
  }
  return {{"elements", std::move(elements)}, {"axes", std::move(axes)}};
}

/// The part of the trace that is of one object.
class TraceObjectWriter {
 public:
  TraceObjectWriter(JsonWriter& out, const SlamJob& job, const SlamRun& run, std::size_t object,
                    const HypothesisTexts* hypotheses)
      : out_(out), job_(job), run_(run), object_(object), hypotheses_(hypotheses) {}

  void write() {
    out_.begin_object();
    write_tracks();
    const SymmetryGroup& symmetries = job_.models[object_].symmetries;
    if (!symmetries.is_trivial()) out_.entry("symmetries", symmetries_of(symmetries));
    write_probabilities();
    write_alternatives();
    write_health();
    write_motion();
    const auto& detections = job_.sequence.objects[object_].detections;
    out_.array("detection", detections.size(),
               [&](std::size_t k) { return json_pose(detections[k], kPoseDigits); });
    each("status",
         [&](const FrameEstimate& frame) { return Json(word_of(frame.report.statuses[object_])); });
    write_nis();
    out_.end_object();
  }

 private:
  template <class Entry>
  void each(const char* key, const Entry& entry) {
    out_.array(key, run_.frames.size(), [&](std::size_t k) { return entry(run_.frames[k]); });
  }

  void write_track(const char* key, const TraceTrackWriter& track) {
    out_.key(key);
    out_.begin_object();
    track.write(out_);
    out_.end_object();
  }

  void write_tracks() {
    const ErrorReduction reduction(job_.models[object_].symmetries);
    const auto of = [&](const auto& true_pose, const auto densities) {
      Truths truths;
      truths.reserve(run_.frames.size());
      for (std::size_t k = 0; k < run_.frames.size(); ++k)
        truths.push_back(true_pose(job_.sequence, object_, k));
      return TraceTrackWriter(run_, reduction, std::move(truths), [&](const FrameEstimate& frame) {
        const auto& density = (frame.*densities)[object_];
        return density ? &*density : nullptr;
      });
    };
    const TraceTrackWriter world = of(true_world_pose, &FrameEstimate::objects);
    const TraceTrackWriter relative = of(true_relative_pose, &FrameEstimate::relative);
    write_track("world", world);
    write_track("relative", relative);
    if (world.has_truth() || relative.has_truth()) out_.entry("nees_dof", reduction.dof());
  }

  void write_probabilities() {
    const auto has = [](const FrameEstimate& frame) { return !frame.mode_probabilities.empty(); };
    const std::vector<const FrameEstimate*> frames = frames_with(has);
    if (frames.empty()) return;
    out_.array("mode_probability", frames.size(),
               [&](std::size_t k) { return json_number(frames[k]->mode_probabilities[object_]); });
  }

  void write_alternatives() {
    if (hypotheses_ != nullptr) {
      if (!hypotheses_->has_alternatives()) return;
      out_.key("alternatives");
      out_.begin_array();
      hypotheses_->copy_alternatives(object_, [&](std::string_view text) { out_.raw(text); });
      return out_.end_array();
    }
    const auto has = [](const FrameEstimate& frame) { return !frame.alternatives.empty(); };
    const std::vector<const FrameEstimate*> frames = frames_with(has);
    if (frames.empty()) return;
    out_.array("alternatives", frames.size(), [&](std::size_t k) {
      return alternatives_json(frames[k]->alternatives[object_], job_.trace_hypotheses);
    });
  }

  /// Existence and health, where the tracker has them.
  void write_health() {
    const auto has = [](const FrameEstimate& frame) { return !frame.healths.empty(); };
    if (std::none_of(run_.frames.begin(), run_.frames.end(), has)) return;
    // Objects on sight are unknown to earlier frames.
    const auto known = [&](const FrameEstimate& frame) { return object_ < frame.healths.size(); };
    each("existence", [&](const FrameEstimate& frame) {
      return compact_number(known(frame) ? frame.existences[object_] : std::nullopt);
    });
    each("health", [&](const FrameEstimate& frame) {
      return Json(word_of(known(frame) ? frame.healths[object_] : TrackHealth::none));
    });
    each("register_again", [&](const FrameEstimate& frame) {
      return Json(known(frame) && frame.register_again[object_]);
    });
  }

  /// The motion of an object that moves.
  void write_motion() {
    const MotionModels& motion = job_.models[object_].motion;
    if (!has_own_track(motion)) return;
    Json names = Json::array();
    for (const ObjectMotion& model : motion.models) names.push_back(name_of(model));
    out_.entry("model_names", names);
    const auto each_known = [&](const char* key, const auto& entry) {
      each(key, [&](const FrameEstimate& frame) {
        const bool known = object_ < frame.twists.size() && frame.twists[object_];
        return known ? entry(frame) : Json(nullptr);
      });
    };
    each_known("models", [&](const FrameEstimate& frame) {
      Json models = Json::array();
      for (const double probability : frame.motion_models[object_])
        models.push_back(rounded(probability, kCompactDigits));
      return models;
    });
    each_known("twist", [&](const FrameEstimate& frame) {
      return json_vector(frame.twists[object_]->mean, kCompactDigits);
    });
    each_known("twist_sd", [&](const FrameEstimate& frame) {
      return json_vector(frame.twists[object_]->covariance.diagonal().cwiseSqrt(), kCompactDigits);
    });
  }

  /// Of the detections that were used; the others are no innovations of a consistent filter.
  void write_nis() {
    const auto nis_of = [&](const FrameEstimate& frame) -> std::optional<double> {
      const FrameReport& report = frame.report;
      const bool used = report.statuses[object_] == DetectionStatus::used;
      return used && object_ < report.nis.size() ? report.nis[object_] : std::nullopt;
    };
    const auto has = [&](const FrameEstimate& frame) { return nis_of(frame).has_value(); };
    if (std::none_of(run_.frames.begin(), run_.frames.end(), has)) return;
    each("nis", [&](const FrameEstimate& frame) { return compact_number(nis_of(frame)); });
  }

  template <class Has>
  std::vector<const FrameEstimate*> frames_with(const Has& has) const {
    std::vector<const FrameEstimate*> frames;
    frames.reserve(run_.frames.size());
    for (const FrameEstimate& frame : run_.frames)
      if (has(frame)) frames.push_back(&frame);
    return frames;
  }

  JsonWriter& out_;
  const SlamJob& job_;
  const SlamRun& run_;
  std::size_t object_;
  const HypothesisTexts* hypotheses_;
};

}  // namespace

void write_trace_object(JsonWriter& out, const SlamJob& job, const SlamRun& run, std::size_t object,
                        const HypothesisTexts* hypotheses) {
  TraceObjectWriter(out, job, run, object, hypotheses).write();
}

}  // namespace posemix::internal
