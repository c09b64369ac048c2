// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <vector>

#include "posemix/divergence/estimate.hpp"
#include "posemix/mixture/operations.hpp"

/// Divergences between densities on SO(3) by deterministic quadrature (midway-merge paper, eq. 25):
/// over the ball |xi| <= pi, which covers every rotation once (a cube covers some twice), with the
/// exact logarithm and the Haar measure dX = |det J_l(xi)| dxi [rad^3], total volume 8 pi^2.
///
/// Densities are those of ConcentratedGaussian: they are not renormalised for the Gaussian mass
/// beyond |xi| = pi. If that mass matters, a Kullback-Leibler divergence can be negative.
///
/// Method: the integrand is written as sum_k v_k N_k G over components k (G = log(p/q) or p - q, or
/// if that cancels a form that is never negative), and every part is integrated over the tangent
/// ball of its own component in coordinates that whiten N_k. Where G is smooth in the whole ball,
/// the trapezoidal rule converges exponentially \cite trefethen2014trapezoidal: on ever finer
/// body-centred cubic lattices, or, if the densities have a common axis of symmetry, which is found
/// automatically, in the half-plane beside it with radii at zeros of a Bessel function \cite
/// ogata2005bessel. Elsewhere, and where a component is very narrow, it is adaptive cubature over
/// the directions, and adaptive Gauss-Kronrod along each ray out to 9 standard deviations. A ray is
/// cut where it crosses the cut locus (angle pi) of any component, which is the zero of one
/// sinusoid, and where it passes a narrow component. Errors are estimated from pairs of rules, and
/// raised if the halves of a cell disagree with the whole \cite berntsen1991adaptive; they are
/// estimates, not bounds. Points are evaluated many at once by the widest vector instructions of
/// the machine, so that the last digits depend on these.
namespace posemix {

/// A density or a mixture on SO(3); both convert implicitly.
class RotationDensity {
 public:
  using Peak = ConcentratedGaussian<SO3d>;

  // NOLINTNEXTLINE(google-explicit-constructor,hicpp-explicit-conversions): one signature for both
  RotationDensity(const Peak& peak) : components_{{0.0, peak}} {}
  // NOLINTNEXTLINE(google-explicit-constructor,hicpp-explicit-conversions): one signature for both
  RotationDensity(const Mixture<Peak>& mixture) : components_(mixture.components()) {}

  const std::vector<Component<Peak>>& components() const { return components_; }

 private:
  std::vector<Component<Peak>> components_;
};

/// Stopping criteria of the quadrature.
struct RotationQuadratureSettings {
  double relative_tolerance = 1e-6;          ///< largest ratio of the estimated error to the value
  std::size_t max_evaluations = 20'000'000;  ///< the refinement stops at this many evaluations
};

/// Kullback-Leibler divergence D(p || q) = int p log(p/q) dX [nats].
///
/// If the densities are so close that int p log(p/q) cancels, the non-negative form int (p log(p/q)
/// - p + q) dX is integrated instead, and the difference of the masses is added. Log densities are
/// exact to about 4e-15, so the error is never below 4e-15 sqrt(2 D).
/// @throws InvalidInput when the tolerance is not positive
DivergenceEstimate kl(const RotationDensity& p, const RotationDensity& q,
                      const RotationQuadratureSettings& settings = {});

/// D(p || q) + D(q || p) = int (p - q) log(p/q) dX [nats], never negative.
/// @throws InvalidInput when the tolerance is not positive
DivergenceEstimate symmetric_kl(const RotationDensity& p, const RotationDensity& q,
                                const RotationQuadratureSettings& settings = {});

/// Integral square distance int (p - q)^2 dX [rad^-3].
/// @throws InvalidInput when the tolerance is not positive
DivergenceEstimate isd(const RotationDensity& p, const RotationDensity& q,
                       const RotationQuadratureSettings& settings = {});

}  // namespace posemix
