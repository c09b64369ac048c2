// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/instance_tracks.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "posemix/base/error.hpp"
#include "posemix/base/limits.hpp"
#include "posemix/base/range.hpp"
#include "posemix/base/statistics.hpp"
#include "posemix/base/units.hpp"

namespace posemix {
namespace {

/// An object is expected to be detected from all directions that are nearer than this to one from
/// which it was, and a direction nearer than the second is not a new one.
const double kSameViewCosine = std::cos(radians(60.0));
const double kNewViewCosine = std::cos(radians(20.0));

/// Directions from which the detector sees an object that are remembered; more cover the sphere.
constexpr std::size_t kMostViews = 64;

}  // namespace

void validate(const HealthSettings& settings) {
  kUnitInterval.check(settings.mode_probability, "mode_probability");
  NumberRange{.lowest = 1.0}.check(settings.window_detections, "window_detections");
  kOpenUnitInterval.check(settings.band_probability, "band_probability");
  kUnitInterval.check(settings.lost_probability, "lost_probability");
  kNotNegative.check(settings.register_again_s, "register_again_s");
}

InstanceTracks::InstanceTracks(const ExistenceSettings& existence, const HealthSettings& health,
                               std::size_t confirming_detections, double least_separation_m)
    : existence_(existence),
      health_(health),
      confirming_detections_(confirming_detections),
      least_separation_m_(least_separation_m) {
  validate(existence_);
  validate(health_);
  band_ = chi_square_quantile(health_.band_probability, 6, "band_probability") / 6.0;
}

void InstanceTracks::add(bool is_known, const std::string& class_id) {
  tracks_.push_back({.is_known = is_known, .class_id = class_id});
}

void InstanceTracks::forget(std::size_t object) {
  // What was known of it before its first sighting is forgotten, too.
  const std::string class_id = track_of(object).class_id;
  tracks_[object] = {.class_id = class_id};
}

void InstanceTracks::begin(double dt) {
  kTimeStep.check(dt, "dt");
  ++frames_;
  dt_ = frames_ == 1 ? 0.0 : dt;
  for (auto& [searched, look] : looks_) look.is_now = false;
  for (Track& track : tracks_) track.found_now.clear();
}

void InstanceTracks::look(const std::string& camera, const std::optional<std::string>& detector,
                          const SE3d& body_camera) {
  const auto take = [&](Look& look) {
    look.body_camera = body_camera;
    look.is_now = true;
  };
  if (detector) return take(looks_[{camera, *detector}]);
  for (auto& [searched, look] : looks_)
    if (searched.first == camera) take(look);
}

void InstanceTracks::detected(std::size_t object, const TrackedDetection& detection) {
  internal::check_index(object, tracks_.size(), "object");
  kAnyNumber.check(detection.clutter_probability, "clutter_probability");
  kAnyNumber.check(detection.inlier_probability, "inlier_probability");
  require(detection.residual.allFinite(), "residual holds a value that is not finite");
  Track& track = tracks_[object];
  ++track.detections;
  track.last_frame = frames_;
  track.of_class = detection.of_class;
  track.is_missed = false;
  track.found_by.emplace(detection.camera, detection.detector);
  track.found_now.emplace_back(detection.camera, detection.detector);
  if (track.detections == 1) return;
  const double keep = 1.0 - 1.0 / health_.window_detections;
  track.weight = keep * track.weight + 1.0;
  track.clutter = keep * track.clutter + detection.clutter_probability;
  track.inliers = keep * track.inliers + detection.inlier_probability;
  track.square =
      keep * track.square + detection.inlier_probability * detection.residual.squaredNorm() / 6.0;
}

void InstanceTracks::check(std::span<const TrackedPlace> places) const {
  if (places.size() != tracks_.size())
    throw InvalidInput(fmt::format("{} places for {} objects", places.size(), tracks_.size()));
  for (const Track& track : tracks_)
    for (const auto& [camera, detector] : track.found_now)
      if (!looks_.contains({camera, detector}))
        throw InvalidInput(
            fmt::format("an object was detected in an image of camera '{}' by detector '{}', which "
                        "did not look",
                        camera, detector));
}

void InstanceTracks::end(std::span<const TrackedPlace> places) {
  check(places);
  for (std::size_t j = 0; j < tracks_.size(); ++j) {
    Track& track = tracks_[j];
    const auto& pose = places[j].body_object;
    if (!pose || track.detections == 0) continue;
    track.place_probability = places[j].probability;
    if (!track.existence) {
      track.existence.emplace(existence_);
      track.since_look_s = 0.0;
    } else {
      track.since_look_s += dt_;
      look_at(track, sighting_of(track, *pose));
    }
    if (track.last_frame == frames_) learn_view(track, *pose);
    track.bad_s = is_lost(track) || is_inconsistent(track) ? track.bad_s + dt_ : 0.0;
  }
  weigh_rivals(places);
}

// What nobody looks at is as it was: the time that went by counts at the next look.
void InstanceTracks::look_at(Track& track, Sighting sighting) const {
  if (sighting == Sighting::out_of_view) return;
  track.existence->predict(track.since_look_s, existence_);
  track.existence->update(sighting, track.since_look_s, existence_);
  if (sighting == Sighting::missed &&
      track.existence->visible_probability() < health_.lost_probability)
    track.is_missed = true;
  const double look = part_of_a_look(track.since_look_s, existence_);
  track.counts.images += look;
  if (sighting == Sighting::detected) track.counts.detections += look;
  track.since_look_s = 0.0;
}

Sighting InstanceTracks::sighting_of(const Track& track, const SE3d& body_object) const {
  if (track.last_frame == frames_) return Sighting::detected;
  for (const Searched& searched : track.found_by) {
    const Look& look = looks_.at(searched);
    if (!look.is_now) continue;
    const SE3d camera_object = look.body_camera.inverse() * body_object;
    if (!look.view.contains(camera_object.translation())) continue;
    const Eigen::Vector3d from = camera_object.inverse().translation().normalized();
    if (std::any_of(track.views.begin(), track.views.end(),
                    [&](const Eigen::Vector3d& view) { return view.dot(from) > kSameViewCosine; }))
      return Sighting::missed;
  }
  return Sighting::out_of_view;
}

void InstanceTracks::learn_view(Track& track, const SE3d& body_object) {
  for (const Searched& searched : track.found_now) {
    Look& look = looks_.at(searched);
    const SE3d object_camera = body_object.inverse() * look.body_camera;
    // A single false detection may be anywhere.
    if (track.detections >= confirming_detections_)
      look.view.add(object_camera.inverse().translation());
    if (track.views.size() >= kMostViews) continue;
    const Eigen::Vector3d from = object_camera.translation().normalized();
    if (std::none_of(track.views.begin(), track.views.end(),
                     [&](const Eigen::Vector3d& view) { return view.dot(from) > kNewViewCosine; }))
      track.views.push_back(from);
  }
}

void InstanceTracks::weigh_rivals(std::span<const TrackedPlace> places) {
  // Instances of classes along one axis, so that near ones follow each other.
  std::vector<std::size_t> order;
  std::vector<Eigen::Vector3d> at(tracks_.size(), Eigen::Vector3d::Zero());
  for (std::size_t j = 0; j < tracks_.size(); ++j) {
    Track& track = tracks_[j];
    if (!track.existence || !places[j].body_object) continue;
    track.probability = track.existence->probability();
    at[j] = places[j].body_object->translation();
    if (track.of_class) order.push_back(j);
  }
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return at[a].x() < at[b].x(); });
  // Eq. (5): of those that exclude each other, one exists at most.
  duplicates_.clear();
  std::vector<double> sum(tracks_.size(), 1.0);
  for (std::size_t a = 0; a < order.size(); ++a) {
    const std::size_t i = order[a];
    for (std::size_t b = a + 1; b < order.size(); ++b) {
      const std::size_t j = order[b];
      if (at[j].x() - at[i].x() >= std::max(existence_.exclusion_m, least_separation_m_)) break;
      const double distance = (at[j] - at[i]).norm();
      find_duplicates(i, j, distance);
      if (distance >= existence_.exclusion_m) continue;
      sum[i] += tracks_[j].existence->odds();
      sum[j] += tracks_[i].existence->odds();
    }
  }
  for (const std::size_t j : order) {
    const double own = tracks_[j].existence->odds();
    tracks_[j].probability = own / (own + sum[j]);
  }
}

void InstanceTracks::find_duplicates(std::size_t i, std::size_t j, double distance_m) {
  const Track& a = tracks_[i];
  const Track& b = tracks_[j];
  // Two detections in one image are of two objects.
  if (distance_m >= least_separation_m_ || a.class_id != b.class_id ||
      (a.last_frame == frames_ && b.last_frame == frames_))
    return;
  const double of_a = a.existence->probability();
  const double of_b = b.existence->probability();
  const std::size_t less = of_a < of_b ? i : j;
  if (!tracks_[less].is_known && std::min(of_a, of_b) < existence_.confirmed_probability)
    duplicates_.push_back(less);
}

std::optional<double> InstanceTracks::existence(std::size_t object) const {
  const Track& track = track_of(object);
  if (track.is_known) return 1.0;
  return track.existence ? std::optional(track.probability) : std::nullopt;
}

bool InstanceTracks::is_confirmed(std::size_t object) const {
  const Track& track = track_of(object);
  return track.is_known || (track.detections >= confirming_detections_ &&
                            existence(object).value_or(0.0) >= existence_.confirmed_probability);
}

bool InstanceTracks::gives_way(std::size_t object) const {
  const Track& track = track_of(object);
  return !track.is_known && track.detections < confirming_detections_;
}

bool InstanceTracks::is_deleted(std::size_t object) const {
  const Track& track = track_of(object);
  // Not eq. (5): which of two rivals there is may still turn out otherwise.
  return !track.is_known && track.of_class && track.existence &&
         track.existence->probability() < existence_.deleted_probability;
}

bool InstanceTracks::is_lost(const Track& track) const {
  return track.is_missed || track.place_probability < health_.lost_probability;
}

bool InstanceTracks::is_inconsistent(const Track& track) const {
  // Half of the window at least, or one gross error would be most of what was seen.
  if (track.weight < 0.5 * health_.window_detections) return false;
  if (track.clutter > 0.5 * track.weight) return true;
  // Errors that follow each other are alike, so that their mean may be as large as one of them.
  return track.inliers >= 1.0 && track.square > band_ * track.inliers;
}

TrackHealth InstanceTracks::health(std::size_t object, double mode_probability) const {
  const Track& track = track_of(object);
  if (track.detections == 0 && !track.is_known) return TrackHealth::none;
  if (is_lost(track)) return TrackHealth::lost;
  if (is_inconsistent(track)) return TrackHealth::inconsistent;
  if (!is_confirmed(object)) return TrackHealth::tentative;
  return mode_probability < health_.mode_probability ? TrackHealth::ambiguous : TrackHealth::good;
}

bool InstanceTracks::should_register(std::size_t object) const {
  const Track& track = track_of(object);
  return (is_lost(track) || is_inconsistent(track)) && track.bad_s >= health_.register_again_s;
}

}  // namespace posemix
