// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "invariants.hpp"
#include "posemix/io/posterior_file.hpp"
#include "target.hpp"

/// Posteriors in JSON: as mixtures, over several poses.
namespace posemix::fuzzing {

POSEMIX_FUZZ_TARGET(posterior) {
  takes("p.json", [&] {
    const PosteriorFile file = parse_posterior(bytes, "p.json");
    expect_weights(file.mixture, "a posterior");
    for (const auto& component : file.mixture.components()) {
      const auto poses = component.density.mean().poses();
      expect(poses.size() == file.poses.size(), "a number of names that is not that of the poses");
      for (const SE3d& pose : poses) expect_pose(pose);
      expect_covariance(component.density.covariance(), "a component");
    }
    const std::string written = format_posterior(file);
    expect(format_posterior(parse_posterior(written, "again")) == written,
           "another posterior after writing");
  });
}

}  // namespace posemix::fuzzing
