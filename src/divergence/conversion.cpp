// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/divergence/conversion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Eigenvalues>

#include "density/split_gaussian.hpp"
#include "density_fit.hpp"
#include "posemix/density/operations.hpp"

namespace posemix {
namespace {

using internal::PointRule;

/// The matrix A of y = A xi to first order, for a perturbation xi on the right of the element.
SO3d::TangentMatrix linear_map(const SO3d& /*element*/) {
  return 0.5 * Eigen::Matrix3d::Identity();
}
SE3d::TangentMatrix linear_map(const SE3d& element) {
  Matrix6d a = Matrix6d::Zero();
  a.topLeftCorner<3, 3>() = 0.5 * Eigen::Matrix3d::Identity();
  a.bottomRightCorner<3, 3>() = element.rotation().matrix();
  return a;
}

/// The parts of a density, still in its own tangent space.
template <RotationOrPose G>
std::vector<Component<TangentGaussian<G>>> pieces_of(const ConcentratedGaussian<G>& density,
                                                     double max_spread) {
  std::vector<Component<TangentGaussian<G>>> pieces;
  for (const auto& part : internal::split_gaussian<typename G::Tangent, typename G::TangentMatrix>(
           G::Tangent::Zero(), density.covariance(), max_spread)) {
    pieces.push_back({part.log_weight, {density.mean(), part.mean, part.covariance}});
  }
  return pieces;
}
template <RotationOrPose G>
std::vector<Component<ProjectedGaussian<G>>> pieces_of(const ProjectedGaussian<G>& density,
                                                       double max_spread) {
  std::vector<Component<ProjectedGaussian<G>>> pieces;
  for (const auto& part : internal::split_gaussian<typename G::Tangent, typename G::TangentMatrix>(
           density.tangent_mean(), density.covariance(), max_spread)) {
    const auto piece =
        ProjectedGaussian<G>::trusted(density.tangent_point(), part.mean, part.covariance);
    // The density N / C is the sum of the parts' N_i / C_i with the weights w_i C_i / C.
    pieces.push_back({part.log_weight + piece.log_normalizer(), piece});
  }
  return pieces;
}

PointRule points_for(ConversionRule rule) {
  return rule == ConversionRule::maximum_likelihood ? PointRule::quadrature : PointRule::cubature;
}

template <RotationOrPose G>
ConvertedDensity<ProjectedGaussian<G>> converted(const TangentGaussian<G>& density,
                                                 ConversionRule rule) {
  if (rule == ConversionRule::linear) {
    const ConcentratedGaussian<G> at_mode = back_project(density);
    const typename G::TangentMatrix a = linear_map(at_mode.mean());
    typename G::TangentMatrix covariance = a * at_mode.body_covariance() * a.transpose();
    symmetrize(covariance);
    return {ProjectedGaussian<G>::trusted(at_mode.mean(), covariance), true};
  }
  return internal::fit_projected(internal::quadrature_points(density, points_for(rule)),
                                 rule == ConversionRule::maximum_likelihood);
}

template <RotationOrPose G>
ConvertedDensity<ConcentratedGaussian<G>> converted(const ProjectedGaussian<G>& density,
                                                    ConversionRule rule) {
  if (rule == ConversionRule::linear) {
    const G mean = density.mean();
    const typename G::TangentMatrix inverse = linear_map(mean).inverse();
    const typename G::TangentMatrix body =
        inverse * change_chart_to_mode(density).covariance() * inverse.transpose();
    typename G::TangentMatrix covariance = mean.adjoint_congruence(body);
    symmetrize(covariance);
    return {ConcentratedGaussian<G>::trusted(mean, covariance), true};
  }
  return internal::fit_concentrated(internal::quadrature_points(density, points_for(rule)),
                                    rule == ConversionRule::maximum_likelihood);
}

/// The components of the other kind that one component of a mixture is converted to.
template <class To>
struct ConvertedComponent {
  std::vector<Component<To>> pieces;
  double kl = 0.0;
  bool converged = true;
};

template <class From, class To>
class Converter {
 public:
  Converter(RandomStream& stream, const ConversionSettings& settings)
      : stream_(stream), settings_(settings) {
    require(settings.max_kl > 0.0, "conversion: max_kl must be positive");
    require(settings.max_pieces > 0, "conversion: max_pieces is 0, expected at least 1");
    internal::check_count(settings.max_pieces, "conversion: max_pieces");
  }

  Conversion<To> convert(const Mixture<From>& mixture) {
    std::vector<Component<To>> all;
    double largest = 0.0;
    std::size_t components_split = 0;
    bool within = true;
    bool converged = true;
    for (std::size_t i = 0; i < mixture.size(); ++i) {
      const ConvertedComponent<To> one = convert(mixture[i].density, i);
      for (const auto& piece : one.pieces) {
        all.push_back({mixture[i].log_weight + piece.log_weight, piece.density});
      }
      if (std::abs(one.kl) > std::abs(largest)) largest = one.kl;
      components_split += one.pieces.size() > 1 ? 1 : 0;
      within = within && is_within(one.kl);
      converged = converged && one.converged;
    }
    Mixture<To> result(std::move(all));
    const DivergenceEstimate total = kl_monte_carlo(mixture, result, stream_, settings_.sampling);
    return {std::move(result), total.value, total.error, largest,
            components_split,  converged,   within};
  }

 private:
  /// A density so wide that it turns by more than half a turn does not integrate to one there, and
  /// the divergence from it can be far below zero.
  bool is_within(double kl) const { return std::abs(kl) <= settings_.max_kl; }

  /// Converts the parts of a density and measures the loss of them together.
  template <class Piece>
  ConvertedComponent<To> convert(const From& density, const std::vector<Component<Piece>>& pieces) {
    ConvertedComponent<To> result;
    for (const auto& piece : pieces) {
      const auto one = converted(piece.density, settings_.rule);
      result.pieces.push_back({piece.log_weight, one.density});
      result.converged = result.converged && one.converged;
    }
    const Mixture<From> before({{0.0, density}});
    const Mixture<To> after(result.pieces);
    for (std::size_t i = 0; i < after.size(); ++i) {
      result.pieces[i].log_weight = after[i].log_weight;
    }
    result.kl = kl_monte_carlo(before, after, stream_, settings_.sampling).value;
    return result;
  }

  ConvertedComponent<To> convert(const From& density, std::size_t index) {
    double spread = internal::widest(density.covariance()).first;
    ConvertedComponent<To> best = convert(density, pieces_of(density, spread));
    if (is_within(best.kl) || settings_.on_large_loss == LargeLoss::accept) return best;
    if (settings_.on_large_loss == LargeLoss::refuse) {
      throw InvalidInput(
          fmt::format("conversion: component {} would lose {:.4g} nats, expected at most max_kl = "
                      "{:.4g}; split it or accept the loss",
                      index, best.kl, settings_.max_kl));
    }
    // Every round splits at least the widest axis once more.
    for (std::size_t pieces = 1; 3 * pieces <= settings_.max_pieces;) {
      spread *= 0.8;
      const auto narrower = pieces_of(density, spread);
      if (narrower.size() > settings_.max_pieces) break;
      if (narrower.size() <= pieces) continue;
      pieces = narrower.size();
      ConvertedComponent<To> finer = convert(density, narrower);
      if (std::abs(finer.kl) < std::abs(best.kl)) best = std::move(finer);
      if (is_within(best.kl)) break;
    }
    return best;
  }

  RandomStream& stream_;
  const ConversionSettings& settings_;
};

}  // namespace

template <RotationOrPose G>
ConvertedDensity<ProjectedGaussian<G>> to_projected(const ConcentratedGaussian<G>& density,
                                                    ConversionRule rule) {
  const TangentGaussian<G> in_tangent{density.mean(), G::Tangent::Zero(), density.covariance()};
  return converted(in_tangent, rule);
}

template <RotationOrPose G>
ConvertedDensity<ConcentratedGaussian<G>> to_concentrated(const ProjectedGaussian<G>& density,
                                                          ConversionRule rule) {
  return converted(density, rule);
}

template <RotationOrPose G>
std::vector<Component<ConcentratedGaussian<G>>> split(const ConcentratedGaussian<G>& density,
                                                      double max_spread) {
  std::vector<Component<ConcentratedGaussian<G>>> pieces;
  for (const auto& piece : pieces_of(density, max_spread)) {
    pieces.push_back({piece.log_weight, back_project(piece.density)});
  }
  return pieces;
}

template <RotationOrPose G>
Conversion<ProjectedGaussian<G>> to_projected(const Mixture<ConcentratedGaussian<G>>& mixture,
                                              RandomStream& stream,
                                              const ConversionSettings& settings) {
  return Converter<ConcentratedGaussian<G>, ProjectedGaussian<G>>(stream, settings)
      .convert(mixture);
}

template <RotationOrPose G>
Conversion<ConcentratedGaussian<G>> to_concentrated(const Mixture<ProjectedGaussian<G>>& mixture,
                                                    RandomStream& stream,
                                                    const ConversionSettings& settings) {
  return Converter<ProjectedGaussian<G>, ConcentratedGaussian<G>>(stream, settings)
      .convert(mixture);
}

template ConvertedDensity<ProjectedGaussian<SO3d>> to_projected(const ConcentratedGaussian<SO3d>&,
                                                                ConversionRule);
template ConvertedDensity<ConcentratedGaussian<SO3d>> to_concentrated(
    const ProjectedGaussian<SO3d>&, ConversionRule);
template std::vector<Component<ConcentratedGaussian<SO3d>>> split(const ConcentratedGaussian<SO3d>&,
                                                                  double);
template Conversion<ProjectedGaussian<SO3d>> to_projected(
    const Mixture<ConcentratedGaussian<SO3d>>&, RandomStream&, const ConversionSettings&);
template Conversion<ConcentratedGaussian<SO3d>> to_concentrated(
    const Mixture<ProjectedGaussian<SO3d>>&, RandomStream&, const ConversionSettings&);
template ConvertedDensity<ProjectedGaussian<SE3d>> to_projected(const ConcentratedGaussian<SE3d>&,
                                                                ConversionRule);
template ConvertedDensity<ConcentratedGaussian<SE3d>> to_concentrated(
    const ProjectedGaussian<SE3d>&, ConversionRule);
template std::vector<Component<ConcentratedGaussian<SE3d>>> split(const ConcentratedGaussian<SE3d>&,
                                                                  double);
template Conversion<ProjectedGaussian<SE3d>> to_projected(
    const Mixture<ConcentratedGaussian<SE3d>>&, RandomStream&, const ConversionSettings&);
template Conversion<ConcentratedGaussian<SE3d>> to_concentrated(
    const Mixture<ProjectedGaussian<SE3d>>&, RandomStream&, const ConversionSettings&);

}  // namespace posemix
