// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "summary.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdio>

#include <fmt/format.h>

namespace posemix {
namespace {

std::string cell(const std::optional<double>& value, double factor) {
  return value ? fmt::format("{:.2f}", factor * *value) : "-";
}

std::string errors(const PoseErrors& e) {
  return fmt::format("{:>8} {:>7}", cell(e.position_rmse_m, 100.0), cell(e.rotation_rmse_deg, 1.0));
}

std::string object_row(const ObjectMetrics& object, std::size_t width) {
  return fmt::format("{:<{}}  {}  {}  {}  {:>6}  {:>10} {:>6}\n", object.id, width,
                     errors(object.world), errors(object.relative),
                     errors(object.detection_relative), cell(object.relative_anees, 1.0),
                     object.detections, object.gated);
}

std::string medians(const PoseMedians& m) {
  return fmt::format("{:>8} {:>7}", cell(m.position_m, 100.0), cell(m.rotation_deg, 1.0));
}

/// Estimates beside detections over the same frames.
std::string paired_table(const Metrics& metrics, std::size_t width) {
  if (metrics.objects.empty()) return "";
  std::string text =
      "\nMedian errors relative to the camera over the frames with both estimate and detection.\n";
  text +=
      fmt::format("{:<{}}  {:^16}  {:^16}  {:>6}\n", "", width, "estimate", "detector", "frames");
  for (const ObjectMetrics& object : metrics.objects) {
    text +=
        fmt::format("{:<{}}  {}  {}  {:>6}\n", object.id, width, medians(object.paired.estimate),
                    medians(object.paired.detection), object.paired.frames);
  }
  return text;
}

}  // namespace

std::string format_summary(const SlamJob& job, const Metrics& metrics) {
  std::size_t width = 6;
  for (const ObjectMetrics& object : metrics.objects) width = std::max(width, object.id.size());
  std::string text = fmt::format("{}: {}, {} frames, {:.2f} ms per frame (median)\n\n", job.name,
                                 job.method, metrics.frames, 1e-3 * metrics.timing.frame_median_us);
  text +=
      "Root mean square errors [cm, deg], each over its own frames; '-' where there is no ground "
      "truth.\n";
  text += fmt::format("{:<{}}  {:^16}  {:^16}  {:^16}  {:>6}  {:>10} {:>6}\n", "", width, "world",
                      "relative", "detector", "ANEES", "detections", "gated");
  text += fmt::format("{:<{}}  {}\n", "camera", width, errors(metrics.camera));
  for (const ObjectMetrics& object : metrics.objects) text += object_row(object, width);
  return text + paired_table(metrics, width);
}

void print_text(std::string_view text) {
  const bool written = std::fwrite(text.data(), 1, text.size(), stdout) == text.size();
  if (written && std::fflush(stdout) == 0) return;
  if (errno == EPIPE) throw BrokenPipe();
  throw OutputError("standard output: cannot be written");
}

void print_warnings(const std::vector<std::string>& warnings) {
  for (const std::string& warning : warnings) {
    std::fputs(fmt::format("posemix: warning: {}\n", warning).c_str(), stderr);
  }
}

}  // namespace posemix
