// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <functional>
#include <span>

#include "posemix/base/words.hpp"
#include "posemix/filter/update.hpp"

namespace posemix {

/// The loss by which a hypothesis is updated.
enum class RobustLoss {
  none,   ///< the squared Mahalanobis distance of a Gaussian
  cauchy  ///< c^2 log(1 + d^2 / c^2), see `cauchy_update`
};

/// The words of RobustLoss in files and options.
template <>
inline constexpr WordTable<RobustLoss, 2> words<RobustLoss>{{
    {"none", RobustLoss::none},
    {"cauchy", RobustLoss::cauchy},
}};

/// The scale c at which an estimate under the Cauchy loss has 95 % of the efficiency of the
/// Gaussian one on Gaussian errors in six dimensions (for one dimension the known 2.385).
inline constexpr double kCauchyScale = 2.862;

/// Settings of `cauchy_update`.
struct CauchySettings {
  double scale = kCauchyScale;  ///< c, in standard deviations
  int max_iterations = 10;      ///< number of reweightings after the first
  double tolerance = 1e-6;      ///< stop when no weight 1 / lambda changes by a larger share
};

/// An update under given noise components, one for each detection.
using NoiseUpdate = std::function<UpdateResult(std::span<const NoiseComponent* const>)>;

/// Updates one hypothesis with the Cauchy loss, by iteratively reweighted least squares: the noise
/// covariance of each detection (and its update covariance) is multiplied by
///   lambda = 1 + d^2 / c^2,
/// first with d^2 = z^T S^-1 z of the innovation, then with d^2 = r^T R^-1 r of the residual at the
/// posterior mean, until the weights stay. The fixed point is a stationary point of
///   xi^T P^-1 xi + sum_j c^2 log(1 + d_j^2 / c^2),
/// and each step lowers that sum where the model is linear. The influence of a detection goes to
/// zero as its error grows; as c goes to infinity the result becomes the update without a loss. The
/// start from S lets a hypothesis that is vague compared with the detector follow the detection.
/// The same scaling of a covariance, with another loss, is dynamic covariance scaling (Agarwal et
/// al. 2013); with this loss it is the Cauchy weight of robust pose graphs (Lee et al. 2013).
///
/// `update` computes each step. The likelihood is that under the multiplied covariance.
/// @throws InvalidInput when the scale is not positive, and when there are not as many components
/// as detections
UpdateResult cauchy_update(const Hypothesis& prior, std::span<const Detection> detections,
                           std::span<const NoiseComponent* const> noise, const NoiseUpdate& update,
                           const CauchySettings& settings = {});

}  // namespace posemix
