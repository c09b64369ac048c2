// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/fiducial/fiducial_folder.hpp"

#include "posemix/io/gzip.hpp"
#include "posemix/io/observation_csv.hpp"
#include "posemix/io/output_folder.hpp"

namespace posemix {

void write_fiducial_folder(const FiducialFolder& folder, const std::filesystem::path& target) {
  OutputFolder out(target);
  const std::string observations = format_observations(folder.fiducials.observations);
  if (folder.compress) {
    out.write("observations.csv.gz", gzip(observations));
  } else {
    out.write("observations.csv", observations);
  }
  out.write("cameras.csv", format_rig(folder.cameras));
  out.write("corner_noise.csv", format_corner_noise(folder.fiducials.noise));
  if (!folder.tags.priors.empty()) out.write("tag_priors.csv", format_tag_priors(folder.tags));
  if (!folder.odometry.empty()) out.write("odometry.tum", format_tum(folder.odometry));
  out.commit();
}

}  // namespace posemix
