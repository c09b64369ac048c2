// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors

// The same work by dense matrices in Eigen, compiled for the machine (-march=native). A program of
// its own that does not see the library: code of Eigen for two sets of instructions in one program
// would violate the one-definition rule, and disagree on alignment.
#include "dense_jobs.hpp"

namespace {

void kl_jobs(bench::Jobs& jobs) {
  for (const std::string name : {"kl_axisymmetric", "kl_general"}) {
    if (!jobs.wants(name)) continue;
    const auto peaks = dense::gaussians<double>(jobs, name);
    double found = 0.0;
    jobs.run(
        name, 1, [&] { found = dense::kl_to_tolerance(peaks); },
        [&] { return std::vector<double>{found}; });
  }
}

}  // namespace

int main(int count, char** arguments) {
  return bench::jobs_main(count, arguments, [](bench::Jobs& jobs) {
    dense::merge_jobs<double>(jobs);
    dense::frame_job<double>(jobs);
    dense::lie_jobs<double>(jobs);
    dense::uncertain_jobs<double>(jobs);
    dense::reduction_jobs<double>(jobs);
    dense::density_job<double>(jobs);
    dense::pair_jobs<double>(jobs);
    dense::hybrid_job<double>(jobs);
    dense::vector_jobs<double>(jobs);
    kl_jobs(jobs);
  });
}
