// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <limits>

#include <fmt/format.h>

#include "posemix/base/error.hpp"
#include "posemix/io/bop.hpp"
#include "sequence_parts.hpp"

/// Rows of BOP result files as detections.
namespace posemix::internal {
namespace {

/// The rows of one object in one scene, and what they are.
struct BopRows {
  std::string name;
  BopDetections detections;
  std::int64_t object;
  std::int64_t first;  ///< number of the first frame
  BopObservationSettings settings;
};

BopRows read_rows(const TomlTable& table, const FileFinder& files, BopRowUse use) {
  const std::filesystem::path path = files.find(table, "bop");
  const BopSelection selection{table.get_integer("scene", kAtLeastZero),
                               table.get_integer("object", kAtLeastZero)};
  BopRows rows{path.string(), read_bop(path, selection), selection.object, 0, {.use = use}};
  rows.settings.least_score =
      table.get_double_or("min_score", std::numeric_limits<double>::lowest());
  if (use == BopRowUse::mixtures)
    rows.settings.same_place_m =
        table.get_double_or("same_place_m", rows.settings.same_place_m, kPositive);
  return rows;
}

void check_positions(const BopRows& rows, std::int64_t image,
                     const std::vector<Observation>& observations) {
  for (const Observation& observation : observations) {
    for (const ObservationComponent& component : observation.components)
      check_position(component.pose, fmt::format("{}: frame {}", rows.name, image));
  }
}

/// The observations of one image, the highest score first.
std::vector<Observation> observations_in(const BopRows& rows, std::int64_t image) {
  std::vector<BopRow> of_image;
  for (const ScoredPose& estimate : rows.detections.at(image))
    of_image.push_back({0, image, rows.object, estimate.score, estimate.pose});
  std::vector<Observation> observations = bop_observations(of_image, rows.settings);
  check_positions(rows, image, observations);
  return observations;
}

}  // namespace

DetectionFile read_bop_detections(const TomlTable& table, const FileFinder& files) {
  const auto use = table.get_enum_or<BopRowUse>(
      "rows", BopRowUse::best, {{"best", BopRowUse::best}, {"mixtures", BopRowUse::mixtures}});
  BopRows rows = read_rows(table, files, use);
  std::map<std::int64_t, Observation> found;
  for (const auto& [image, estimates] : rows.detections) {
    std::vector<Observation> observations = observations_in(rows, image);
    if (!observations.empty()) found.emplace(image, std::move(observations.front()));
  }
  if (found.empty()) {
    table.fail("min_score", fmt::format("is {}, and {} has no estimate of so high a score",
                                        rows.settings.least_score, rows.name));
  }
  const std::int64_t first = read_first_frame(table, rows.name, found.begin()->first);
  DetectionFile file{rows.name, std::nullopt, {}};
  for (auto& [image, observation] : found) {
    file.numbered.emplace(image - first, observation.components.front().pose);
    if (use == BopRowUse::mixtures) file.mixtures.emplace(image - first, std::move(observation));
  }
  return file;
}

CandidateFile read_bop_candidates(const TomlTable& table, const FileFinder& files) {
  const auto use = table.get_enum_or("rows", BopRowUse::rows);
  const BopRows rows = read_rows(table, files, use);
  CandidateFile file{rows.name, table.get_string("class"), {}};
  const std::int64_t first = read_first_frame(table, file.name, rows.detections.begin()->first);
  for (const auto& [image, estimates] : rows.detections) {
    if (use == BopRowUse::mixtures) {
      std::vector<Observation> observations = observations_in(rows, image);
      if (!observations.empty()) file.mixtures.emplace(image - first, std::move(observations));
      continue;
    }
    std::vector<ScoredPose> kept;
    for (const ScoredPose& estimate : estimates) {
      check_position(estimate.pose, fmt::format("{}: frame {}", file.name, image));
      if (!(estimate.score >= rows.settings.least_score)) continue;
      if (use == BopRowUse::best && !kept.empty()) {
        if (estimate.score > kept.front().score) kept.front() = estimate;
      } else {
        kept.push_back(estimate);
      }
    }
    if (!kept.empty()) file.numbered.emplace(image - first, std::move(kept));
  }
  return file;
}

std::set<std::int64_t> CandidateFile::numbers() const {
  std::set<std::int64_t> all;
  for (const auto& [number, poses] : numbered) all.insert(number);
  for (const auto& [number, observations] : mixtures) all.insert(number);
  return all;
}

}  // namespace posemix::internal
