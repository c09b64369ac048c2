// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "consistency_input.hpp"

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "command_files.hpp"
#include "posemix/base/error.hpp"
#include "posemix/config/sequence_file.hpp"
#include "posemix/config/symmetries.hpp"
#include "posemix/io/text.hpp"
#include "posemix/io/tum.hpp"
#include "posemix/slam/evaluation.hpp"
#include "summary.hpp"

namespace posemix {
namespace {

namespace fs = std::filesystem;

constexpr const char* kTraceFile = "trace.json";
constexpr const char* kPose = "pose";  ///< the name of a pose from a TUM file

std::vector<std::string> names_of(const std::vector<TraceTrack>& tracks) {
  std::vector<std::string> names;
  names.reserve(tracks.size());
  for (const TraceTrack& track : tracks) names.push_back(track.name);
  return names;
}

const TraceTrack& find_track(const std::vector<TraceTrack>& tracks, const std::string& name,
                             const std::string& file) {
  const auto found = std::find_if(tracks.begin(), tracks.end(),
                                  [&](const TraceTrack& track) { return track.name == name; });
  if (found != tracks.end()) return *found;
  throw InvalidInput(fmt::format("--track: got {}, expected one of {} as in {}", in_quotes(name),
                                 fmt::join(names_of(tracks), ", "), file));
}

bool is_trace(const fs::path& path) { return path.extension() == ".json"; }

std::vector<TraceTrack> read_estimates(const ConsistencyInput& input) {
  const fs::path path = input.estimate;
  if (fs::is_directory(path)) {
    if (fs::is_regular_file(path / kTraceFile)) return read_trace_tracks(path / kTraceFile);
    throw InvalidInput(
        fmt::format("{}: got a folder without {}, expected one that posemix slam "
                    "wrote, or a file",
                    path.string(), kTraceFile));
  }
  if (is_trace(path)) return read_trace_tracks(path);
  TraceTrack track{kPose, {}, {}};
  const std::string name = input_name(input.estimate);
  for (StampedDensity& frame :
       parse_tum_covariance(read_text_input(input.estimate), name, input.convention))
    track.estimates.push_back({frame.stamp, std::move(frame.density)});
  return {std::move(track)};
}

std::vector<StampedTruth> stamped(const std::vector<double>& stamps,
                                  const std::vector<std::optional<SE3d>>& poses) {
  std::vector<StampedTruth> truth;
  for (std::size_t k = 0; k < poses.size(); ++k) {
    if (poses[k]) truth.push_back({stamps[k], *poses[k]});
  }
  return truth;
}

/// The truth of all poses of a sequence file.
std::vector<TraceTrack> read_sequence_truth(const std::string& path,
                                            const std::optional<std::string>& data) {
  const TomlDocument document = TomlDocument::load(path);
  print_warnings(document.warnings());
  const SlamJob job = read_slam_job(document, data_folders(path, data));
  const Sequence& sequence = job.sequence;
  std::vector<TraceTrack> tracks{
      {"camera", {}, stamped(sequence.stamps, sequence.camera_truth), {}}};
  for (std::size_t i = 0; i < sequence.objects.size(); ++i) {
    std::vector<std::optional<SE3d>> world;
    std::vector<std::optional<SE3d>> relative;
    for (std::size_t k = 0; k < sequence.stamps.size(); ++k) {
      world.push_back(true_world_pose(sequence, i, k));
      relative.push_back(true_relative_pose(sequence, i, k));
    }
    const std::string name = "objects/" + sequence.objects[i].id;
    const SymmetryGroup& symmetries = job.models[i].symmetries;
    tracks.push_back({name + "/world", {}, stamped(sequence.stamps, world), symmetries});
    tracks.push_back({name + "/relative", {}, stamped(sequence.stamps, relative), symmetries});
  }
  return tracks;
}

std::vector<StampedTruth> read_tum_truth(const std::string& path) {
  std::vector<StampedTruth> truth;
  for (const StampedPose& frame : parse_tum(read_text_input(path), input_name(path)))
    truth.push_back({frame.stamp, *frame.pose});
  return truth;
}

/// A TUM file has one pose, and --track says which one of a sequence file it is.
void require_one_track(const ConsistencyInput& input) {
  if (!input.truth || !is_sequence_file(*input.truth)) {
    throw InvalidInput(
        fmt::format("--track: got {}, but {} and its truth are of one pose; expected --track "
                    "beside a folder of "
                    "posemix slam or --truth with a sequence file",
                    in_quotes(input.tracks.front()), input_name(input.estimate)));
  }
  if (input.tracks.size() > 1) {
    throw InvalidInput(fmt::format("--track: got {} names for the one pose of {}, expected one",
                                   input.tracks.size(), input_name(input.estimate)));
  }
}

/// The tracks that were asked for.
std::vector<TraceTrack> chosen(std::vector<TraceTrack> tracks, const ConsistencyInput& input) {
  if (input.tracks.empty()) return tracks;
  if (tracks.front().name == kPose) {
    require_one_track(input);
    return tracks;
  }
  std::vector<TraceTrack> chosen;
  chosen.reserve(input.tracks.size());
  for (const std::string& name : input.tracks)
    chosen.push_back(find_track(tracks, name, input.estimate));
  return chosen;
}

void take_truth(std::vector<TraceTrack>& tracks, const ConsistencyInput& input) {
  if (!is_sequence_file(*input.truth)) {
    if (tracks.size() > 1) {
      throw InvalidInput(fmt::format(
          "{}: is the truth of one pose, and {} has {}; expected --track with one of {}",
          input_name(*input.truth), input.estimate, tracks.size(),
          fmt::join(names_of(tracks), ", ")));
    }
    tracks.front().truth = read_tum_truth(*input.truth);
    return;
  }
  const std::vector<TraceTrack> truth = read_sequence_truth(*input.truth, input.data);
  for (TraceTrack& track : tracks) {
    const std::string wanted = input.tracks.empty() ? "camera" : input.tracks.front();
    const TraceTrack& found =
        find_track(truth, track.name == kPose ? wanted : track.name, *input.truth);
    track.truth = found.truth;
    track.symmetries = found.symmetries;
  }
}

SymmetryGroup read_symmetries(const ConsistencyInput& input) {
  const SymmetryGroups groups = read_symmetry_file(*input.symmetries);
  const auto found = groups.find(input.object.value());
  if (found != groups.end()) return found->second;
  throw InvalidInput(
      fmt::format("{}: has no object {}, expected one", *input.symmetries, *input.object));
}

}  // namespace

bool is_sequence_file(const std::string& path) { return fs::path(path).extension() == ".toml"; }

bool is_slam_result(const std::string& path) {
  std::error_code ignored;
  return is_trace(path) || fs::is_directory(path, ignored);
}

std::vector<TraceTrack> read_consistency_input(const ConsistencyInput& input) {
  std::vector<TraceTrack> tracks = chosen(read_estimates(input), input);
  if (input.truth) take_truth(tracks, input);
  std::erase_if(tracks, [](const TraceTrack& track) {
    return track.truth.empty() || track.estimates.empty();
  });
  if (tracks.empty()) {
    throw InvalidInput(
        fmt::format("{}: got no estimates with ground truth, expected --truth with "
                    "a TUM file or a sequence file",
                    input_name(input.estimate)));
  }
  if (input.symmetries) {
    const SymmetryGroup group = read_symmetries(input);
    for (TraceTrack& track : tracks) {
      if (track.name != "camera") track.symmetries = group;
    }
  }
  return tracks;
}

}  // namespace posemix
