// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "peer.hpp"

#include <array>
#include <cstdlib>
#include <utility>

#include <fmt/format.h>

#include "io/csv_table.hpp"
#include "posemix/base/error.hpp"
#include "posemix/io/tum.hpp"

namespace posemix {
namespace {

namespace fs = std::filesystem;

/// Stamps that differ by no more are one [s].
constexpr double kSamePeerStamp = 1e-6;

/// An argument for the shell.
std::string quoted_argument(const fs::path& path) {
  std::string text = "'";
  for (const char c : path.string()) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

std::string last_line(const fs::path& path) {
  const std::string text = fs::exists(path) ? read_file(path) : std::string();
  LineReader reader(text, path.string());
  std::string last;
  while (reader.next())
    if (!trimmed(reader.line()).empty()) last = reader.line();
  return last;
}

constexpr std::array<const char*, 7> kPeerPose{"tx_m", "ty_m", "tz_m", "qx", "qy", "qz", "qw"};

void require_columns(const internal::CsvTable& table, std::span<const char* const> columns) {
  for (const char* const column : columns) table.require_column(column);
}

SE3d peer_pose(const internal::CsvTable& table) {
  PoseNumbers numbers{};
  for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = table.number(kPeerPose[i]);
  return pose_from_numbers(numbers, table.reader());
}

std::vector<TagSighting> read_peer_sightings(const fs::path& path) {
  const std::string text = read_file(path);
  internal::CsvTable table(text, path.string());
  require_columns(table, std::array{"stamp_s", "camera", "id"});
  require_columns(table, kPeerPose);
  std::vector<TagSighting> sightings;
  while (table.next()) {
    sightings.push_back({table.number("stamp_s"), std::string(table.field("camera")),
                         std::string(table.field("id")), peer_pose(table)});
  }
  return sightings;
}

std::map<std::string, SE3d> read_peer_tags(const fs::path& path) {
  const std::string text = read_file(path);
  internal::CsvTable table(text, path.string());
  require_columns(table, std::array{"id"});
  require_columns(table, kPeerPose);
  std::map<std::string, SE3d> tags;
  while (table.next()) tags.insert_or_assign(std::string(table.field("id")), peer_pose(table));
  return tags;
}

FiducialTimes read_peer_times(const fs::path& path) {
  const std::string text = read_file(path);
  internal::CsvTable table(text, path.string());
  require_columns(table, std::array{"frames", "processor_s", "worst_s"});
  if (!table.next()) table.reader().fail("no row", "a row of times");
  return {.frames = static_cast<std::size_t>(table.index("frames")),
          .processor_s = table.number("processor_s"),
          .worst_s = table.number("worst_s")};
}

}  // namespace

FiducialEstimate run_peer(const FiducialPeer& peer, const fs::path& input, const fs::path& result) {
  const fs::path log = result.string() + ".log";
  const std::string command =
      fmt::format("( {} {} {} ) > {} 2>&1", peer.command, quoted_argument(input),
                  quoted_argument(result), quoted_argument(log));
  // NOLINTNEXTLINE(bugprone-command-processor): a command line is what a study is given
  if (std::system(command.c_str()) != 0) {
    throw InvalidInput(
        fmt::format("peer '{}': '{}' failed: {}", peer.name, peer.command, last_line(log)));
  }
  FiducialEstimate estimate{.camera = read_tum(result / "camera.tum"),
                            .sightings = read_peer_sightings(result / "sightings.csv")};
  if (fs::exists(result / "tags.csv")) estimate.tags = read_peer_tags(result / "tags.csv");
  if (fs::exists(result / "times.csv")) estimate.times = read_peer_times(result / "times.csv");
  return estimate;
}

std::vector<StampedPose> continued(std::span<const StampedPose> path,
                                   std::span<const StampedPose> odometry) {
  if (odometry.empty()) return {path.begin(), path.end()};
  std::vector<StampedPose> result;
  result.reserve(odometry.size());
  auto next = path.begin();
  SE3d world_odom;
  for (const StampedPose& moved : odometry) {
    bool is_own = false;
    while (next != path.end() && next->stamp <= moved.stamp + kSamePeerStamp) {
      world_odom = next->pose.value() * moved.pose.value().inverse();
      is_own = true;
      ++next;
    }
    if (!is_own && next == path.begin()) continue;
    result.push_back({moved.stamp, world_odom * moved.pose.value()});
  }
  return result;
}

}  // namespace posemix
