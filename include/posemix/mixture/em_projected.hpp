// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <span>
#include <vector>

#include "posemix/density/projected_gaussian.hpp"
#include "posemix/mixture/density_kernel.hpp"
#include "posemix/mixture/em.hpp"

namespace posemix {

/// Projected Gaussians under EM, as PG_0: the tangent point q0 is the mode, and the Gaussian of
/// y = [u; t] has E u = 0. With weights r, sum W, the expected log-likelihood of a component is
///   sum r log N(y; [0; a], P) - W log C(P_uu) + const.
/// For a given q0 it falls into two parts (MPG paper, section IV, has neither C in the shares nor
/// this M-step). P_uu is the one whose distribution has the samples' second moment
/// (`projected_covariance_of_moment`), and t = a + B u + e, e ~ N(0, R), is a linear regression;
/// P_tu = B P_uu, P_tt = R + B P_uu B^T.
///
/// Moving the tangent point by d, q0 (1, d) / sqrt(1 + d.d), changes u by -(I - u^ + u u^T) d, so
/// the gradient is
///   g = sum r (s + u x s + u (u.s)),  s = (P^-1 (y - [0; a]))_u,
/// and d = H^-1 g, where H is the expected negative second derivative; its fourth moments are those
/// of a Gaussian times a factor. The moments at the new tangent point are approximated by those of
/// (I - d^)(u - d) / (1 + d.d). Without a step the M-step is exact.
///
/// Settings: `min_sd` and `max_sd` bound P_uu and R, so that the maximum keeps its closed form. The
/// first three units are units of the rotation angle, of which |u| is about half: a bound of b in
/// units of 1 rad bounds the standard deviations of u by b / 2. These units have to be equal unless
/// `diagonal` is set. No variance of u exceeds 1e4, at which the distribution is uniform but for 3
/// parts in 1e3. A component counts as collapsed when a spread lies on the lower bound and is less
/// than 1e-3 of the largest: it has too few samples to span all directions. `diagonal` refers to
/// the axes that q0 rotates, so its result depends on the frame of the object. A start whose
/// tangent point is not its mode is first moved to the chart at the mode.
template <RotationOrPose G>
struct EmModel<ProjectedGaussian<G>> {
  using Density = ProjectedGaussian<G>;
  using Tangent = typename G::Tangent;
  using Covariance = typename G::TangentMatrix;
  using Samples = EmCoordinates;

  class Worker {
   public:
    Worker(const Density& density, const EmSettings& settings);

    void log_density(const Samples& samples, std::size_t begin, std::size_t count, EmRow& out);
    void accumulate(const EmRow& shares);
    double weight() const { return sums_.total(0); }
    Density update(double step) const;

    /// The rows of y less its mean for the current block.
    const std::vector<EmRow>& rows() const { return rows_; }

   private:
    Eigen::Vector3d move(const Tangent& first, const Covariance& second) const;

    Density density_;
    const EmSettings* settings_;
    internal::ProjectedKernel kernel_;
    std::vector<EmRow> rows_;
    std::size_t count_ = 0;
    internal::EmSums<28> sums_;
    internal::EmSums<4> gradient_;  ///< sum r u (u.s) and sum r u.u (u.s)
  };

  static Density start(std::span<const G> elements, std::span<const double> weights,
                       const EmSettings& settings, const Density* prior);
  static double squared_distance(const Density& density, const G& a, const G& b);
  static Density stretched(const Density& density, const Eigen::VectorXd& factors);
  static std::size_t parameters(Eigen::Index dof, const EmSettings& settings);
  static bool on_lower_bound(const Density& density, const EmSettings& settings);
  /// A component of the given start as PG_0, within the bounds of the settings.
  /// @throws InvalidInput for units that differ
  static Density prepared(const Density& density, const EmSettings& settings);
};

namespace internal {

/// The covariance P_uu of largest likelihood for the second moment E[u u^T]; its eigenvalues (or
/// its diagonal entries) are within bounds.
Eigen::Matrix3d bounded_projected_covariance(const Eigen::Matrix3d& second_moment,
                                             const EmSettings& settings);
/// A covariance P_uu whose eigenvalues (or diagonal entries) beyond the bounds are put on them.
Eigen::Matrix3d clipped_projected_covariance(const Eigen::Matrix3d& covariance,
                                             const EmSettings& settings);

}  // namespace internal

extern template struct EmModel<ProjectedGaussian<SO3d>>;
extern template struct EmModel<ProjectedGaussian<SE3d>>;

extern template EmResult<ProjectedGaussian<SO3d>> fit_mixture(
    std::span<const SO3d>, std::span<const double>, const EmSettings&, RandomStream&,
    const std::optional<Mixture<ProjectedGaussian<SO3d>>>&);
extern template EmResult<ProjectedGaussian<SE3d>> fit_mixture(
    std::span<const SE3d>, std::span<const double>, const EmSettings&, RandomStream&,
    const std::optional<Mixture<ProjectedGaussian<SE3d>>>&);

}  // namespace posemix
