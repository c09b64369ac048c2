// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "input.hpp"
#include "invariants.hpp"
#include "posemix/io/mixture_file.hpp"
#include "posemix/mixture/moments.hpp"
#include "posemix/mixture/operations.hpp"
#include "posemix/mixture/projected_operations.hpp"
#include "posemix/reduction/reduce.hpp"
#include "precision.hpp"

/// Mixtures of poses: products, compositions, inverses and reductions of any of them are mixtures
/// again, and reduction keeps the weight.
namespace posemix::fuzzing {
namespace {

/// What goes into the operations, where a pose may be as far away as two of them.
template <class D>
void see(const Mixture<D>& mixture, const Mixture<D>& other, Precision& precision) {
  double farthest = 0.0;
  for (const auto* both : {&mixture, &other})
    for (const auto& component : both->components())
      farthest = std::max(farthest, component.density.mean().translation().norm());
  for (const auto& component : mixture.components()) {
    precision.see(component.density.covariance());
    precision.swing(component.density.covariance(), 2.0 * farthest);
  }
}

template <class D>
void expect_sound(const Mixture<D>& mixture, const std::string& what, const Precision& precision) {
  expect_weights(mixture, what);
  for (const auto& component : mixture.components()) {
    if (component.log_weight < -700.0) continue;
    expect_pose(component.density.mean());
    if (precision.is_left())
      expect_covariance(component.density.covariance(), what, precision.rounding());
    expect(component.density.covariance().allFinite(), what + ": not finite");
  }
}

constexpr double kMostVariance = 1e100;

template <class D>
Mixture<D> mixture_from(Input& input) {
  std::vector<Component<D>> components;
  for (std::size_t k = 1 + input.below(5); k > 0; --k) {
    const double log_weight = std::log(input.scale(1.0));
    const SE3d mean = input.pose();
    const Matrix6d covariance = input.covariance(0.1, 0.1);
    if (covariance.diagonal().maxCoeff() > kMostVariance)
      throw InvalidInput("a density whose variance overflows where it is squared");
    components.push_back({log_weight, D(mean, covariance)});
  }
  return Mixture<D>(std::move(components));
}

ReductionSettings reduction_settings(Input& input) {
  ReductionSettings settings;
  settings.max_components = input.below(4);
  settings.drop_smallest = input.below(3);
  settings.keep_heaviest = input.below(4);
  settings.pair = static_cast<PairRule>(input.below(words<PairRule>.size()));
  settings.merge.rule = static_cast<MergeRule>(input.below(3));
  if (input.flag()) settings.prune_below = input.number();
  return settings;
}

/// What may be refused, as a product of densities that have nothing in common.
template <class Operation>
void may(const Operation& operation) {
  try {
    operation();
  } catch (const InvalidInput& refusal) {
    expect(!std::string_view(refusal.what()).empty(), "a refusal without a reason");
  }
}

template <class D>
void operate(Input& input) {
  const Mixture<D> x = mixture_from<D>(input);
  const Mixture<D> y = mixture_from<D>(input);
  Precision precision(internal::kLargestVarianceRatio);
  see(x, y, precision);
  see(y, x, precision);
  expect_sound(x, "a mixture", precision);
  may([&] {
    const ReductionSettings settings = reduction_settings(input);
    const Reduction<D> reduced = reduce(x, settings);
    expect_sound(reduced.mixture, "a reduced mixture", precision);
    expect(reduced.mixture.size() <= std::max(settings.max_components, settings.merge_from),
           "more components than were asked for");
    expect(reduced.report.destination.size() == x.size(), "a component whose place is not told");
  });
  may([&] { expect_sound(compose(x, y), "a composition", precision); });
  may([&] { expect_sound(inverse(x), "an inverse", precision); });
  may([&] {
    const MixtureFusion<D> fused = fuse(x, y);
    if (fused.converged) expect_weights(fused.density, "a product");
  });
  const double log_density = x.log_density(y[0].density.mean());
  expect(!std::isnan(log_density) && log_density < 1e9, "a density that is none");
}

}  // namespace

POSEMIX_FUZZ_TARGET(mixtures) {
  Input input(bytes);
  may([&] {
    if (input.flag()) return operate<ProjectedGaussian<SE3d>>(input);
    operate<ConcentratedGaussian<SE3d>>(input);
  });
}

}  // namespace posemix::fuzzing
