// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "run.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <ctime>
#include <system_error>

#include <fmt/format.h>

#include "figures.hpp"
#include "posemix/config/sequence_file.hpp"
#include "posemix/io/output_folder.hpp"

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

/// The processor's time of this thread [s].
double thread_seconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  constexpr double kNano = 1e-9;
  return static_cast<double>(time.tv_sec) + kNano * static_cast<double>(time.tv_nsec);
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
  FiducialFolder folder = read_fiducial_recording(recording, settings.size_m);
  const TagMap survey = folder.tags;
  if (!settings.priors) folder.tags.priors.clear();
  SlamJob job = read_fiducial_job(folder, settings);
  replace_observations(input, job.sequence);
  std::vector<double> frame_s;
  double before = thread_seconds();
  const auto progress = [&](std::size_t, std::size_t) {
    const double now = thread_seconds();
    frame_s.push_back(now - before);
    before = now;
    return true;
  };
  const SlamRun done = run(job, {.progress = progress});
  // A sequence file leaves out priors that say no more than where the world is.
  const bool has_priors = std::any_of(job.models.begin(), job.models.end(),
                                      [](const ObjectModel& model) { return model.prior; });
  nlohmann::ordered_json row = {{"recording", recording.name},
                                {"input", std::string(word_of(input))},
                                {"priors", has_priors}};
  return fiducial_figures({.observations = folder.fiducials.observations,
                           .cameras = camera_poses(folder.cameras),
                           .survey = survey.priors,
                           .has_priors = has_priors,
                           .reference = read_fiducial_reference(recording),
                           .sequence = job.sequence,
                           .run = done,
                           .frame_s = std::move(frame_s)},
                          std::move(row));
}

}  // namespace posemix
