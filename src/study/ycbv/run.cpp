// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "run.hpp"

#include <algorithm>
#include <array>

#include "forecasts.hpp"
#include "kept_run.hpp"
#include "pixels.hpp"
#include "posemix/base/units.hpp"
#include "posemix/slam/evaluation.hpp"
#include "published.hpp"

namespace posemix {
namespace {

constexpr double kCentimetres = 100.0;
constexpr double kMicroseconds = 1e6;

Cell cell(const std::optional<double>& value, double scale = 1.0) {
  return value ? Cell(scale * *value) : Cell();
}

Cell integer(std::size_t count) { return static_cast<std::int64_t>(count); }

Cell flag(const std::optional<bool>& value) { return value ? Cell(std::int64_t{*value}) : Cell(); }

using PosePairs = std::vector<std::pair<SE3d, SE3d>>;

std::optional<SE3d> mean_of(const std::optional<PoseDensity>& density) {
  return density ? std::optional(density->mean()) : std::nullopt;
}

PoseErrors errors_of(const PosePairs& pairs, const ErrorReduction& reduction = ErrorReduction()) {
  PoseErrorSum sum;
  for (const auto& [estimate, truth] : pairs) sum.add(estimate, reduction.nearest(truth, estimate));
  return sum.errors();
}

/// The numbers of a row.
struct Row {
  PoseErrors camera = {};
  PoseErrors world = {};
  PoseErrors relative = {};
  std::optional<double> anees = {};
  std::optional<double> pixels = {};
  std::optional<double> merges = {};
  std::optional<double> last_map_pixels = {};
  std::optional<bool> ends_on_right_mode = {};
  std::optional<double> right_mode_share = {};
  std::optional<double> right_mode_anees = {};
  Consistency camera_consistency = {};
  Consistency world_consistency = {};
  PairedErrors paired = {};
};

/// Rows of one method on one recording.
class Item {
 public:
  Item(const YcbvStudySettings& settings, const Recording& recording, const YcbvMethod& method)
      : settings_(settings),
        recording_(recording),
        method_(method),
        job_(read_ycbv_job(settings, recording, method)),
        pixels_(PixelMetric::find(recording)) {}

  YcbvRows rows() {
    switch (method_.kind) {
      case YcbvKind::detector:
        run_detector();
        break;
      case YcbvKind::odometry:
        run_odometry();
        break;
      case YcbvKind::filter:
        run_filter();
        break;
      case YcbvKind::published_offline:
        for (const auto& [method, pixels] : published_pixels(recording_))
          add(method, 0, {.pixels = pixels});
        break;
    }
    return std::move(rows_);
  }

 private:
  const ObjectRecording& object(std::size_t index) const { return job_.sequence.objects[index]; }

  /// The source of an object's truth. World poses are a proxy: robust means of the detections.
  Cell truth_of(std::size_t index) const {
    if (!object(index).relative_truth.empty()) return "ground truth";
    if (object(index).world_truth.empty() || job_.sequence.camera_truth.empty()) return {};
    return "proxy";
  }

  ErrorReduction reduction(std::size_t index) const {
    return ErrorReduction(job_.models[index].symmetries);
  }

  std::size_t detections(std::size_t index) const {
    std::size_t count = 0;
    for (const auto& detection : object(index).detections) count += detection ? 1 : 0;
    return count;
  }

  /// Whether the first detection is on another mode; empty if its truth is unknown.
  std::optional<bool> first_detection_wrong(std::size_t index) const {
    const auto& detections = object(index).detections;
    const auto first = std::find_if(detections.begin(), detections.end(),
                                    [](const auto& detection) { return detection.has_value(); });
    if (first == detections.end()) return std::nullopt;
    const auto truth = true_relative_pose(job_.sequence, index,
                                          static_cast<std::size_t>(first - detections.begin()));
    if (!truth) return std::nullopt;
    return !on_right_mode(**first, reduction(index).nearest(*truth, **first));
  }

  void add(std::size_t index, const Row& row) { add(method_.name, index, row); }

  void add(const std::string& method, std::size_t index, const Row& row) {
    rows_.results.push_back({recording_.sequence,
                             object(index).id,
                             recording_.detector,
                             method,
                             integer(job_.sequence.stamps.size()),
                             integer(detections(index)),
                             cell(row.camera.rotation_rmse_deg),
                             cell(row.camera.position_rmse_m, kCentimetres),
                             cell(row.camera.position_log_rmse_m, kCentimetres),
                             cell(row.world.rotation_rmse_deg),
                             cell(row.world.position_rmse_m, kCentimetres),
                             cell(row.relative.rotation_rmse_deg),
                             cell(row.relative.position_rmse_m, kCentimetres),
                             cell(row.anees),
                             cell(row.pixels),
                             cell(row.merges),
                             cell(row.last_map_pixels),
                             flag(first_detection_wrong(index)),
                             flag(row.ends_on_right_mode),
                             cell(row.right_mode_share),
                             cell(row.right_mode_anees),
                             cell(row.camera_consistency.anees),
                             cell(row.camera_consistency.rotation_anees),
                             cell(row.camera_consistency.position_anees),
                             cell(row.world_consistency.anees),
                             cell(row.paired.estimate.rotation_deg),
                             cell(row.paired.estimate.position_m, kCentimetres),
                             cell(row.paired.detection.rotation_deg),
                             cell(row.paired.detection.position_m, kCentimetres),
                             truth_of(index)});
    if (settings_.runs_in) rows_.results.back().push_back(page_ ? Cell(*page_) : Cell());
  }

  /// Estimates of T_camera_object with the truth of their frames.
  template <class EstimateAt>
  PosePairs pairs(std::size_t index, const EstimateAt& estimate_at) const {
    PosePairs pairs;
    for (std::size_t k = 0; k < job_.sequence.stamps.size(); ++k) {
      const std::optional<SE3d> estimate = estimate_at(k);
      const auto truth = true_relative_pose(job_.sequence, index, k);
      if (estimate && truth) pairs.emplace_back(*estimate, *truth);
    }
    return pairs;
  }

  std::optional<double> pixels(const PosePairs& pairs) const {
    return pixels_ ? pixels_->median(pairs) : std::nullopt;
  }

  void run_detector() {
    for (std::size_t i = 0; i < job_.models.size(); ++i) {
      const PosePairs found = pairs(i, [&](std::size_t k) { return object(i).detections[k]; });
      add(i, {.relative = errors_of(found, reduction(i)), .pixels = pixels(found)});
    }
  }

  /// The odometry alone, aligned at the first frame that has both odometry and truth.
  void run_odometry() {
    const Sequence& sequence = job_.sequence;
    PosePairs pairs;
    std::optional<SE3d> world_odom;
    for (std::size_t k = 0; k < sequence.stamps.size(); ++k) {
      if (sequence.odometry.empty() || sequence.camera_truth.empty()) break;
      const auto& odometry = sequence.odometry[k];
      const auto& truth = sequence.camera_truth[k];
      if (!odometry || !truth) continue;
      if (!world_odom) world_odom = *truth * odometry->inverse();
      pairs.emplace_back(*world_odom * *odometry, *truth);
    }
    for (std::size_t i = 0; i < job_.models.size(); ++i) add(i, {.camera = errors_of(pairs)});
  }

  void run_filter() {
    const bool records = settings_.runs_in && job_.trace_hypotheses > 0;
    const SlamRun slam = run(job_, {.record_hypotheses = records});
    const Metrics metrics = evaluate(job_, slam);
    if (settings_.runs_in) page_ = keep_run(settings_, recording_, method_, {job_, slam, metrics});
    for (std::size_t i = 0; i < job_.models.size(); ++i) {
      const ObjectMetrics& errors = metrics.objects[i];
      const auto estimate_at = [&](std::size_t k) { return mean_of(slam.frames[k].relative[i]); };
      const auto last = mean_of(slam.frames.back().objects[i]);
      const auto last_map_at = [&](std::size_t k) {
        return last ? std::optional(slam.frames[k].camera.mean().inverse() * *last) : std::nullopt;
      };
      const PosePairs causal = pairs(i, estimate_at);
      Row row{metrics.camera,
              errors.world,
              errors.relative,
              errors.relative_anees,
              pixels(causal),
              metrics.timing.merges_per_frame,
              pixels(pairs(i, last_map_at))};
      row.right_mode_share = errors.right_mode_share;
      row.right_mode_anees = errors.right_mode_anees;
      row.camera_consistency = metrics.camera_consistency;
      row.world_consistency = errors.world_consistency;
      row.paired = errors.paired;
      add_forecasts(i, errors.forecasts);
      if (!causal.empty()) {
        const auto& [end, truth] = causal.back();
        row.ends_on_right_mode = on_right_mode(end, reduction(i).nearest(truth, end));
      }
      add(i, row);
    }
    add_timing(slam, metrics.timing);
  }

  /// Counts how often the mode was right, by bins of its probability.
  void add_forecasts(std::size_t index, const std::vector<ModeForecast>& forecasts) {
    std::array<std::array<double, 3>, kForecastBins> bins{};
    for (const ModeForecast& forecast : forecasts) {
      const double place = forecast.probability * static_cast<double>(kForecastBins);
      auto& bin = bins[std::min(kForecastBins - 1, static_cast<std::size_t>(place))];
      bin[0] += 1.0;
      bin[1] += forecast.probability;
      bin[2] += forecast.right ? 1.0 : 0.0;
    }
    for (std::size_t bin = 0; bin < kForecastBins; ++bin) {
      if (bins[bin][0] == 0.0) continue;
      rows_.forecasts.push_back({recording_.sequence, object(index).id, recording_.detector,
                                 method_.name, integer(bin), bins[bin][0], bins[bin][1],
                                 bins[bin][2]});
    }
  }

  void add_timing(const SlamRun& slam, const Timing& timing) {
    double seconds = 0.0;
    for (const FrameEstimate& frame : slam.frames) seconds += frame.report.update.reduce_seconds;
    const double mean = kMicroseconds * seconds / static_cast<double>(slam.frames.size());
    rows_.timing.push_back({recording_.sequence, recording_.object, recording_.detector,
                            method_.name, timing.frame_median_us, timing.update_median_us,
                            timing.reduce_median_us, mean, timing.merges_per_frame});
  }

  const YcbvStudySettings& settings_;
  const Recording& recording_;
  const YcbvMethod& method_;
  SlamJob job_;
  std::optional<PixelMetric> pixels_;
  std::optional<std::string> page_;  ///< of the run, from the study's folder
  YcbvRows rows_;
};

}  // namespace

YcbvRows run_ycbv(const YcbvStudySettings& settings, const Recording& recording,
                  const YcbvMethod& method) {
  return Item(settings, recording, method).rows();
}

}  // namespace posemix
