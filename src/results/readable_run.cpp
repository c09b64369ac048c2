// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "readable_run.hpp"

#include <string>
#include <string_view>

#include <fmt/format.h>

#include "draw/position_covariance.hpp"
#include "posemix/base/error.hpp"
#include "posemix/base/limits.hpp"
#include "posemix/lie/pose_checks.hpp"
#include "slam/run_checks.hpp"

namespace posemix::internal {
namespace {

/// What is wrong with an estimate; empty where nothing is.
std::string estimate_fault(const PoseDensity& density) {
  const SE3d& pose = density.mean();
  if (!pose.log().allFinite() || !density.covariance().allFinite()) return "is not finite";
  if (!is_valid_pose(pose)) return fmt::format("has a position beyond {:g} m", kFarthestPosition);
  if (density.covariance().diagonal().minCoeff() < 0.0 ||
      position_covariance(density).diagonal().minCoeff() < 0.0)
    return "has a variance that is lost to rounding";
  return {};
}

}  // namespace

void require_readable(const SlamJob& job, const SlamRun& run) {
  require_fit(job, run);
  for (std::size_t k = 0; k < run.frames.size(); ++k) {
    const auto check = [&](const std::optional<PoseDensity>& density, const std::string& name) {
      const std::string fault = density ? estimate_fault(*density) : "";
      if (fault.empty()) return;
      throw InvalidInput(
          fmt::format("the estimate at stamp {} s {} ({}): numbers in the files or settings of "
                      "'{}' are too extreme",
                      job.sequence.stamps[k], fault, name, job.name));
    };
    const FrameEstimate& frame = run.frames[k];
    check(frame.camera, "camera");
    for (std::size_t j = 0; j < job.models.size(); ++j) {
      check(frame.objects[j], fmt::format("object '{}'", job.models[j].id));
      check(frame.relative[j], fmt::format("object '{}' from the camera", job.models[j].id));
    }
  }
}

}  // namespace posemix::internal
