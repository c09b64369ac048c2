// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <utility>
#include <vector>

#include "global_hypotheses.hpp"

/// What is reported of all global hypotheses together.
namespace posemix::internal {

bool GlobalHypotheses::is_known(std::size_t j) const {
  return std::any_of(list_.begin(), list_.end(), [&](const Weighted& one) {
    return one.state.objects[j].belief.leading().has_value();
  });
}

MultiObjectState GlobalHypotheses::mixed() const {
  Weighted all = list_.front();
  for (std::size_t i = 1; i < list_.size(); ++i) {
    LogTotals log = list_[i].log;
    const LogTotals total = normalise_pair(all.log, log);
    all.state.mix(list_[i].state, all.log, log);
    all.log = total;
  }
  for (std::size_t j = 0; j < all.state.objects.size(); ++j) {
    const auto id = leading_id(j);
    ObjectBelief& belief = all.state.objects[j].belief;
    const auto h = id ? belief.find(*id) : std::nullopt;
    if (h) belief.make_leader(all.state.joint, *h);
  }
  return std::move(all.state);
}

Mixture<ConcentratedGaussian<SE3d>> GlobalHypotheses::camera() const {
  std::vector<Component<ConcentratedGaussian<SE3d>>> components;
  components.reserve(list_.size());
  for (const Weighted& one : list_) {
    components.push_back({one.log.weight, to_world()(one.state.reported_camera())});
  }
  return Mixture<ConcentratedGaussian<SE3d>>(std::move(components));
}

Mixture<ConcentratedGaussian<SE3d>> GlobalHypotheses::object(std::size_t j) const {
  std::vector<Component<ConcentratedGaussian<SE3d>>> components;
  for (const Weighted& one : list_) {
    const TrackedObject& object = one.state.objects[j];
    for (std::size_t h = 0; h < object.belief.size(); ++h) {
      const DetectionState state = one.state.reported(object, h);
      components.push_back(
          {one.log.weight + object.belief.standing(h).log_weight,
           to_world()(ConcentratedGaussian<SE3d>::trusted(
               state.object, state.covariance.block<6, 6>(kObjectRow, kObjectRow)))});
    }
  }
  return Mixture<ConcentratedGaussian<SE3d>>(std::move(components));
}

}  // namespace posemix::internal
