// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <Eigen/Core>

#include "posemix/base/error.hpp"
#include "posemix/base/range.hpp"
#include "posemix/lie/pose_blocks.hpp"
#include "posemix/lie/se3.hpp"

namespace posemix {

/// SE(3)^n, the poses of n bodies, with n known at run time. Tangent: [phi_1; rho_1; phi_2; rho_2;
/// ...] in rad and metres.
///
/// Adjoint and Jacobians are block-diagonal. The dense matrices are for inspection and tests; the
/// congruences work block by block in O(n^2). Functions of two stacks, of a tangent vector or of an
/// index throw InvalidInput if it does not fit. Assigning a stack of the same size allocates
/// nothing. In double precision, functions of all poses use vector instructions; the templates here
/// are their reference.
template <typename S>
class PoseStack {
 public:
  using Scalar = S;
  using Pose = SE3<Scalar>;
  static constexpr int Dof = Eigen::Dynamic;
  using Tangent = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;
  using TangentMatrix = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;

  /// The empty stack.
  PoseStack() = default;
  /// A stack of `size` identities.
  explicit PoseStack(std::size_t size) : poses_(checked_size(size)) {}
  explicit PoseStack(std::vector<Pose> poses) : poses_(std::move(poses)) {}

  std::size_t size() const { return poses_.size(); }
  const Pose& operator[](std::size_t i) const {
    internal::check_index(i, size(), "pose");
    return poses_[i];
  }
  Pose& operator[](std::size_t i) {
    internal::check_index(i, size(), "pose");
    return poses_[i];
  }
  void push_back(const Pose& pose) { poses_.push_back(pose); }
  const std::vector<Pose>& poses() const { return poses_; }
  auto begin() const { return poses_.begin(); }
  auto end() const { return poses_.end(); }

  static PoseStack exp(const Tangent& xi);
  Tangent log() const;
  PoseStack operator*(const PoseStack& other) const;
  PoseStack inverse() const;
  PoseStack identity() const { return PoseStack(size()); }
  Eigen::Index dof() const { return Pose::Dof * static_cast<Eigen::Index>(size()); }

  TangentMatrix adjoint() const;
  static TangentMatrix ad(const Tangent& xi);
  static TangentMatrix left_jacobian(const Tangent& xi);
  static TangentMatrix left_jacobian_inverse(const Tangent& xi);
  static TangentMatrix right_jacobian(const Tangent& xi) { return left_jacobian(-xi); }
  static TangentMatrix right_jacobian_inverse(const Tangent& xi) {
    return left_jacobian_inverse(-xi);
  }

  /// log |det J_l|, the sum over the poses.
  static Scalar log_abs_det_left_jacobian(const Tangent& xi);

  /// Ad P Ad^T for a symmetric P; only the 6x6 blocks of P on and above the diagonal are read.
  TangentMatrix adjoint_congruence(const TangentMatrix& p) const;
  /// J_l P J_l^T for a symmetric P; only the 6x6 blocks of P on and above the diagonal are read.
  static TangentMatrix left_jacobian_congruence(const Tangent& xi, const TangentMatrix& p);
  /// J_l^-1 P J_l^-T for a symmetric P; only the 6x6 blocks of P on and above the diagonal are
  /// read.
  static TangentMatrix left_jacobian_inverse_congruence(const Tangent& xi, const TangentMatrix& p);

  /// sum += weight J_l^-1 P J_l^-T for a symmetric P; only the 6x6 blocks of P on and above the
  /// diagonal are read. Allocates no memory of the size of P.
  static void add_left_jacobian_inverse_congruence(const Tangent& xi, const TangentMatrix& p,
                                                   const Scalar& weight, TangentMatrix& sum);

  /// Ad xi, the adjoint applied to a tangent vector.
  Tangent adjoint_times(const Tangent& xi) const;

  /// Whether every pose is approximately equal to its counterpart (see SE3::is_approx); false if
  /// the sizes differ.
  bool is_approx(const PoseStack& other, const Scalar& tol) const;

 private:
  using Blocks = TwistMatrix<Scalar>;

  static std::size_t checked_size(std::size_t size) {
    internal::check_count(size, "size");
    return size;
  }

  static std::size_t poses_in(const Tangent& xi) {
    if (xi.size() % Pose::Dof != 0) {
      throw InvalidInput(fmt::format(
          "tangent vector of a pose stack has {} entries; expected a multiple of 6", xi.size()));
    }
    return static_cast<std::size_t>(xi.size() / Pose::Dof);
  }

  void check_same_size(const PoseStack& other) const {
    if (size() == other.size()) return;
    throw InvalidInput(
        fmt::format("pose stacks of {} and {} poses cannot be multiplied", size(), other.size()));
  }

  template <typename Function>
  static TangentMatrix block_diagonal(const Tangent& xi, Function function) {
    TangentMatrix m = TangentMatrix::Zero(xi.size(), xi.size());
    for (std::size_t i = 0, n = poses_in(xi); i < n; ++i) {
      block(m, i, i) = function(segment(xi, i));
    }
    return m;
  }

  template <typename Function>
  static std::vector<Blocks> blocks_of(const Tangent& xi, Function function) {
    std::vector<Blocks> blocks(poses_in(xi));
    for (std::size_t i = 0; i < blocks.size(); ++i) blocks[i] = function(segment(xi, i));
    return blocks;
  }

  static void check_size(const TangentMatrix& p, Eigen::Index n) {
    if (p.rows() != n || p.cols() != n) {
      throw InvalidInput(
          fmt::format("covariance is {}x{}; expected {}x{}", p.rows(), p.cols(), n, n));
    }
  }

  /// Calls use(row, column, values) for every 6x6 block of B P B^T on and above the diagonal, where
  /// B is the block-diagonal matrix of `blocks`, and row and column are indices of poses.
  template <typename Use>
  static void for_each_block(const std::vector<Blocks>& blocks, const TangentMatrix& p, Use use) {
    for (std::size_t j = 0; j < blocks.size(); ++j) {
      for (std::size_t i = 0; i < j; ++i) {
        use(i, j, blocks[i].sandwich(block(p, i, j), blocks[j]));
      }
      use(j, j, blocks[j].congruence(block(p, j, j)));
    }
  }

  static TangentMatrix congruence(const std::vector<Blocks>& blocks, const TangentMatrix& p);

  std::vector<Pose> poses_;
};

template <typename S>
PoseStack<S> PoseStack<S>::exp(const Tangent& xi) {
  PoseStack stack(poses_in(xi));
  for (std::size_t i = 0; i < stack.size(); ++i) stack[i] = Pose::exp(segment(xi, i));
  return stack;
}

template <typename S>
typename PoseStack<S>::Tangent PoseStack<S>::log() const {
  Tangent xi(dof());
  for (std::size_t i = 0; i < size(); ++i) {
    segment(xi, i) = poses_[i].log();
  }
  return xi;
}

template <typename S>
PoseStack<S> PoseStack<S>::operator*(const PoseStack& other) const {
  check_same_size(other);
  PoseStack product(size());
  for (std::size_t i = 0; i < size(); ++i) product[i] = poses_[i] * other[i];
  return product;
}

template <typename S>
PoseStack<S> PoseStack<S>::inverse() const {
  PoseStack result(size());
  for (std::size_t i = 0; i < size(); ++i) result[i] = poses_[i].inverse();
  return result;
}

template <typename S>
typename PoseStack<S>::TangentMatrix PoseStack<S>::adjoint() const {
  TangentMatrix m = TangentMatrix::Zero(dof(), dof());
  for (std::size_t i = 0; i < size(); ++i) {
    block(m, i, i) = poses_[i].adjoint();
  }
  return m;
}

template <typename S>
S PoseStack<S>::log_abs_det_left_jacobian(const Tangent& xi) {
  Scalar sum(0);
  for (std::size_t i = 0, n = poses_in(xi); i < n; ++i) {
    sum += Pose::log_abs_det_left_jacobian(segment(xi, i));
  }
  return sum;
}

template <typename S>
typename PoseStack<S>::TangentMatrix PoseStack<S>::adjoint_congruence(
    const TangentMatrix& p) const {
  std::vector<Blocks> blocks(size());
  for (std::size_t i = 0; i < size(); ++i) blocks[i] = poses_[i].adjoint_blocks();
  return congruence(blocks, p);
}

template <typename S>
typename PoseStack<S>::Tangent PoseStack<S>::adjoint_times(const Tangent& xi) const {
  if (poses_in(xi) != size()) {
    throw InvalidInput(fmt::format("tangent vector of {} entries for {} poses; expected {}",
                                   xi.size(), size(), dof()));
  }
  Tangent result(dof());
  for (std::size_t i = 0; i < size(); ++i) {
    segment(result, i) = poses_[i].adjoint_blocks().times(typename Pose::Tangent(segment(xi, i)));
  }
  return result;
}

template <typename S>
typename PoseStack<S>::TangentMatrix PoseStack<S>::congruence(const std::vector<Blocks>& blocks,
                                                              const TangentMatrix& p) {
  const Eigen::Index n = offset(blocks.size());
  check_size(p, n);
  TangentMatrix m(n, n);
  for_each_block(blocks, p,
                 [&](std::size_t row, std::size_t column, const typename Blocks::Dense& values) {
                   block(m, row, column) = values;
                   if (row != column) block(m, column, row) = values.transpose();
                 });
  return m;
}

template <typename S>
typename PoseStack<S>::TangentMatrix PoseStack<S>::ad(const Tangent& xi) {
  return block_diagonal(xi, &Pose::ad);
}

template <typename S>
typename PoseStack<S>::TangentMatrix PoseStack<S>::left_jacobian(const Tangent& xi) {
  return block_diagonal(xi, &Pose::left_jacobian);
}

template <typename S>
typename PoseStack<S>::TangentMatrix PoseStack<S>::left_jacobian_inverse(const Tangent& xi) {
  return block_diagonal(xi, &Pose::left_jacobian_inverse);
}

template <typename S>
typename PoseStack<S>::TangentMatrix PoseStack<S>::left_jacobian_congruence(
    const Tangent& xi, const TangentMatrix& p) {
  return congruence(blocks_of(xi, &Pose::left_jacobian_blocks), p);
}

template <typename S>
typename PoseStack<S>::TangentMatrix PoseStack<S>::left_jacobian_inverse_congruence(
    const Tangent& xi, const TangentMatrix& p) {
  return congruence(blocks_of(xi, &Pose::left_jacobian_inverse_blocks), p);
}

template <typename S>
void PoseStack<S>::add_left_jacobian_inverse_congruence(const Tangent& xi, const TangentMatrix& p,
                                                        const Scalar& weight, TangentMatrix& sum) {
  check_size(p, xi.size());
  check_size(sum, xi.size());
  const std::vector<Blocks> blocks = blocks_of(xi, &Pose::left_jacobian_inverse_blocks);
  for_each_block(blocks, p,
                 [&](std::size_t row, std::size_t column, const typename Blocks::Dense& values) {
                   block(sum, row, column) += weight * values;
                   if (row != column) block(sum, column, row) += weight * values.transpose();
                 });
}

template <typename S>
bool PoseStack<S>::is_approx(const PoseStack& other, const Scalar& tol) const {
  if (size() != other.size()) return false;
  for (std::size_t i = 0; i < size(); ++i) {
    if (!poses_[i].is_approx(other[i], tol)) return false;
  }
  return true;
}

template <>
PoseStack<double> PoseStack<double>::exp(const Tangent& xi);
template <>
PoseStack<double>::Tangent PoseStack<double>::log() const;
template <>
PoseStack<double>::TangentMatrix PoseStack<double>::congruence(const std::vector<Blocks>& blocks,
                                                               const TangentMatrix& p);
template <>
PoseStack<double>::TangentMatrix PoseStack<double>::left_jacobian_congruence(
    const Tangent& xi, const TangentMatrix& p);
template <>
PoseStack<double>::TangentMatrix PoseStack<double>::left_jacobian_inverse_congruence(
    const Tangent& xi, const TangentMatrix& p);

extern template class PoseStack<double>;

namespace internal {

/// weight J_l^-1(xi) P J_l^-T(xi).
struct MovedCovariance {
  const Eigen::VectorXd* xi;
  const Eigen::MatrixXd* p;
  double weight;
};

/// The sum of the moved covariances of a stack and of D D^T; exactly symmetric.
Eigen::MatrixXd sum_of(std::span<const MovedCovariance> parts, const Eigen::MatrixXd& d);

}  // namespace internal

}  // namespace posemix
