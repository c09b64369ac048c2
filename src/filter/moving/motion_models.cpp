// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/filter/motion_models.hpp"

#include <cmath>

#include <fmt/format.h>

#include "posemix/base/error.hpp"
#include "posemix/base/range.hpp"

namespace posemix {
namespace {

void check_rates(const MotionModels& models) {
  const auto n = static_cast<Eigen::Index>(models.models.size());
  const Eigen::MatrixXd& rates = models.rates;
  if (rates.size() == 0) return;
  if (rates.rows() != n || rates.cols() != n) {
    throw InvalidInput(fmt::format("the rates between models are {} x {}, expected {} x {}",
                                   rates.rows(), rates.cols(), n, n));
  }
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) {
      if (i != j)
        kNotNegative.check(rates(i, j), fmt::format("the rate from model {} to {}", i, j));
    }
  }
}

void check_start(const MotionModels& models) {
  if (models.start.empty()) return;
  if (models.start.size() != models.models.size()) {
    throw InvalidInput(fmt::format("{} probabilities for {} motion models", models.start.size(),
                                   models.models.size()));
  }
  double sum = 0.0;
  for (const double probability : models.start) {
    kUnitInterval.check(probability, "the probability of a motion model");
    sum += probability;
  }
  if (!(std::abs(sum - 1.0) < 1e-6)) {
    throw InvalidInput(
        fmt::format("the probabilities of the motion models sum to {:.6g}, expected one", sum));
  }
}

}  // namespace

MotionModels calm_and_agile(const ConstantVelocityMotion& calm) {
  ConstantVelocityMotion agile = calm;
  agile.acceleration_sds *= 5.0;
  return {.models = {calm, agile},
          .rates = (Eigen::MatrixXd(2, 2) << 0.0, 1.0, 3.0, 0.0).finished(),
          .start = {0.75, 0.25}};
}

void validate(const MotionModels& models) {
  require(!models.models.empty(), "there is no motion model, expected at least one");
  for (const ObjectMotion& motion : models.models) validate(motion);
  check_rates(models);
  check_start(models);
}

}  // namespace posemix
