// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/fiducial/fiducial_folder.hpp"

#include <algorithm>

#include "posemix/fiducial/fiducial_sequence.hpp"
#include "posemix/fiducial/rig_calibration.hpp"
#include "posemix/io/gzip.hpp"
#include "posemix/io/observation_csv.hpp"
#include "posemix/io/output_folder.hpp"

namespace posemix {

std::vector<std::string> complete_rig(FiducialFolder& folder) {
  std::vector<std::string> unknown = calibrate_rig(folder.fiducials.observations, folder.cameras);
  std::erase_if(folder.fiducials.observations, [&](const Observation& observation) {
    return std::find(unknown.begin(), unknown.end(), observation.camera) != unknown.end();
  });
  return unknown;
}

std::vector<StampedPose> odometry_of_rig(std::vector<StampedPose> odometry,
                                         const SE3d& rig_odometry) {
  std::stable_sort(odometry.begin(), odometry.end(),
                   [](const auto& a, const auto& b) { return a.stamp < b.stamp; });
  const SE3d odometry_rig = rig_odometry.inverse();
  for (StampedPose& pose : odometry)
    if (pose.pose) pose.pose = *pose.pose * odometry_rig;
  return odometry;
}

void write_fiducial_folder(const FiducialFolder& folder, const std::filesystem::path& target) {
  OutputFolder out(target);
  out.put_last("sequence.toml");
  const std::string observations = format_observations(folder.fiducials.observations);
  if (folder.compress) {
    out.write("observations.csv.gz", gzip(observations));
  } else {
    out.write("observations.csv", observations);
  }
  out.write("sequence.toml", format_fiducial_sequence(folder));
  out.write("cameras.csv", format_rig(folder.cameras));
  out.write("corner_noise.csv", format_corner_noise(folder.fiducials.noise));
  if (!folder.tags.priors.empty()) out.write("tag_priors.csv", format_tag_priors(folder.tags));
  if (!folder.odometry.empty()) out.write("odometry.tum", format_tum(folder.odometry));
  out.commit();
}

}  // namespace posemix
