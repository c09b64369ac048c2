// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "lie/pose_kernels.hpp"

#include "base/vector_targets.hpp"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "batch_kernels.cpp"
#include "hwy/foreach_target.h"
//
#include "base/vector_dispatch.hpp"
#include "hwy/highway.h"
#include "lie/pose_rows-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace posemix::internal {
namespace HWY_NAMESPACE {

void inverse_rows(ConstPoseRows x, MutablePoseRows result, std::size_t count) {
  for (std::size_t i = 0; i < count; i += kLanes)
    store_poses(inverse(load_poses(x, i, count)), result, i, count);
}

/// jacobian(xi) for all vectors of tangent vectors.
template <class Jacobian>
HWY_INLINE void dense_rows(ConstRows xi, MutableMatrices result, std::size_t count,
                           const Jacobian& jacobian) {
  const MutableRows rows{result.data, result.stride};
  if (result.by_rows) {
    for (std::size_t i = 0; i < count; i += kLanes)
      store_dense<true>(jacobian(load_tangents(xi, i, count)), rows, i, count);
  } else {
    for (std::size_t i = 0; i < count; i += kLanes)
      store_dense<false>(jacobian(load_tangents(xi, i, count)), rows, i, count);
  }
}

void dense_jacobian_rows(ConstRows xi, MutableMatrices result, std::size_t count) {
  dense_rows(xi, result, count, [](const Tangents& one) HWY_ATTR { return left_jacobian(one); });
}
void dense_inverse_jacobian_rows(ConstRows xi, MutableMatrices result, std::size_t count) {
  dense_rows(xi, result, count,
             [](const Tangents& one) HWY_ATTR { return left_jacobian_inverse(one); });
}

/// Poses with covariances.
struct Densities {
  Poses mean;
  Symmetric covariance;
};
HWY_INLINE Densities load_densities(const ConstDensities& rows, std::size_t i, std::size_t count) {
  return {load_poses(rows.mean, i, count), load_symmetric(rows.covariance, i, count)};
}
HWY_INLINE void store_densities(const Poses& mean, const Symmetric& covariance,
                                const MutableDensities& rows, std::size_t i, std::size_t count) {
  store_poses(mean, rows.mean, i, count);
  store_symmetric(covariance, rows.covariance, i, count);
}

void density_product_rows(ConstDensities x, ConstDensities y, MutableDensities result,
                          std::size_t count) {
  for (std::size_t i = 0; i < count; i += kLanes) {
    const Densities b = load_densities(y, i, count);
    const Poses a = load_poses(x.mean, i, count);
    Symmetric p = congruence(adjoint(a), b.covariance);
    add_scaled(set(1.0), load_symmetric(x.covariance, i, count), p);
    store_densities(product(a, b.mean), p, result, i, count);
  }
}

void density_between_rows(ConstDensities x, ConstDensities y, MutableDensities result,
                          std::size_t count) {
  for (std::size_t i = 0; i < count; i += kLanes) {
    Densities b = load_densities(y, i, count);
    add_scaled(set(1.0), load_symmetric(x.covariance, i, count), b.covariance);
    const Poses back = inverse(load_poses(x.mean, i, count));
    store_densities(product(back, b.mean), congruence(adjoint(back), b.covariance), result, i,
                    count);
  }
}

void density_inverse_rows(ConstDensities x, MutableDensities result, std::size_t count) {
  for (std::size_t i = 0; i < count; i += kLanes) {
    const Densities a = load_densities(x, i, count);
    const Poses back = inverse(a.mean);
    store_densities(back, congruence(adjoint(back), a.covariance), result, i, count);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace posemix::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace posemix::internal {

HWY_EXPORT(inverse_rows);
HWY_EXPORT(dense_jacobian_rows);
HWY_EXPORT(dense_inverse_jacobian_rows);
HWY_EXPORT(density_product_rows);
HWY_EXPORT(density_between_rows);
HWY_EXPORT(density_inverse_rows);

void inverse_of(ConstPoseRows x, MutablePoseRows result, std::size_t count) {
  POSEMIX_DISPATCH(inverse_rows)(x, result, count);
}

void left_jacobian_of(ConstRows xi, MutableMatrices result, std::size_t count) {
  POSEMIX_DISPATCH(dense_jacobian_rows)(xi, result, count);
}

void left_jacobian_inverse_of(ConstRows xi, MutableMatrices result, std::size_t count) {
  POSEMIX_DISPATCH(dense_inverse_jacobian_rows)(xi, result, count);
}

void density_product_of(ConstDensities x, ConstDensities y, MutableDensities result,
                        std::size_t count) {
  POSEMIX_DISPATCH(density_product_rows)(x, y, result, count);
}

void density_between_of(ConstDensities x, ConstDensities y, MutableDensities result,
                        std::size_t count) {
  POSEMIX_DISPATCH(density_between_rows)(x, y, result, count);
}

void density_inverse_of(ConstDensities x, MutableDensities result, std::size_t count) {
  POSEMIX_DISPATCH(density_inverse_rows)(x, result, count);
}

}  // namespace posemix::internal
#endif
