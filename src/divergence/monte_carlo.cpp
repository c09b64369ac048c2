// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/divergence/monte_carlo.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <type_traits>
#include <vector>

#include <fmt/format.h>
#include <boost/math/distributions/normal.hpp>

#include "base/in_double.hpp"
#include "density_factors.hpp"
#include "posemix/base/sobol.hpp"
#include "posemix/mixture/log_densities.hpp"

namespace posemix {
namespace {

/// The number of points that every component gets in a replicate if there are enough for all.
constexpr std::size_t kFewPoints = 16;

/// Standard normal vectors from a Sobol sequence under a random digital shift.
class NormalPoints {
 public:
  NormalPoints(std::size_t dimension, RandomStream& stream) : points_(dimension, stream) {}

  void next(Eigen::VectorXd& white) {
    const boost::math::normal_distribution<double, internal::InDouble> distribution;
    points_.next(white);
    for (double& value : white) value = boost::math::quantile(distribution, value);
  }

 private:
  ShiftedSobol points_;
};

/// Whether every rotation vector in the tangent vector has norm pi or less.
template <LieGroup G>
bool in_ball(const typename G::Tangent& xi) {
  constexpr double kLimit = std::numbers::pi * std::numbers::pi;
  if constexpr (std::is_same_v<G, Rnd<Eigen::Dynamic>>) {
    return true;
  } else if constexpr (G::Dof == 3) {
    return xi.squaredNorm() <= kLimit;
  } else {
    for (Eigen::Index i = 0; i < xi.size(); i += 6) {
      if (xi.template segment<3>(i).squaredNorm() > kLimit) return false;
    }
    return true;
  }
}

/// One component to sample from. `weight_at` maps a standard normal vector to an element, and
/// returns the weight that a function's value there has in its mean over the component; zero for
/// none.
template <class D>
struct Stratum;

template <LieGroup G>
struct Stratum<ConcentratedGaussian<G>> {
  double weight;
  G mean;
  typename G::TangentMatrix root;

  Stratum(double share, const ConcentratedGaussian<G>& density)
      : weight(share), mean(density.mean()), root(density.covariance().llt().matrixL()) {}

  double weight_at(const Eigen::VectorXd& white, G& element) const {
    const typename G::Tangent xi = root * white;
    if (!in_ball<G>(xi)) return 0.0;
    element = G::exp(xi) * mean;
    return 1.0;
  }
};

template <RotationOrPose G>
struct Stratum<ProjectedGaussian<G>> {
  double weight;
  ProjectedGaussian<G> density;
  typename G::TangentMatrix root;

  Stratum(double share, const ProjectedGaussian<G>& of)
      : weight(share), density(of), root(of.covariance().llt().matrixL()) {}

  /// The ratio of the distribution to the Gaussian in the tangent space is (1 + u.u)^-2 / C.
  double weight_at(const Eigen::VectorXd& white, G& element) const {
    const typename G::Tangent y = density.tangent_mean() + root * white;
    const double squared = y.template head<3>().squaredNorm();
    element = density.element(y);
    return std::exp(-2.0 * std::log1p(squared) - density.log_normalizer());
  }
};

/// Whether the density integrates to one over the group; concentrated Gaussians lack the mass
/// beyond pi.
template <class D>
inline constexpr bool kIntegratesToOne = false;
template <RotationOrPose G>
inline constexpr bool kIntegratesToOne<ProjectedGaussian<G>> = true;

template <class D>
std::vector<Stratum<D>> strata_of(const Mixture<D>& mixture, double share) {
  std::vector<Stratum<D>> strata;
  for (const auto& component : mixture.components()) {
    const double weight = share * std::exp(component.log_weight);
    if (weight > 0.0) strata.emplace_back(weight, component.density);
  }
  return strata;
}

/// Log densities of a mixture at many elements: of stacks of poses one by one.
template <class D>
class LogDensities {
 public:
  using Group = typename D::Group;

  explicit LogDensities(const Mixture<D>& mixture) : evaluator_(mixture) {}

  void at(std::span<const Group> elements, std::span<double> result) {
    if constexpr (internal::HasKernel<D>) {
      evaluator_.log_densities(elements, result);
    } else {
      std::ranges::transform(elements, result.begin(),
                             [&](const Group& x) { return evaluator_.log_density(x); });
    }
  }

 private:
  template <class Density>
  struct EvaluatorOf {
    using Type = typename Mixture<Density>::Evaluator;
  };
  template <internal::HasKernel Density>
  struct EvaluatorOf<Density> {
    using Type = BatchEvaluator<Density>;
  };

  typename EvaluatorOf<D>::Type evaluator_;
};

/// The means of a factor of two densities over strata, block by block.
template <class P, class Q>
class StratumMeans {
 public:
  using Group = typename P::Group;

  StratumMeans(const Mixture<P>& p, const Mixture<Q>& q, internal::DensityFactor factor)
      : p_(p), q_(q), factor_(factor) {}

  template <class D>
  double mean(const Stratum<D>& stratum, std::size_t count, RandomStream& stream) {
    const Eigen::Index n = stratum.root.rows();
    NormalPoints points(static_cast<std::size_t>(n), stream);
    Eigen::VectorXd white(n);
    double sum = 0.0;
    Group element;
    for (std::size_t i = 0; i < count; ++i) {
      points.next(white);
      if (const double weight = stratum.weight_at(white, element); weight != 0.0) {
        elements_.push_back(element);
        weights_.push_back(weight);
      }
      if (elements_.size() == kEmBlock || i + 1 == count) sum += sum_of_block();
    }
    return sum / static_cast<double>(count);
  }

 private:
  /// The sum over the elements so far, of which none are left.
  double sum_of_block() {
    log_p_.resize(elements_.size());
    log_q_.resize(elements_.size());
    p_.at(elements_, log_p_);
    q_.at(elements_, log_q_);
    double sum = 0.0;
    for (std::size_t i = 0; i < elements_.size(); ++i)
      sum += weights_[i] * factor_(log_p_[i], log_q_[i]);
    elements_.clear();
    weights_.clear();
    return sum;
  }

  LogDensities<P> p_;
  LogDensities<Q> q_;
  internal::DensityFactor factor_;
  std::vector<Group> elements_;
  std::vector<double> weights_, log_p_, log_q_;
};

void check(Eigen::Index p, Eigen::Index q, const DivergenceSamplingSettings& settings) {
  if (p != q) throw InvalidInput(fmt::format("mixtures of {} and {} degrees of freedom", p, q));
  if (settings.replicates < 2 || settings.samples < settings.replicates) {
    throw InvalidInput(
        fmt::format("{} samples in {} replicates, expected at least 2 replicates and "
                    "a sample in each",
                    settings.samples, settings.replicates));
  }
  internal::check_count(settings.samples, "samples");
}

template <class P, class Q>
DivergenceEstimate sampled(const Mixture<P>& p, const Mixture<Q>& q, bool from_both,
                           internal::DensityFactor factor, RandomStream& stream,
                           const DivergenceSamplingSettings& settings) {
  check(p.dof(), q.dof(), settings);
  const auto of_p = strata_of(p, from_both ? 0.5 : 1.0);
  const auto of_q = from_both ? strata_of(q, 0.5) : std::vector<Stratum<Q>>{};
  StratumMeans<P, Q> means(p, q, factor);

  const double per_replicate =
      static_cast<double>(settings.samples) / static_cast<double>(settings.replicates);
  DivergenceEstimate estimate{0.0, 0.0, 0, true};
  std::vector<double> replicates(settings.replicates, 0.0);
  const std::size_t least = std::clamp<std::size_t>(
      settings.samples / (settings.replicates * (of_p.size() + of_q.size())), 1, kFewPoints);
  for (double& replicate : replicates) {
    const auto add = [&](const auto& stratum) {
      const auto share = static_cast<std::size_t>(std::lround(stratum.weight * per_replicate));
      const std::size_t count = std::max(least, share);
      replicate += stratum.weight * means.mean(stratum, count, stream);
      estimate.evaluations += count;
    };
    for (const auto& stratum : of_p) add(stratum);
    for (const auto& stratum : of_q) add(stratum);
  }
  const double count = static_cast<double>(settings.replicates);
  for (const double replicate : replicates) estimate.value += replicate / count;
  double squares = 0.0;
  for (const double replicate : replicates) squares += std::pow(replicate - estimate.value, 2);
  estimate.error = std::sqrt(squares / (count * (count - 1.0)));
  return estimate;
}

}  // namespace

template <class P, class Q>
DivergenceEstimate kl_monte_carlo(const Mixture<P>& p, const Mixture<Q>& q, RandomStream& stream,
                                  const DivergenceSamplingSettings& settings) {
  if constexpr (kIntegratesToOne<P> && kIntegratesToOne<Q>) {
    // The integrand of int (p log(p/q) - p + q) is never negative and has little variance if p and
    // q are close.
    return sampled(p, q, true, internal::gap_factor, stream, settings);
  } else {
    return sampled(p, q, false, internal::log_ratio, stream, settings);
  }
}

template <class P, class Q>
DivergenceEstimate symmetric_kl_monte_carlo(const Mixture<P>& p, const Mixture<Q>& q,
                                            RandomStream& stream,
                                            const DivergenceSamplingSettings& settings) {
  return sampled(p, q, true, internal::symmetric_factor, stream, settings);
}

template <class P, class Q>
DivergenceEstimate isd_monte_carlo(const Mixture<P>& p, const Mixture<Q>& q, RandomStream& stream,
                                   const DivergenceSamplingSettings& settings) {
  return sampled(p, q, true, internal::square_factor, stream, settings);
}

template <class P, class Q>
using Sampler = DivergenceEstimate(const Mixture<P>&, const Mixture<Q>&, RandomStream&,
                                   const DivergenceSamplingSettings&);
template <class G>
using Concentrated = ConcentratedGaussian<G>;
template <class G>
using Projected = ProjectedGaussian<G>;

#define POSEMIX_INSTANTIATE(P, Q)                        \
  template Sampler<P, Q> kl_monte_carlo<P, Q>;           \
  template Sampler<P, Q> symmetric_kl_monte_carlo<P, Q>; \
  template Sampler<P, Q> isd_monte_carlo<P, Q>;

POSEMIX_INSTANTIATE(Concentrated<SO3d>, Concentrated<SO3d>)
POSEMIX_INSTANTIATE(Concentrated<SE3d>, Concentrated<SE3d>)
POSEMIX_INSTANTIATE(Concentrated<PoseStackd>, Concentrated<PoseStackd>)
POSEMIX_INSTANTIATE(Concentrated<Rnd<Eigen::Dynamic>>, Concentrated<Rnd<Eigen::Dynamic>>)
POSEMIX_INSTANTIATE(Projected<SO3d>, Projected<SO3d>)
POSEMIX_INSTANTIATE(Projected<SE3d>, Projected<SE3d>)
POSEMIX_INSTANTIATE(Concentrated<SO3d>, Projected<SO3d>)
POSEMIX_INSTANTIATE(Concentrated<SE3d>, Projected<SE3d>)
POSEMIX_INSTANTIATE(Projected<SO3d>, Concentrated<SO3d>)
POSEMIX_INSTANTIATE(Projected<SE3d>, Concentrated<SE3d>)
#undef POSEMIX_INSTANTIATE

}  // namespace posemix
