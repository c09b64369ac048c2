// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/grasp/consensus.hpp"

#include <cmath>

#include <fmt/format.h>

#include "posemix/base/error.hpp"
#include "posemix/base/range.hpp"

namespace posemix {
namespace {

void check_weights(const PoseConsensus& consensus) {
  const auto draws = static_cast<Eigen::Index>(consensus.truths.size());
  if (draws > 0 && consensus.weights.size() == draws) return;
  throw InvalidInput(
      fmt::format("a consensus of {} draws with {} weights", draws, consensus.weights.size()));
}

}  // namespace

PoseConsensus fuse_estimates(std::span<const ConsensusMember> members,
                             const ConsensusSettings& settings, RandomStream& stream) {
  require(!members.empty(), "a consensus needs at least one estimate");
  require(settings.draws_per_member > 0, "a consensus needs at least one draw per estimate");
  internal::check_count(settings.draws_per_member, "consensus: draws_per_member");
  require(settings.correlation >= 0.0 && settings.correlation <= 1.0,
          "correlation of estimates outside [0, 1]");
  for (const ConsensusMember& member : members)
    require(member.errors != nullptr, "an estimate of a consensus is without its errors");
  const auto count = static_cast<double>(members.size());
  const double power = 1.0 / (1.0 + (count - 1.0) * settings.correlation);
  PoseConsensus consensus;
  consensus.truths.reserve(members.size() * settings.draws_per_member);
  for (const ConsensusMember& member : members) {
    for (std::size_t i = 0; i < settings.draws_per_member; ++i) {
      consensus.truths.push_back(truth_with_error(member.estimate, member.errors->sample(stream)));
    }
  }
  Eigen::ArrayXd log_weights(static_cast<Eigen::Index>(consensus.truths.size()));
  std::vector<double> terms(members.size());
  for (std::size_t i = 0; i < consensus.truths.size(); ++i) {
    double product = 0.0;
    for (std::size_t j = 0; j < members.size(); ++j) {
      terms[j] = members[j].errors->log_pose_density(
          sight_error(members[j].estimate, consensus.truths[i]));
      product += terms[j];
    }
    log_weights[static_cast<Eigen::Index>(i)] = power * product - log_sum_exp(terms);
  }
  consensus.weights = (log_weights - log_weights.maxCoeff()).exp();
  consensus.weights /= consensus.weights.sum();
  return consensus;
}

PoseConsensus PoseConsensus::resampled(std::size_t count) const {
  require(count > 0, "resampling to no draw");
  internal::check_count(count, "count");
  check_weights(*this);
  PoseConsensus result;
  result.truths.reserve(count);
  const double step = 1.0 / static_cast<double>(count);
  double next = 0.5 * step;
  double sum = 0.0;
  for (std::size_t i = 0; i < truths.size() && result.truths.size() < count; ++i) {
    sum += weights[static_cast<Eigen::Index>(i)];
    const bool last = i + 1 == truths.size();
    for (; result.truths.size() < count && (last || next < sum); next += step) {
      result.truths.push_back(truths[i]);
    }
  }
  result.weights = Eigen::VectorXd::Constant(static_cast<Eigen::Index>(count), step);
  return result;
}

double success_probability(const PoseConsensus& consensus, const SE3d& estimate,
                           std::span<const ToleranceRegion> regions,
                           const SymmetryGroup& symmetries) {
  require(!regions.empty(), "probability of success without a region");
  check_weights(consensus);
  double sum = 0.0;
  for (std::size_t i = 0; i < consensus.truths.size(); ++i) {
    const SE3d error = symmetries.reduced_error(consensus.truths[i].inverse() * estimate);
    const Eigen::Vector3d rotation = error.rotation().log();
    double mean = 0.0;
    for (const ToleranceRegion& region : regions) {
      mean += region.success_probability(rotation, error.translation());
    }
    sum += consensus.weights[static_cast<Eigen::Index>(i)] * mean;
  }
  return sum / static_cast<double>(regions.size());
}

}  // namespace posemix
