// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "posemix/base/range.hpp"
#include "posemix/base/state_fields.hpp"
#include "posemix/base/words.hpp"
#include "posemix/lie/lie.hpp"
#include "posemix/slam/existence.hpp"

/// Whether the objects of a tracker exist, are seen, and behave as stated (docs/existence.md).
namespace posemix {

/// The state of the track of one object; where several hold, the last one of them.
enum class TrackHealth {
  none,          ///< it was never seen
  tentative,     ///< not confirmed
  good,          ///< confirmed, on one mode, and detections are as the noise says
  ambiguous,     ///< the mode has less than HealthSettings::mode_probability
  inconsistent,  ///< detections are beyond the band of the noise, or most are doubted
  lost           ///< it should be seen, and is not, or its place is not known any more
};

/// The words of TrackHealth in traces, in the order of the values.
template <>
inline constexpr WordTable<TrackHealth, 6> words<TrackHealth>{{
    {"none", TrackHealth::none},
    {"tentative", TrackHealth::tentative},
    {"good", TrackHealth::good},
    {"ambiguous", TrackHealth::ambiguous},
    {"inconsistent", TrackHealth::inconsistent},
    {"lost", TrackHealth::lost},
}};

/// Settings of TrackHealth.
struct HealthSettings {
  double mode_probability = 0.9;  ///< below it a track is ambiguous
  /// Detections over which innovations are averaged, with exponentially falling weights.
  double window_detections = 10.0;
  /// The mean square innovation of detections that are no gross errors may be at this quantile of
  /// its distribution.
  double band_probability = 0.9999;
  /// A track is lost when what was detected is in sight, or its place is known, with less than
  /// this probability.
  double lost_probability = 0.1;
  /// A track that is lost or inconsistent for so long should be registered again [s].
  double register_again_s = 2.0;
};

/// @throws InvalidInput when a setting is out of range
void validate(const HealthSettings& settings);

/// Where an object is at the end of a frame.
struct TrackedPlace {
  std::optional<SE3d> body_object = {};  ///< of one that is known
  double probability = 1.0;              ///< that it is at any of its hypotheses
};

/// What a detection says of the track of an object.
struct TrackedDetection {
  std::string camera = {};
  std::string detector = {};
  bool of_class = false;  ///< the object is one of several of a class
  double clutter_probability = 0.0;
  double inlier_probability = 0.0;
  Vector6d residual = Vector6d::Zero();  ///< as ObjectUpdateReport::residual
};

/// Existence and health of the objects of a tracker, by their index: one that nothing has throws
/// InvalidInput. A frame is `begin`, then `look` and `detected` in any order, then `end`.
class InstanceTracks {
 public:
  /// @throws InvalidInput when a setting is out of range
  InstanceTracks(const ExistenceSettings& existence, const HealthSettings& health,
                 std::size_t confirming_detections, double least_separation_m);

  /// One more object of a class. One that is known to exist has no existence of its own.
  void add(bool is_known, const std::string& class_id);
  /// The object is as if it had never been seen.
  void forget(std::size_t object);

  /// A frame begins, `dt` seconds after the last.
  /// @throws InvalidInput when the time is negative or not finite
  void begin(double dt);
  /// The frame has an image of the camera of this name at T_body_camera, that was searched by the
  /// named detector, or by all of that camera.
  void look(const std::string& camera, const std::optional<std::string>& detector,
            const SE3d& body_camera);
  /// @throws InvalidInput when a number is not finite, too
  void detected(std::size_t object, const TrackedDetection& detection);
  /// The frame ends with the objects at these places.
  /// @throws InvalidInput, and nothing has changed, when there is not one place for each object, or
  /// one was detected by a camera and detector of which `look` was never told
  void end(std::span<const TrackedPlace> places);

  /// Number of detections of the object, and the frame of the last one.
  std::size_t detections(std::size_t object) const { return track_of(object).detections; }
  std::size_t last_frame(std::size_t object) const { return track_of(object).last_frame; }
  /// What fit_existence learns from, without the truth.
  const InstanceCounts& counts(std::size_t object) const { return track_of(object).counts; }
  /// Probability that the object exists, eq. (4) and (5); none before its first detection. It is
  /// one for an object that is known to exist.
  std::optional<double> existence(std::size_t object) const;
  bool is_confirmed(std::size_t object) const;
  /// Whether a new instance may take its place: it has few detections.
  bool gives_way(std::size_t object) const;
  /// Whether an instance of a class hardly exists any more.
  bool is_deleted(std::size_t object) const;
  /// Instances that are not confirmed, and come nearer to a more probable one of their class than
  /// two can be.
  const std::vector<std::size_t>& duplicates() const { return duplicates_; }
  TrackHealth health(std::size_t object, double mode_probability) const;
  /// Whether the track is lost or inconsistent for HealthSettings::register_again_s.
  bool should_register(std::size_t object) const;

 private:
  template <class>
  friend struct internal::StateFields;

  /// A camera and a detector.
  using Searched = std::pair<std::string, std::string>;
  struct Track {
    bool is_known = false;
    bool of_class = false;
    std::string class_id = {};
    std::size_t detections = 0;
    std::size_t last_frame = 0;
    std::optional<Existence> existence = {};
    InstanceCounts counts = {};
    double since_look_s = 0.0;
    bool is_missed = false;  ///< it should be seen, and is not; until it is detected
    double place_probability = 1.0;
    double bad_s = 0.0;  ///< for which it is lost or inconsistent
    std::set<Searched> found_by = {};
    std::vector<Searched> found_now = {};  ///< in this frame
    double probability = 0.0;              ///< eq. (5), at the end of the frame
    /// Directions from the object, along its axes, from which it was detected.
    std::vector<Eigen::Vector3d> views = {};
    // Averages over the window.
    double weight = 0.0;
    double clutter = 0.0;
    double inliers = 0.0;
    double square = 0.0;  ///< of the components of residuals
  };
  struct Look {
    SE3d body_camera;
    bool is_now = false;
    FieldOfView view;
  };

  const Track& track_of(std::size_t object) const {
    internal::check_index(object, tracks_.size(), "object");
    return tracks_[object];
  }
  void check(std::span<const TrackedPlace> places) const;
  bool is_lost(const Track& track) const;
  bool is_inconsistent(const Track& track) const;
  void look_at(Track& track, Sighting sighting) const;
  /// Whether a camera of this frame should see the object at T_body_object.
  Sighting sighting_of(const Track& track, const SE3d& body_object) const;
  void learn_view(Track& track, const SE3d& body_object);
  void weigh_rivals(std::span<const TrackedPlace> places);
  void find_duplicates(std::size_t i, std::size_t j, double distance_m);

  ExistenceSettings existence_;
  HealthSettings health_;
  std::size_t confirming_detections_;
  double least_separation_m_;
  std::size_t frames_ = 0;
  double dt_ = 0.0;
  double band_ = 0.0;  ///< of the mean square of a component of an innovation
  std::vector<Track> tracks_;
  std::vector<std::size_t> duplicates_;
  std::map<Searched, Look> looks_;
};

}  // namespace posemix
