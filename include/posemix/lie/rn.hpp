// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <fmt/format.h>
#include <Eigen/Core>

#include "posemix/base/error.hpp"

namespace posemix {

/// The vector space R^N under addition; N may be Eigen::Dynamic. Exp and Log are the identity map,
/// Jacobians are I.
template <int N, typename S>
class Rn {
 public:
  using Scalar = S;
  static constexpr int Dof = N;
  using Tangent = Eigen::Matrix<Scalar, N, 1>;
  using TangentMatrix = Eigen::Matrix<Scalar, N, N>;

  /// The zero vector; of dimension zero if N is Dynamic.
  Rn() : value_(Tangent::Zero(N == Eigen::Dynamic ? 0 : N)) {}
  explicit Rn(const Tangent& value) : value_(value) {}

  static Rn exp(const Tangent& xi) { return Rn(xi); }
  Tangent log() const { return value_; }
  const Tangent& value() const { return value_; }

  /// The sum of the vectors.
  /// @throws InvalidInput when the dimensions differ
  Rn operator*(const Rn& other) const {
    if (dof() != other.dof()) {
      throw InvalidInput(
          fmt::format("vectors of dimension {} and {} cannot be added", dof(), other.dof()));
    }
    return Rn(value_ + other.value_);
  }
  Rn inverse() const { return Rn(-value_); }
  Rn identity() const { return Rn(Tangent::Zero(dof())); }
  Eigen::Index dof() const { return value_.size(); }

  TangentMatrix adjoint() const { return unit(dof()); }
  TangentMatrix adjoint_congruence(const TangentMatrix& p) const { return p; }

  static TangentMatrix ad(const Tangent& xi) { return TangentMatrix::Zero(xi.size(), xi.size()); }
  static TangentMatrix left_jacobian(const Tangent& xi) { return unit(xi.size()); }
  static TangentMatrix left_jacobian_inverse(const Tangent& xi) { return unit(xi.size()); }
  static TangentMatrix right_jacobian(const Tangent& xi) { return unit(xi.size()); }
  static TangentMatrix right_jacobian_inverse(const Tangent& xi) { return unit(xi.size()); }
  static Scalar log_abs_det_left_jacobian(const Tangent&) { return Scalar(0); }
  static TangentMatrix left_jacobian_congruence(const Tangent&, const TangentMatrix& p) {
    return p;
  }
  static TangentMatrix left_jacobian_inverse_congruence(const Tangent&, const TangentMatrix& p) {
    return p;
  }

  /// Whether the distance is at most `tol`; false if the dimensions differ.
  bool is_approx(const Rn& other, const Scalar& tol) const {
    return dof() == other.dof() && (value_ - other.value_).norm() <= tol;
  }

 private:
  static TangentMatrix unit(Eigen::Index n) { return TangentMatrix::Identity(n, n); }

  Tangent value_;
};

namespace internal {

/// Whether a group is R^n, all of which is one tangent space.
template <class G>
inline constexpr bool kIsVectorSpace = false;
template <int N, typename S>
inline constexpr bool kIsVectorSpace<Rn<N, S>> = true;

}  // namespace internal

extern template class Rn<3, double>;
extern template class Rn<Eigen::Dynamic, double>;

}  // namespace posemix
