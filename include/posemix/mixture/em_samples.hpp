// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "posemix/lie/lie.hpp"
#include "posemix/lie/small_angle.hpp"
#include "posemix/mixture/em_rows.hpp"

namespace posemix {

/// Tangent vectors in columns, one coordinate after the other in memory.
template <LieGroup G>
using TangentRows =
    Eigen::Matrix<double, G::Dof, Eigen::Dynamic,
                  G::Dof == 1 ? Eigen::RowMajor | Eigen::AutoAlign : Eigen::RowMajor>;

namespace internal {

/// grad log |det J_l| at xi. It is parallel to the rotation vector, so J_r^-T does not change it.
template <LieGroup G>
struct VolumeGradient;

template <int N>
struct VolumeGradient<Rnd<N>> {
  static typename Rnd<N>::Tangent at(const typename Rnd<N>::Tangent& xi) {
    return Rnd<N>::Tangent::Zero(xi.size());
  }
};

/// d/dphi log(2 (1 - cos t) / t^2) = phi (cot(t/2) - 2/t) / t.
template <>
struct VolumeGradient<SO3d> {
  static Eigen::Vector3d at(const Eigen::Vector3d& phi) {
    return -2.0 * small_angle::inverse_jacobian_coefficients(phi.squaredNorm()).d * phi;
  }
};

template <>
struct VolumeGradient<SE3d> {
  static SE3d::Tangent at(const SE3d::Tangent& xi) {
    SE3d::Tangent gradient = SE3d::Tangent::Zero();
    gradient.head<3>() = 2.0 * VolumeGradient<SO3d>::at(xi.head<3>());
    return gradient;
  }
};

template <>
struct VolumeGradient<PoseStackd> {
  static PoseStackd::Tangent at(const PoseStackd::Tangent& xi) {
    PoseStackd::Tangent gradient(xi.size());
    for (Eigen::Index i = 0; i < xi.size(); i += SE3d::Dof) {
      gradient.segment<6>(i) = VolumeGradient<SE3d>::at(xi.segment<6>(i));
    }
    return gradient;
  }
};

}  // namespace internal

/// Samples of a group for EmModel, with their logarithms about an element, block by block.
template <LieGroup G>
class EmSamples {
 public:
  /// The logarithms of a block.
  struct Block {
    TangentRows<G> tangents;
    Eigen::ArrayXd log_volume;  ///< log |det J_l(xi)|

    const TangentRows<G>& xi() const { return tangents; }
  };

  explicit EmSamples(std::span<const G> elements) : elements_(elements.begin(), elements.end()) {}

  std::size_t size() const { return elements_.size(); }

  /// xi = Log(X centre^-1) of the samples begin, begin + 1, ...
  void log(std::size_t begin, std::size_t count, const G& inverse_centre, Block& block) const {
    const auto columns = static_cast<Eigen::Index>(count);
    block.tangents.resize(inverse_centre.dof(), columns);
    block.log_volume.resize(columns);
    for (Eigen::Index i = 0; i < columns; ++i) {
      const typename G::Tangent xi =
          (elements_[begin + static_cast<std::size_t>(i)] * inverse_centre).log();
      block.tangents.col(i) = xi;
      block.log_volume[i] = G::log_abs_det_left_jacobian(xi);
    }
  }

  /// Adds sum_i shares_i (J_r(xi_i)^-T y_i + grad log |det J_l(xi_i)|).
  static void add_gradient(const Block& block, const TangentRows<G>& y, const EmRow& shares,
                           typename G::Tangent& gradient) {
    for (Eigen::Index i = 0; i < y.cols(); ++i) {
      const double share = shares[static_cast<std::size_t>(i)];
      if (share == 0.0) continue;
      const typename G::Tangent xi = block.tangents.col(i);
      gradient += share * (G::right_jacobian_inverse(xi).transpose() * y.col(i) +
                           internal::VolumeGradient<G>::at(xi));
    }
  }

 private:
  std::vector<G> elements_;
};

}  // namespace posemix
