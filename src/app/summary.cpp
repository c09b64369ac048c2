// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "summary.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>

#include <unistd.h>

#include <fmt/format.h>

#include "base/uninterrupted.hpp"
#include "draw/run_consistency.hpp"
#include "posemix/base/words.hpp"
#include "terminal_text.hpp"

namespace posemix {
namespace {

constexpr double kMillimetres = 1e3;

std::string cell(const std::optional<double>& value, double factor) {
  return value ? fmt::format("{:.2f}", factor * *value) : "-";
}

std::string errors(const PoseErrors& e) {
  return fmt::format("{:>9} {:>7}", cell(e.position_rmse_m, kMillimetres),
                     cell(e.rotation_rmse_deg, 1.0));
}

std::string object_row(const ObjectMetrics& object, std::size_t width) {
  return fmt::format("{:<{}}  {}  {}  {}  {:>10} {:>11}\n", object.id, width, errors(object.world),
                     errors(object.relative), errors(object.detection_relative), object.detections,
                     object.unexplained);
}

std::string medians(const PoseMedians& m) {
  return fmt::format("{:>9} {:>7}", cell(m.position_m, kMillimetres), cell(m.rotation_deg, 1.0));
}

/// Headings over pairs of columns, and below them the units of each.
std::string headings(std::size_t width, std::initializer_list<std::string_view> pairs,
                     std::string_view rest) {
  std::string first(width, ' ');
  std::string second = first;
  for (const std::string_view pair : pairs) {
    first += fmt::format("  {:>17}", pair);
    second += fmt::format("  {:>9} {:>7}", "[mm]", "[deg]");
  }
  return fmt::format("{}{}\n{}\n", first, rest, second);
}

/// Estimates beside detections over the same frames.
std::string paired_table(const Metrics& metrics, std::size_t width) {
  if (metrics.objects.empty()) return "";
  std::string text =
      "\nMedian errors relative to the camera over the frames with both estimate and detection.\n" +
      headings(width, {"estimate", "detector"}, "  frames");
  for (const ObjectMetrics& object : metrics.objects) {
    text +=
        fmt::format("{:<{}}  {}  {}  {:>6}\n", object.id, width, medians(object.paired.estimate),
                    medians(object.paired.detection), object.paired.frames);
  }
  return text;
}

/// The verdict in its colour, where there are colours.
std::string verdict_word(ConsistencyVerdict verdict, bool colours) {
  std::string word(word_of(verdict));
  if (!colours) return word;
  const int colour = verdict == ConsistencyVerdict::consistent      ? 32
                     : verdict == ConsistencyVerdict::overconfident ? 31
                                                                    : 33;
  return fmt::format("\033[{}m{}\033[0m", colour, word);
}

std::string verdict_line(const std::string& name, std::size_t width,
                         const ConsistencyReport& report, bool colours) {
  const std::string fault = internal::fault_text(report);
  return fmt::format("{:<{}}  {} ({}){}{}\n", name, width, verdict_word(report.verdict, colours),
                     internal::nees_text(report.pose), fault.empty() ? "" : ": ", fault);
}

/// Whether errors are as large as the covariances say, a line for every pose with ground truth.
std::string verdicts(const SlamJob& job, const SlamRun& run, std::size_t width, bool colours) {
  std::string lines;
  if (const auto camera = internal::camera_consistency(job, run))
    lines += verdict_line("camera", width, *camera, colours);
  for (std::size_t i = 0; i < job.models.size(); ++i) {
    if (const auto report = internal::relative_consistency(job, run, i))
      lines += verdict_line(job.models[i].id, width, *report, colours);
  }
  if (lines.empty()) return lines;
  return "\nConsistency: the mean NEES per degree of freedom, of objects relative to the "
         "camera.\n" +
         lines;
}

}  // namespace

bool colours_fit_output() {
  const char* const refused = std::getenv("NO_COLOR");
  const char* const terminal = std::getenv("TERM");
  const bool is_dumb = terminal != nullptr && std::string_view(terminal) == "dumb";
  return isatty(STDOUT_FILENO) == 1 && !is_dumb && (refused == nullptr || *refused == '\0');
}

std::string format_summary(const SlamJob& job, const SlamRun& run, const Metrics& metrics,
                           bool colours) {
  std::size_t width = 6;
  for (const ObjectMetrics& object : metrics.objects) width = std::max(width, object.id.size());
  std::string text =
      fmt::format("{}: {}, {} frames, {:.2f} ms per frame (median)\n\n", terminal_line(job.name),
                  job.method, metrics.frames, 1e-3 * metrics.timing.frame_median_us);
  text +=
      "Root mean square errors against the ground truth, each over its own frames; '-' where there "
      "is none.\n"
      "Unexplained are detections that were not used, doubted, or began a hypothesis of their "
      "own.\n";
  text += headings(width, {"world", "relative", "detector"}, "  detections unexplained");
  text += fmt::format("{:<{}}  {}\n", "camera", width, errors(metrics.camera));
  for (const ObjectMetrics& object : metrics.objects) text += object_row(object, width);
  return text + verdicts(job, run, width, colours) + paired_table(metrics, width);
}

void print_text(std::string_view text) {
  const bool written = std::fwrite(text.data(), 1, text.size(), stdout) == text.size();
  if (written && std::fflush(stdout) == 0) return;
  if (errno == EPIPE) throw BrokenPipe();
  internal::throw_if_interrupted(errno, "standard output");
  throw OutputError("standard output: cannot be written");
}

void print_warnings(const std::vector<std::string>& warnings) {
  for (const std::string& warning : warnings) {
    std::fputs(fmt::format("posemix: warning: {}\n", terminal_line(warning)).c_str(), stderr);
  }
}

}  // namespace posemix
