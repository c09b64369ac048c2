// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/lie/batch.hpp"

#include <algorithm>
#include <thread>
#include <vector>

#include <fmt/format.h>

#include "lie/pose_kernels.hpp"
#include "posemix/base/error.hpp"

namespace posemix {
namespace internal {
namespace {

/// A thread has at least so many rows, so that its start, some tens of microseconds, pays.
constexpr std::size_t kLeastRows = 8192;

}  // namespace

void for_parts(std::size_t count, std::size_t threads,
               const std::function<void(std::size_t, std::size_t)>& part) {
  if (count == 0) return;
  const std::size_t wanted = threads > 0 ? threads : std::thread::hardware_concurrency();
  const std::size_t parts =
      std::clamp<std::size_t>(count / kLeastRows, 1, std::max<std::size_t>(wanted, 1));
  const auto begin_of = [&](std::size_t k) {
    return count / parts * k + std::min(k, count % parts);
  };
  std::vector<std::jthread> others;
  others.reserve(parts - 1);
  for (std::size_t k = 1; k < parts; ++k)
    others.emplace_back([&, k] { part(begin_of(k), begin_of(k + 1) - begin_of(k)); });
  part(0, begin_of(1));
}

}  // namespace internal

namespace batch {
namespace {

using internal::by_parts;
using internal::ConstDensities;
using internal::ConstPoseRows;
using internal::ConstRows;
using internal::MutableDensities;
using internal::MutableMatrices;
using internal::MutablePoseRows;
using internal::MutableRows;

/// The numbers of vectors or matrices; of none there is no object to ask.
template <class T>
auto numbers(std::span<T> x) {
  return x.empty() ? nullptr : x.front().data();
}

ConstRows rows_of(std::span<const Eigen::Vector3d> x) { return {numbers(x), 3}; }
MutableRows rows_of(std::span<Eigen::Vector3d> x) { return {numbers(x), 3}; }
ConstRows rows_of(std::span<const Vector6d> x) { return {numbers(x), 6}; }
MutableRows rows_of(std::span<Vector6d> x) { return {numbers(x), 6}; }
ConstRows rows_of(std::span<const Matrix6d> x) { return {numbers(x), 36}; }
MutableRows rows_of(std::span<Matrix6d> x) { return {numbers(x), 36}; }
MutableRows rows_of(std::span<TwistMatrix<double>> x) {
  return {x.empty() ? nullptr : x.front().a.data(), 18};
}
ConstPoseRows rows_of(std::span<const SE3d> x) {
  return x.empty() ? ConstPoseRows{} : internal::rows_of(x.data());
}
MutablePoseRows rows_of(std::span<SE3d> x) {
  return x.empty() ? MutablePoseRows{} : internal::rows_of(x.data());
}
MutableMatrices matrices_of(std::span<Eigen::Matrix3d> x) { return {numbers(x), 9, false}; }
MutableMatrices matrices_of(std::span<Matrix6d> x) { return {numbers(x), 36, false}; }

constexpr std::size_t kRotationStride = sizeof(SO3d) / sizeof(double);
const double* numbers(std::span<const SO3d> x) {
  return x.empty() ? nullptr : x.front().quaternion().coeffs().data();
}
ConstRows rows_of(std::span<const SO3d> x) { return {numbers(x), kRotationStride}; }
MutableRows rows_of(std::span<SO3d> x) {
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-const-cast): SO3 has no access to its numbers
  return {const_cast<double*>(numbers(std::span<const SO3d>(x))), kRotationStride};
}

ConstDensities rows_of(const UncertainPoses& x) { return {rows_of(x.mean), rows_of(x.covariance)}; }
MutableDensities rows_of(const UncertainPosesResult& x) {
  return {rows_of(x.mean), rows_of(x.covariance)};
}

/// @throws InvalidInput when the others have not as many items as the first
template <class... Counts>
void require_as_many(std::size_t count, Counts... others) {
  for (const std::size_t other : {static_cast<std::size_t>(others)...}) {
    if (other != count) {
      throw InvalidInput(
          fmt::format("batch of {} items with an array of {}; expected as many", count, other));
    }
  }
}

}  // namespace

void exp(std::span<const Eigen::Vector3d> phi, std::span<SO3d> result, std::size_t threads) {
  require_as_many(phi.size(), result.size());
  by_parts(internal::so3_exp_of, phi.size(), threads, rows_of(phi), rows_of(result));
}
void exp(std::span<const Vector6d> xi, std::span<SE3d> result, std::size_t threads) {
  require_as_many(xi.size(), result.size());
  by_parts(internal::exp_of, xi.size(), threads, rows_of(xi), rows_of(result));
}

void log(std::span<const SO3d> x, std::span<Eigen::Vector3d> result, std::size_t threads) {
  require_as_many(x.size(), result.size());
  by_parts(internal::so3_log_of, x.size(), threads, rows_of(x), rows_of(result));
}
void log(std::span<const SE3d> x, std::span<Vector6d> result, std::size_t threads) {
  require_as_many(x.size(), result.size());
  by_parts(internal::log_of, x.size(), threads, rows_of(x), rows_of(result));
}

void left_jacobian(std::span<const Eigen::Vector3d> phi, std::span<Eigen::Matrix3d> result,
                   std::size_t threads) {
  require_as_many(phi.size(), result.size());
  by_parts(internal::so3_left_jacobian_of, phi.size(), threads, rows_of(phi), matrices_of(result));
}
void left_jacobian(std::span<const Vector6d> xi, std::span<Matrix6d> result, std::size_t threads) {
  require_as_many(xi.size(), result.size());
  by_parts(internal::left_jacobian_of, xi.size(), threads, rows_of(xi), matrices_of(result));
}
void left_jacobian(std::span<const Vector6d> xi, std::span<TwistMatrix<double>> result,
                   std::size_t threads) {
  require_as_many(xi.size(), result.size());
  by_parts(internal::left_jacobian_blocks_of, xi.size(), threads, rows_of(xi), rows_of(result));
}

void left_jacobian_inverse(std::span<const Eigen::Vector3d> phi, std::span<Eigen::Matrix3d> result,
                           std::size_t threads) {
  require_as_many(phi.size(), result.size());
  by_parts(internal::so3_left_jacobian_inverse_of, phi.size(), threads, rows_of(phi),
           matrices_of(result));
}
void left_jacobian_inverse(std::span<const Vector6d> xi, std::span<Matrix6d> result,
                           std::size_t threads) {
  require_as_many(xi.size(), result.size());
  by_parts(internal::left_jacobian_inverse_of, xi.size(), threads, rows_of(xi),
           matrices_of(result));
}
void left_jacobian_inverse(std::span<const Vector6d> xi, std::span<TwistMatrix<double>> result,
                           std::size_t threads) {
  require_as_many(xi.size(), result.size());
  by_parts(internal::left_jacobian_inverse_blocks_of, xi.size(), threads, rows_of(xi),
           rows_of(result));
}

void compose(std::span<const SO3d> x, std::span<const SO3d> y, std::span<SO3d> result,
             std::size_t threads) {
  require_as_many(x.size(), y.size(), result.size());
  by_parts(internal::so3_product_of, x.size(), threads, rows_of(x), rows_of(y), rows_of(result));
}
void compose(std::span<const SE3d> x, std::span<const SE3d> y, std::span<SE3d> result,
             std::size_t threads) {
  require_as_many(x.size(), y.size(), result.size());
  by_parts(internal::product_of, x.size(), threads, rows_of(x), rows_of(y), rows_of(result));
}

void inverse(std::span<const SO3d> x, std::span<SO3d> result, std::size_t threads) {
  require_as_many(x.size(), result.size());
  by_parts(internal::so3_inverse_of, x.size(), threads, rows_of(x), rows_of(result));
}
void inverse(std::span<const SE3d> x, std::span<SE3d> result, std::size_t threads) {
  require_as_many(x.size(), result.size());
  by_parts(internal::inverse_of, x.size(), threads, rows_of(x), rows_of(result));
}

void adjoint_congruence(std::span<const SE3d> x, std::span<const Matrix6d> p,
                        std::span<Matrix6d> result, std::size_t threads) {
  require_as_many(x.size(), p.size(), result.size());
  by_parts(internal::adjoint_congruence_of, x.size(), threads, rows_of(x), rows_of(p),
           rows_of(result));
}

void compose(const UncertainPoses& x, const UncertainPoses& y, const UncertainPosesResult& result,
             std::size_t threads) {
  require_as_many(x.mean.size(), x.covariance.size(), y.mean.size(), y.covariance.size(),
                  result.mean.size(), result.covariance.size());
  by_parts(internal::density_product_of, x.mean.size(), threads, rows_of(x), rows_of(y),
           rows_of(result));
}
void between(const UncertainPoses& x, const UncertainPoses& y, const UncertainPosesResult& result,
             std::size_t threads) {
  require_as_many(x.mean.size(), x.covariance.size(), y.mean.size(), y.covariance.size(),
                  result.mean.size(), result.covariance.size());
  by_parts(internal::density_between_of, x.mean.size(), threads, rows_of(x), rows_of(y),
           rows_of(result));
}
void inverse(const UncertainPoses& x, const UncertainPosesResult& result, std::size_t threads) {
  require_as_many(x.mean.size(), x.covariance.size(), result.mean.size(), result.covariance.size());
  by_parts(internal::density_inverse_of, x.mean.size(), threads, rows_of(x), rows_of(result));
}

}  // namespace batch
}  // namespace posemix
