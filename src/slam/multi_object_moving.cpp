// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "posemix/base/error.hpp"
#include "posemix/slam/multi_object_slam.hpp"

/// Where objects that move part from those that stand still.
namespace posemix {

bool MultiObjectSlam::is_known(std::size_t object) const {
  return moving_.has(object) ? moving_.is_known(object) : filter_.is_known(object);
}

void MultiObjectSlam::forget(std::size_t object) {
  objects_.require(object);
  if (moving_.has(object)) {
    moving_.forget(object);
  } else {
    filter_.forget(object);
  }
  tracks_.forget(object);
}

void MultiObjectSlam::forget(std::size_t object, FrameEstimate& last) {
  forget(object);
  // An estimate may be older than an object that was added.
  if (object >= last.objects.size()) return;
  const auto clear = [&](auto& entries) {
    if (object < entries.size()) entries[object] = {};  // a tracker may leave some out
  };
  clear(last.objects);
  clear(last.relative);
  clear(last.mode_probabilities);
  clear(last.existences);
  clear(last.healths);
  clear(last.register_again);
  clear(last.motion_models);
  clear(last.twists);
  clear(last.alternatives);
  for (std::size_t other = 0; other < last.pose_indices.size(); ++other)
    last.pose_indices[other] = pose_index(other);
}

ObjectUpdateReport MultiObjectSlam::update_filter(std::size_t object,
                                                  const Observation& observation,
                                                  const ObservationSource& source) {
  return moving_.has(object) ? moving_.update(object, observation, known_camera(source))
                             : filter_.update(object, observation, source);
}

PoseDensity MultiObjectSlam::predicted_detection(std::size_t object,
                                                 const ObservationSource& source) const {
  return moving_.has(object)
             ? moving_.predicted_detection(object, known_camera(source))
             : filter_.predicted_detection(object, *filter_.leading(object), source);
}

KnownCamera MultiObjectSlam::known_camera(const ObservationSource& source) const {
  const PoseDensity body = filter_.camera();
  SE3d body_camera = source.body_camera;
  Matrix6d covariance = body.covariance();
  if (source.camera) {
    // Its correlation with the body is left out.
    const PoseDensity estimated = filter_.extrinsic(*source.camera);
    body_camera = estimated.mean();
    covariance += body.mean().adjoint_congruence(Matrix6d(estimated.covariance()));
  }
  // The error of an estimated pose lasts from frame to frame, that of a given one does not.
  const PoseDensity camera = PoseDensity::trusted(body.mean() * body_camera, covariance);
  return camera_lasts_ ? still_camera(camera) : camera_on_arm(camera);
}

std::vector<ObjectHypothesis> MultiObjectSlam::hypotheses(std::size_t object) const {
  objects_.require(object);
  return moving_.has(object) ? moving_.hypotheses(object) : filter_.hypotheses(object);
}

std::optional<PoseDensity> MultiObjectSlam::object_at(std::size_t object, double dt) const {
  objects_.require(object);
  if (!(dt >= 0.0 && std::isfinite(dt)))
    throw InvalidInput(fmt::format("dt is {} s, expected a time that is not negative", dt));
  if (moving_.has(object)) {
    const auto later = moving_.at(object, dt);
    return later ? std::optional(later->world) : std::nullopt;
  }
  const auto leading = filter_.leading_estimates()[object];
  return leading ? std::optional(leading->world) : std::nullopt;
}

std::optional<PoseDensity> MultiObjectSlam::camera_for_moving() const {
  return moving_.empty() ? std::nullopt : std::optional(filter_.camera());
}

void MultiObjectSlam::follow_camera(const PoseDensity& before, const PoseDensity& predicted,
                                    bool lasted) {
  if (lasted && camera_lasts_) {
    moving_.follow(before, predicted, filter_.camera());
  } else if (camera_lasts_) {
    moving_.camera_begins_to_last(filter_.camera());
  } else if (lasted) {
    moving_.camera_ceases_to_last(before);
  }
}

double MultiObjectSlam::place_probability(std::size_t object) const {
  if (!is_known(object)) return 1.0;
  if (moving_.has(object)) return 1.0 - moving_.lost_probability(object);
  return put_down_of(objects_[object].motion) ? -std::expm1(filter_.log_absent(object)) : 1.0;
}

void MultiObjectSlam::report_moving(FrameEstimate& frame) const {
  frame.motion_models.resize(objects_.size());
  frame.twists.resize(objects_.size());
  moving_.report(known_camera({}), record_hypotheses_, frame);
}

}  // namespace posemix
