// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/results/results.hpp"

#include <cmath>
#include <functional>

#include <fmt/format.h>

#include "io/covariance_columns.hpp"
#include "io/json_numbers.hpp"
#include "io/sha256.hpp"
#include "metrics_file.hpp"
#include "posemix/base/error.hpp"
#include "posemix/draw/picture.hpp"
#include "posemix/io/mixture_file.hpp"
#include "posemix/io/tum.hpp"
#include "readable_run.hpp"
#include "slam/run_checks.hpp"
#include "trace_writer.hpp"
#include "verdicts_json.hpp"

namespace posemix {
namespace {

using namespace internal;
using Densities = std::vector<std::optional<PoseDensity>> FrameEstimate::*;

std::string object_tum(const SlamJob& job, const SlamRun& run, Densities densities,
                       std::size_t object) {
  std::vector<StampedPose> poses;
  for (std::size_t k = 0; k < run.frames.size(); ++k) {
    const auto& density = (run.frames[k].*densities)[object];
    if (density) poses.push_back({job.sequence.stamps[k], density->mean()});
  }
  return format_tum(poses);
}

std::string camera_tum(const SlamJob& job, const SlamRun& run) {
  std::vector<StampedPose> poses;
  poses.reserve(run.frames.size());
  for (std::size_t k = 0; k < run.frames.size(); ++k) {
    poses.push_back({job.sequence.stamps[k], run.frames[k].camera.mean()});
  }
  return format_tum(poses);
}

/// The alternatives of one object, without those of probability zero.
Mixture<PoseDensity> world_mixture(const std::vector<ObjectHypothesis>& alternatives) {
  constexpr double kLeastProbability = 1e-12;
  std::vector<Component<PoseDensity>> components;
  for (const ObjectHypothesis& hypothesis : alternatives) {
    if (hypothesis.probability < kLeastProbability) continue;
    components.push_back({std::log(hypothesis.probability),
                          PoseDensity::trusted(hypothesis.pose, hypothesis.covariance)});
  }
  return Mixture<PoseDensity>(std::move(components));
}

/// The cameras of a rig, empty where all are exact.
std::string cameras_csv(const std::vector<BodyCamera>& cameras) {
  std::string text = fmt::format("camera,{},{}\n", pose_header(), covariance_header());
  bool any = false;
  for (const BodyCamera& camera : cameras) {
    any = any || !camera.is_exact();
    const auto covariance = camera.is_exact() ? std::nullopt : camera.covariance;
    text += fmt::format("{},{},{}\n", camera.name, pose_fields(camera.body_camera),
                        covariance_fields(covariance));
  }
  return any ? text : "";
}

/// Numbers that no reader takes are an error of the file in which they would be.
template <class Format>
std::string text_of(const std::string& name, const Format& format) {
  try {
    return format();
  } catch (const InvalidInput& error) {
    throw InvalidInput(fmt::format("{}: {}", name, error.what()));
  }
}

/// Takes the files of a run one after the other: the name, and a function that gives the content.
using FileSink =
    std::function<void(const std::string&, const std::function<void(const TextSink&)>&)>;

/// The files of a run for a FileSink, with the digests of those that only some runs have.
class ResultFiles {
 public:
  ResultFiles(const SlamJob& job, const SlamRun& run, const Metrics& metrics,
              const ResultOptions& options, FileSink sink)
      : job_(job), run_(run), metrics_(metrics), options_(options), sink_(std::move(sink)) {}

  /// Returns the text of metrics.json.
  std::string put_all() {
    put("camera.tum", camera_tum(job_, run_));
    for (std::size_t object = 0; object < job_.models.size(); ++object) {
      const std::string& id = job_.models[object].id;
      put(fmt::format("object_{}.tum", id),
          object_tum(job_, run_, &FrameEstimate::objects, object));
      put(fmt::format("relative_{}.tum", id),
          object_tum(job_, run_, &FrameEstimate::relative, object));
    }
    put_mixtures();
    if (const std::string cameras = cameras_csv(run_.cameras); !cameras.empty())
      put_named("cameras.csv", cameras);
    const char* const posterior = "posterior.json";
    put_named(posterior,
              text_of(posterior, [&] { return format_posterior(last_posterior(job_, run_)); }));
    sink_("trace.json", [&](const TextSink& text) {
      const auto* record = options_.hypotheses;
      stamp_.run = write_trace(job_, run_, record == nullptr ? nullptr : &record->texts(), text);
    });
    const Provenance* provenance = options_.provenance ? &*options_.provenance : nullptr;
    const Json verdicts = verdicts_json(job_, run_);
    std::string metrics = metrics_text(metrics_, job_.method, {&stamp_, provenance, &verdicts});
    put("metrics.json", metrics);
    put("picture.svg", format_picture(job_, run_, metrics_));
    return metrics;
  }

 private:
  void put(const std::string& name, const std::string& text) const {
    sink_(name, [&](const TextSink& out) { out(text); });
  }

  void put_named(const std::string& name, const std::string& text) {
    stamp_.files[name] = sha256_of(text);
    put(name, text);
  }

  void put_mixtures() {
    for (std::size_t object = 0; object < run_.hypotheses.size(); ++object) {
      if (run_.hypotheses[object].empty()) continue;
      const std::string& id = job_.models[object].id;
      const std::string name = fmt::format("mixture_{}.json", id);
      put_named(name, text_of(name, [&] {
                  return format_mixture({{"world", id}, world_mixture(run_.hypotheses[object])});
                }));
    }
  }

  const SlamJob& job_;
  const SlamRun& run_;
  const Metrics& metrics_;
  const ResultOptions& options_;
  FileSink sink_;
  RunStamp stamp_;
};

}  // namespace

PosteriorFile last_posterior(const SlamJob& job, const SlamRun& run) {
  require_fit(job, run);
  const std::size_t size = run.posterior[0].density.mean().size();
  std::vector<NamedPose> poses(size, {"camera_motion", PoseKind::camera_motion});
  poses[kCamera] = {"camera", PoseKind::camera};
  for (std::size_t object = 0; object < job.models.size(); ++object) {
    const auto index = run.pose_indices[object];
    if (index) poses[*index] = {job.models[object].id, PoseKind::object};
  }
  return {job.method, job.sequence.stamps[run.frames.size() - 1], std::move(poses), run.posterior};
}

std::vector<NamedText> format_results(const SlamJob& job, const SlamRun& run,
                                      const Metrics& metrics) {
  return format_results(job, run, metrics, ResultOptions());
}

std::vector<NamedText> format_results(const SlamJob& job, const SlamRun& run,
                                      const Metrics& metrics, const ResultOptions& options) {
  require_readable(job, run);
  require_fit(job, metrics);
  std::vector<NamedText> files;
  ResultFiles(job, run, metrics, options, [&](const std::string& name, const auto& content) {
    std::string& text = files.emplace_back(name, "").second;
    content([&](std::string_view piece) { text += piece; });
  }).put_all();
  return files;
}

std::string write_results(OutputFolder& folder, const SlamJob& job, const SlamRun& run,
                          const Metrics& metrics, const ResultOptions& options) {
  require_readable(job, run);
  require_fit(job, metrics);
  folder.remove_earlier(earlier_results(folder.target()));
  folder.put_last("metrics.json");
  return ResultFiles(
             job, run, metrics, options,
             [&](const std::string& name, const auto& content) { folder.write(name, content); })
      .put_all();
}

}  // namespace posemix
