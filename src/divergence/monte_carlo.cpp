// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/divergence/monte_carlo.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <type_traits>
#include <vector>

#include <fmt/format.h>
#include <boost/math/distributions/normal.hpp>
#include <boost/random/sobol.hpp>

#include "density_factors.hpp"

namespace posemix {
namespace {

constexpr std::size_t kLeastPoints = 16;

/// Standard normal vectors from a Sobol sequence under a random digital shift.
class NormalPoints {
 public:
  NormalPoints(std::size_t dimension, RandomStream& stream)
      : points_(dimension), shift_(dimension) {
    for (std::uint64_t& bits : shift_) {
      bits = (static_cast<std::uint64_t>(stream()) << 32U) | stream();
    }
  }

  void next(Eigen::VectorXd& white) {
    const boost::math::normal_distribution<double> law;
    for (std::size_t i = 0; i < shift_.size(); ++i) {
      const std::uint64_t bits = (points_() ^ shift_[i]) >> 12U;
      const double uniform = (static_cast<double>(bits) + 0.5) * 0x1p-52;
      white[static_cast<Eigen::Index>(i)] = boost::math::quantile(law, uniform);
    }
  }

 private:
  boost::random::sobol points_;
  std::vector<std::uint64_t> shift_;
};

/// Whether no rotation of the tangent vector exceeds pi.
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

/// One component from which to sample.
template <LieGroup G>
struct Stratum {
  double weight;
  G mean;
  typename G::TangentMatrix root;
};

template <LieGroup G>
void append_strata(const Mixture<ConcentratedGaussian<G>>& mixture, double share,
                   std::vector<Stratum<G>>& strata) {
  for (const auto& component : mixture.components()) {
    const double weight = share * std::exp(component.log_weight);
    if (weight == 0.0) continue;
    const Eigen::LLT<typename G::TangentMatrix> factor(component.density.covariance());
    strata.push_back({weight, component.density.mean(), factor.matrixL()});
  }
}

/// The mean of `factor` over one stratum.
template <LieGroup G, class Function>
double stratum_mean(const Stratum<G>& stratum, std::size_t count, RandomStream& stream,
                    Function&& factor) {
  const Eigen::Index n = stratum.root.rows();
  NormalPoints points(static_cast<std::size_t>(n), stream);
  Eigen::VectorXd white(n);
  double sum = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    points.next(white);
    const typename G::Tangent xi = stratum.root * white;
    if (in_ball<G>(xi)) sum += factor(G::exp(xi) * stratum.mean);
  }
  return sum / static_cast<double>(count);
}

void check(Eigen::Index p, Eigen::Index q, const DivergenceSamplingSettings& settings) {
  if (p != q) throw InvalidInput(fmt::format("mixtures of {} and {} degrees of freedom", p, q));
  if (settings.replicates < 2 || settings.samples < settings.replicates) {
    throw InvalidInput(
        fmt::format("{} samples in {} replicates, expected at least 2 replicates and "
                    "a sample in each",
                    settings.samples, settings.replicates));
  }
}

template <LieGroup G>
DivergenceEstimate sampled(const Mixture<ConcentratedGaussian<G>>& p,
                           const Mixture<ConcentratedGaussian<G>>& q, bool from_both,
                           internal::DensityFactor factor, RandomStream& stream,
                           const DivergenceSamplingSettings& settings) {
  check(p.dof(), q.dof(), settings);
  std::vector<Stratum<G>> strata;
  append_strata(p, from_both ? 0.5 : 1.0, strata);
  if (from_both) append_strata(q, 0.5, strata);
  const typename Mixture<ConcentratedGaussian<G>>::Evaluator log_p(p);
  const typename Mixture<ConcentratedGaussian<G>>::Evaluator log_q(q);
  const auto at = [&](const G& x) { return factor(log_p.log_density(x), log_q.log_density(x)); };

  const double per_replicate =
      static_cast<double>(settings.samples) / static_cast<double>(settings.replicates);
  DivergenceEstimate estimate{0.0, 0.0, 0, true};
  std::vector<double> replicates(settings.replicates, 0.0);
  for (double& replicate : replicates) {
    for (const Stratum<G>& stratum : strata) {
      const auto share = static_cast<std::size_t>(std::lround(stratum.weight * per_replicate));
      const std::size_t count = std::max(kLeastPoints, share);
      replicate += stratum.weight * stratum_mean(stratum, count, stream, at);
      estimate.evaluations += count;
    }
  }
  const double count = static_cast<double>(settings.replicates);
  for (const double replicate : replicates) estimate.value += replicate / count;
  double squares = 0.0;
  for (const double replicate : replicates) squares += std::pow(replicate - estimate.value, 2);
  estimate.error = std::sqrt(squares / (count * (count - 1.0)));
  return estimate;
}

}  // namespace

template <LieGroup G>
DivergenceEstimate kl_monte_carlo(const Mixture<ConcentratedGaussian<G>>& p,
                                  const Mixture<ConcentratedGaussian<G>>& q, RandomStream& stream,
                                  const DivergenceSamplingSettings& settings) {
  return sampled(p, q, false, internal::log_ratio, stream, settings);
}

template <LieGroup G>
DivergenceEstimate symmetric_kl_monte_carlo(const Mixture<ConcentratedGaussian<G>>& p,
                                            const Mixture<ConcentratedGaussian<G>>& q,
                                            RandomStream& stream,
                                            const DivergenceSamplingSettings& settings) {
  return sampled(p, q, true, internal::symmetric_factor, stream, settings);
}

template <LieGroup G>
DivergenceEstimate isd_monte_carlo(const Mixture<ConcentratedGaussian<G>>& p,
                                   const Mixture<ConcentratedGaussian<G>>& q, RandomStream& stream,
                                   const DivergenceSamplingSettings& settings) {
  return sampled(p, q, true, internal::square_factor, stream, settings);
}

template <LieGroup G>
using Sampler = DivergenceEstimate(const Mixture<ConcentratedGaussian<G>>&,
                                   const Mixture<ConcentratedGaussian<G>>&, RandomStream&,
                                   const DivergenceSamplingSettings&);

#define POSEMIX_INSTANTIATE(G)                     \
  template Sampler<G> kl_monte_carlo<G>;           \
  template Sampler<G> symmetric_kl_monte_carlo<G>; \
  template Sampler<G> isd_monte_carlo<G>;

POSEMIX_INSTANTIATE(SO3d)
POSEMIX_INSTANTIATE(SE3d)
POSEMIX_INSTANTIATE(PoseStackd)
POSEMIX_INSTANTIATE(Rnd<Eigen::Dynamic>)
#undef POSEMIX_INSTANTIATE

}  // namespace posemix
