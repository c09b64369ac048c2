// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/lie/pose_stack.hpp"

#include "lie/pose_kernels.hpp"
#include "lie/stack_kernels.hpp"

namespace posemix {
namespace internal {
namespace {

using Blocks = std::vector<TwistMatrix<double>>;

ConstRows tangent_rows(const Eigen::VectorXd& xi) { return {xi.data(), kPoseDof}; }
MutableRows block_rows(TwistMatrix<double>* blocks) {
  return {blocks == nullptr ? nullptr : blocks->a.data(), 18};  // an empty vector may have none
}
static_assert(sizeof(TwistMatrix<double>) == 18 * sizeof(double));

/// Writes the blocks of J_l^-1(xi) from `blocks` on.
void write_inverse_jacobians(const Eigen::VectorXd& xi, TwistMatrix<double>* blocks) {
  left_jacobian_inverse_blocks_of(tangent_rows(xi), block_rows(blocks),
                                  static_cast<std::size_t>(xi.size() / kPoseDof));
}

}  // namespace

Eigen::MatrixXd sum_of(std::span<const MovedCovariance> parts, const Eigen::MatrixXd& d) {
  const auto poses = static_cast<std::size_t>(d.rows() / kPoseDof);
  if (poses == 0) return Eigen::MatrixXd(0, 0);
  Blocks blocks(poses * parts.size());
  std::vector<Congruence> congruences(parts.size());
  for (std::size_t k = 0; k < parts.size(); ++k) {
    TwistMatrix<double>* const own = blocks.data() + k * poses;
    write_inverse_jacobians(*parts[k].xi, own);
    congruences[k] = {own, parts[k].p, parts[k].weight};
  }
  Eigen::MatrixXd sum(d.rows(), d.rows());
  sum_congruences(congruences, d, sum);
  return sum;
}

}  // namespace internal

template <>
PoseStack<double> PoseStack<double>::exp(const Tangent& xi) {
  PoseStack stack(poses_in(xi));
  internal::exp_of(internal::tangent_rows(xi), internal::rows_of(stack.poses_.data()),
                   stack.size());
  return stack;
}

template <>
PoseStack<double>::Tangent PoseStack<double>::log() const {
  Tangent xi(dof());
  internal::log_of(internal::rows_of(poses_.data()), {xi.data(), kPoseDof}, size());
  return xi;
}

template <>
PoseStack<double>::TangentMatrix PoseStack<double>::congruence(const std::vector<Blocks>& blocks,
                                                               const TangentMatrix& p) {
  const Eigen::Index n = offset(blocks.size());
  check_size(p, n);
  TangentMatrix result(n, n);
  const internal::Congruence one{blocks.data(), &p, 1.0};
  internal::sum_congruences(std::span(&one, 1), Eigen::MatrixXd(n, 0), result);
  return result;
}

template <>
PoseStack<double>::TangentMatrix PoseStack<double>::left_jacobian_congruence(
    const Tangent& xi, const TangentMatrix& p) {
  std::vector<Blocks> blocks(poses_in(xi));
  internal::left_jacobian_blocks_of(internal::tangent_rows(xi), internal::block_rows(blocks.data()),
                                    blocks.size());
  return congruence(blocks, p);
}

template <>
PoseStack<double>::TangentMatrix PoseStack<double>::left_jacobian_inverse_congruence(
    const Tangent& xi, const TangentMatrix& p) {
  std::vector<Blocks> blocks(poses_in(xi));
  internal::left_jacobian_inverse_blocks_of(internal::tangent_rows(xi),
                                            internal::block_rows(blocks.data()), blocks.size());
  return congruence(blocks, p);
}

template class PoseStack<double>;

}  // namespace posemix
