// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "run.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "figures.hpp"
#include "posemix/config/sequence_file.hpp"
#include "posemix/io/output_folder.hpp"
#include "study/engine/thread_time.hpp"

namespace posemix {
namespace {

namespace fs = std::filesystem;

/// A folder for files in between, removed at the end.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::string name = (fs::temp_directory_path() / "posemix-fiducials-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) {
      throw OutputError(
          fmt::format("{}: cannot be made: {}", name, std::system_category().message(errno)));
    }
    path_ = name;
  }
  ~ScratchFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

/// The job of the sequence file that stands beside the observations.
SlamJob read_fiducial_job(const FiducialFolder& folder, const FiducialsStudySettings& settings) {
  const ScratchFolder scratch;
  const fs::path target = scratch.path() / "tags";
  write_fiducial_folder(folder, target);
  TomlDocument document = TomlDocument::load(target / "sequence.toml");
  for (const std::string& assignment : settings.overrides) document.apply_override(assignment);
  return read_slam_job(document, {target});
}

/// A recording as the filter and its peers are given it, and what it is compared with.
struct PreparedRecording {
  std::string name;
  FiducialFolder folder;
  TagMap survey;
  SlamJob job;
  ReferencePath reference;

  /// A sequence file leaves out priors that say no more than where the world is.
  bool has_priors() const {
    return std::any_of(job.models.begin(), job.models.end(),
                       [](const ObjectModel& model) { return model.prior; });
  }
};

PreparedRecording prepare_recording(const FiducialRecording& recording,
                                    const FiducialsStudySettings& settings) {
  FiducialFolder folder = read_fiducial_recording(recording, settings.size_m);
  TagMap survey = folder.tags;
  if (!settings.priors) folder.tags.priors.clear();
  SlamJob job = read_fiducial_job(folder, settings);
  return {.name = recording.name,
          .folder = std::move(folder),
          .survey = std::move(survey),
          .job = std::move(job),
          .reference = read_fiducial_reference(recording)};
}

/// T_odom_rig at the stamps of the frames.
std::vector<StampedPose> frame_odometry(const Sequence& sequence) {
  std::vector<StampedPose> poses;
  poses.reserve(sequence.odometry.size());
  for (std::size_t k = 0; k < sequence.odometry.size(); ++k)
    poses.push_back({sequence.stamps[k], sequence.odometry[k]});
  return poses;
}

nlohmann::ordered_json score_estimate(const PreparedRecording& recording, const std::string& input,
                                      const FiducialEstimate& estimate,
                                      const std::optional<FiducialFilterRun>& filter) {
  const std::vector<StampedPose> odometry = frame_odometry(recording.job.sequence);
  return fiducial_figures(
      {.observations = recording.folder.fiducials.observations,
       .cameras = camera_poses(recording.folder.cameras),
       .survey = recording.survey.priors,
       .has_priors = recording.has_priors(),
       .reference = recording.reference,
       .stamps = recording.job.sequence.stamps,
       .odometry = odometry,
       .estimate = estimate,
       .filter = filter},
      {{"recording", recording.name}, {"input", input}, {"priors", recording.has_priors()}});
}

}  // namespace

void replace_observations(FiducialInput input, Sequence& sequence) {
  if (input == FiducialInput::weights) return;
  for (std::vector<Observation>& frame : sequence.observations) {
    for (Observation& observation : frame) {
      if (input == FiducialInput::best)
        observation.components = {observation.components[best_component(observation)]};
      for (ObservationComponent& component : observation.components)
        component.weight = 1.0 / static_cast<double>(observation.components.size());
    }
  }
}

nlohmann::ordered_json run_fiducials(const FiducialRecording& recording, FiducialInput input,
                                     const FiducialsStudySettings& settings) {
  PreparedRecording given = prepare_recording(recording, settings);
  replace_observations(input, given.job.sequence);
  FiducialTimes times;
  double before = internal::thread_seconds();
  const auto progress = [&](std::size_t, std::size_t) {
    const double now = internal::thread_seconds();
    ++times.frames;
    times.processor_s += now - before;
    times.worst_s = std::max(times.worst_s, now - before);
    before = now;
    return true;
  };
  const SlamRun done = run(given.job, {.progress = progress});
  FiducialEstimate estimate =
      estimate_of(given.job.sequence, done, camera_poses(given.folder.cameras));
  estimate.times = times;
  return score_estimate(given, std::string(word_of(input)), estimate,
                        FiducialFilterRun{.sequence = given.job.sequence, .run = done});
}

nlohmann::ordered_json run_fiducials(const FiducialRecording& recording, const FiducialPeer& peer,
                                     const FiducialsStudySettings& settings) {
  PreparedRecording given = prepare_recording(recording, settings);
  // The peer knows no more than the filter.
  if (!given.has_priors()) given.folder.tags.priors.clear();
  const ScratchFolder scratch;
  write_fiducial_folder(given.folder, scratch.path() / "tags");
  FiducialEstimate estimate = run_peer(peer, scratch.path() / "tags", scratch.path() / "result");
  estimate.camera = continued(estimate.camera, frame_odometry(given.job.sequence));
  return score_estimate(given, peer.name, estimate, {});
}

}  // namespace posemix
