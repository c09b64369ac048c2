// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "posemix/slam/multi_object_slam.hpp"

/// Existence of the objects of MultiObjectSlam, docs/existence.md.
namespace posemix {

void MultiObjectSlam::find_positions() {
  positions_.assign(objects_.size(), std::nullopt);
  for (std::size_t j = 0; j < objects_.size(); ++j) {
    if (!sightings_[j].existence || !filter_.is_known(j)) continue;
    const std::size_t leading = filter_.leading(j).value();
    positions_[j] = filter_.hypothesis_means(j)[leading].pose.translation();
  }
}

std::vector<std::size_t> MultiObjectSlam::rivals(std::size_t j) const {
  std::vector<std::size_t> list;
  for (std::size_t other = 0; other < positions_.size(); ++other) {
    if (other == j || !positions_[other]) continue;
    if ((*positions_[other] - *positions_[j]).norm() < settings_.existence.exclusion_m)
      list.push_back(other);
  }
  return list;
}

std::optional<double> MultiObjectSlam::existence(std::size_t object) const {
  objects_.require(object);
  if (object >= positions_.size() || !positions_[object]) return std::nullopt;
  const std::optional<Existence>& own = sightings_[object].existence;
  // Eq. (4): at most one of the objects at one place.
  double odds = 1.0 + own->odds();
  for (const std::size_t rival : rivals(object)) odds += sightings_[rival].existence->odds();
  return own->odds() / odds;
}

bool MultiObjectSlam::is_confirmed(std::size_t object) const {
  objects_.require(object);
  if (objects_[object].prior) return true;
  return sightings_[object].count >= settings_.confirming_detections &&
         existence(object).value_or(0.0) >= settings_.existence.confirmed_probability;
}

double MultiObjectSlam::log_clutter_intensity(std::size_t object,
                                              const ObservationSource& source) const {
  const double volume = filter_.sensor(object, source.detector).noise.clutter().volume_m3;
  return std::log(settings_.existence.clutter_rate) -
         std::log(8.0 * std::numbers::pi * std::numbers::pi * volume);
}

void MultiObjectSlam::update_existence(const FrameInput& input) {
  // Where the cameras of this frame have seen anything so far.
  std::vector<std::pair<SE3d, const FieldOfView*>> cameras;
  const SE3d body = filter_.camera().mean();
  const auto add = [&](const std::string& name, const SE3d& seen) {
    FieldOfView& view = views_[name];
    view.add(seen.translation());
    const SE3d camera = body * pose_on_body(settings_.cameras, name);
    cameras.emplace_back(camera.inverse(), &view);
  };
  for (const auto& detection : input.detections)
    if (detection) add("", *detection);
  for (const Candidate& candidate : input.candidates) add("", candidate.camera_object);
  for (const Observation& observation : input.observations)
    for (const ObservationComponent& one : observation.components)
      add(observation.camera, one.pose);

  find_positions();
  for (std::size_t j = 0; j < objects_.size(); ++j) {
    Sightings& own = sightings_[j];
    if (!positions_[j]) continue;
    if (own.count == 1 && own.last_frame == objects_.frames()) continue;  // it began with this
    if (input.dt > 0.0) own.existence->predict(input.dt, settings_.existence);
    const Eigen::Vector3d& at = *positions_[j];
    ExistenceEvidence evidence{
        .in_view = std::any_of(
            cameras.begin(), cameras.end(),
            [&](const auto& camera) { return camera.second->contains(camera.first * at); }),
        .log_ratio = own.log_ratio};
    for (const std::size_t rival : rivals(j)) {
      const auto& ratio = sightings_[rival].log_ratio;
      if (ratio &&
          *ratio > evidence.log_confused.value_or(-std::numeric_limits<double>::infinity()))
        evidence.log_confused = ratio;
    }
    own.existence->update(evidence, settings_.existence);
  }
  for (Sightings& one : sightings_) one.log_ratio.reset();
  forget_deleted();
}

void MultiObjectSlam::forget_deleted() {
  for (std::size_t j = 0; j < objects_.size(); ++j) {
    if (objects_[j].class_id.empty() || objects_[j].prior) continue;
    const auto probability = existence(j);
    if (!probability || *probability >= settings_.existence.deleted_probability) continue;
    filter_.forget(j);
    sightings_[j] = {};
    positions_[j].reset();
  }
}

}  // namespace posemix
