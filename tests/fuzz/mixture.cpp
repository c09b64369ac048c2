// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "invariants.hpp"
#include "posemix/io/mixture_file.hpp"
#include "target.hpp"

/// Mixtures in JSON: what is taken is normalised and positive definite, and what is written of it
/// is read again and written alike, in every convention.
namespace posemix::fuzzing {
namespace {

template <class D>
void expect_sound(const Mixture<D>& mixture) {
  expect_weights(mixture, "a mixture");
  for (const auto& component : mixture.components()) {
    expect_pose(component.density.mean());
    expect_covariance(component.density.covariance(), "a component");
  }
}

}  // namespace

POSEMIX_FUZZ_TARGET(mixture) {
  takes("m.json", [&] {
    const MixtureFile file = parse_mixture(bytes, "m.json");
    std::visit([](const auto& mixture) { expect_sound(mixture); }, file.mixture);
    const std::string written = format_mixture(file);
    expect(format_mixture(parse_mixture(written, "again")) == written,
           "another mixture after writing");
  });
}

}  // namespace posemix::fuzzing
