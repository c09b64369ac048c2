// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cmath>

#include "reduction/pair_kernels.hpp"

namespace posemix::internal {

ComponentColumns::ComponentColumns(std::size_t slots)
    : stride_(slots + kRoom), numbers_(kPoseFields * stride_) {}

void ComponentColumns::set(std::size_t slot,
                           const Component<ConcentratedGaussian<SE3d>>& component) {
  double* field = &numbers_[slot];
  const auto put = [&](double value) {
    *field = value;
    field += stride_;
  };
  const SE3d& mean = component.density.mean();
  const Matrix6d& p = component.density.covariance();
  for (const double value : mean.rotation().quaternion().coeffs()) put(value);
  for (const double value : mean.translation()) put(value);
  for (Eigen::Index column = 0; column < 6; ++column) {
    for (Eigen::Index row = column; row < 6; ++row) put(p(row, column));
  }
  put(log_det(Eigen::LLT<Matrix6d>(p)));
  put(std::exp(component.log_weight));
}

void ComponentColumns::renumber(const std::vector<std::size_t>& slots) {
  for (std::size_t k = 0; k < kPoseFields; ++k) {
    double* const field = &numbers_[k * stride_];
    for (std::size_t i = 0; i < slots.size(); ++i) field[i] = field[slots[i]];
  }
}

void ComponentColumns::costs(PairRule rule, DistanceMetric metric, std::size_t slot,
                             std::size_t count, double* costs) const {
  double one[kPoseFields];
  for (std::size_t k = 0; k < kPoseFields; ++k) one[k] = numbers_[k * stride_ + slot];
  pair_costs(rule, metric, one, numbers_.data(), stride_, count, costs);
}

}  // namespace posemix::internal
