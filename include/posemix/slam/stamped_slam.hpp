// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "posemix/base/state_fields.hpp"
#include "posemix/base/words.hpp"
#include "posemix/slam/multi_object_slam.hpp"

/// Object SLAM by stamps: observations and odometry come late and in any order.
namespace posemix {

/// What happens where a stamp lies far before the newest one, as in a recording that starts again.
enum class StampJump {
  refuse,  ///< InvalidInput
  reset    ///< all is forgotten, and begins with that stamp
};

/// The words of StampJump in files and options.
template <>
inline constexpr WordTable<StampJump, 2> words<StampJump>{{
    {"refuse", StampJump::refuse},
    {"reset", StampJump::reset},
}};

/// Settings of StampedSlam.
struct StampedSlamSettings {
  /// Observations and odometry that are up to so much older than the newest stamp are taken in at
  /// their own time [s]; older ones are refused and counted.
  double history_s = 1.0;
  /// A stamp that is older by more than this has jumped back [s].
  double jump_back_s = 10.0;
  StampJump on_jump_back = StampJump::refuse;
  /// A stamp may be so much newer than the newest before it [s].
  double jump_ahead_s = 3600.0;
  /// Copies of the state over the history from which it is played again; more of them make late
  /// input cheaper and take more memory.
  std::size_t checkpoints = 4;
};

/// What became of an input.
enum class StampAdmission {
  taken,     ///< newer than all before
  replayed,  ///< late, and what came after it is played again
  too_late   ///< older than the history, and left out
};

/// The words of StampAdmission in messages and in Python.
template <>
inline constexpr WordTable<StampAdmission, 3> words<StampAdmission>{{
    {"taken", StampAdmission::taken},
    {"replayed", StampAdmission::replayed},
    {"too_late", StampAdmission::too_late},
}};

/// Number of inputs by what became of them.
struct StampCounts {
  std::size_t taken = 0;
  std::size_t replayed = 0;
  std::size_t too_late = 0;
  std::size_t resets = 0;
};

/// An estimate and its time.
struct EstimateAtStamp {
  double stamp_s;
  FrameEstimate estimate;
};

/// Object SLAM by the multi-object filter, whose input are observations and poses of odometry with
/// their stamps. The result is that of the inputs sorted by their stamps, whatever the order in
/// which they come, to the last bit, as long as none is older than the history.
///
/// Every stamp is a frame. Observations of one stamp are taken in a fixed order: by object,
/// detector, camera, class, then by their numbers. With odometry, the body's motion up to a stamp
/// between two poses is a part of the motion between them (constant twist), where they are no
/// further apart than the history. Observations newer than the odometry wait for it; where it does
/// not come within twice the history, they are frames without odometry.
///
///     StampedSlam slam(body, {{.id = "mug"}});
///     slam.add_odometry(10.00, T_odom_body);
///     slam.add({.object = "mug", .components = {...}, .stamp_s = 9.98});
///     slam.estimate()->estimate.object("mug").world;
class StampedSlam {
 public:
  /// `body` is the prior of T_world_body (the camera, where there is one) at the first stamp.
  /// @throws InvalidInput as MultiObjectSlam, and for settings out of range
  StampedSlam(const PoseDensity& body, std::vector<ObjectModel> objects,
              const MultiObjectSlamSettings& settings = {}, const MotionSettings& motion = {},
              const StampedSlamSettings& stamped = {}, bool record_hypotheses = false);

  /// @throws InvalidInput, and changes nothing, for an observation that is not valid, names what is
  /// not known, or whose stamp has jumped
  StampAdmission add(const Observation& observation);
  /// T_odom_body at a time; under the motion model `given` T_world_body.
  /// @throws InvalidInput, and changes nothing, for a pose that is not finite or beyond 2.5e7 m, or
  /// as MultiObjectSlam::check_camera, a stamp that has jumped or has another pose already, and
  /// under a motion model without odometry
  StampAdmission add_odometry(double stamp_s, const SE3d& odom_body);

  /// An image at a time of the camera with this name in which nothing was detected: what should be
  /// seen in it may be gone. Images with observations need not be told.
  /// @throws InvalidInput, and changes nothing, for a camera that there is not, and a stamp that
  /// has jumped
  StampAdmission add_image(double stamp_s, const std::string& camera = {});
  /// The same of an image that one detector has searched: what others found may be there.
  /// @throws InvalidInput also where CAMERA@DETECTOR is the name of another camera's image, and for
  /// a detector that no object has, where all name theirs
  StampAdmission add_image(double stamp_s, const std::string& camera,
                           const std::optional<std::string>& detector);

  /// T_world_frame of one of MultiObjectSlamSettings::frames at a time; between two that are no
  /// further apart than the history the motion is a part of the motion between them, elsewhere the
  /// frame is where it was. Until each that may hold an object had a pose there is no estimate,
  /// and input that is older than the first of these poses by more than the history is left out.
  /// @throws InvalidInput, and changes nothing, for a name that there is not, a pose that is not
  /// valid, and a stamp that has jumped or has another pose already
  StampAdmission add_frame(std::string_view name, double stamp_s, const KnownFrame& frame);

  /// An object is forgotten as of a time, by default that of the newest stamp: what was seen of it
  /// until then, and at it, does not count any more, however late it comes, and its first sighting
  /// after it begins it anew. All else stays as it is (MultiObjectSlam::forget). Like every input
  /// it is taken in at its stamp, so the estimate has it from there on.
  /// @throws InvalidInput, and changes nothing, for an id that there is not, and a stamp that has
  /// jumped or is more than `jump_back_s` after the newest
  StampAdmission forget(std::string_view id, std::optional<double> stamp_s = {});

  /// The estimate at the newest stamp; with odometry, at the newest that odometry has reached. None
  /// before the first.
  const std::optional<EstimateAtStamp>& estimate();
  /// The same with all observations, also those that wait for odometry, which are then frames
  /// without it; for the end of a recording.
  /// @throws InvalidInput where a frame that may hold an object never had a pose
  const std::optional<EstimateAtStamp>& finish();

  /// T_world_object at a stamp that is not before that of estimate(), as far as it is known by then
  /// (MultiObjectSlam::object_at). Empty until it was seen.
  /// @throws InvalidInput for an earlier stamp, and for an id that there is not
  std::optional<PoseDensity> object_at(std::string_view id, double stamp_s);

  const StampCounts& counts() const { return counts_; }
  /// Observations that wait for odometry, or for the first pose of a frame.
  std::size_t waiting() const;
  /// Names of the frames that may hold an object and had no pose so far: without them there is no
  /// estimate.
  std::vector<std::string> missing_frames() const;
  /// The tracker at the stamp of the last estimate.
  const MultiObjectSlam& slam() const { return now_.slam; }

 private:
  template <class>
  friend struct internal::StateFields;

  /// The input at one stamp.
  struct Frame {
    std::vector<Observation> observations = {};
    std::set<std::string> images = {};  ///< that show nothing, as FrameInput::images
    std::optional<SE3d> odometry = {};
    std::set<std::string> forgotten = {};  ///< ids, after the observations
  };
  /// The tracker after the frames up to a stamp.
  struct State {
    MultiObjectSlam slam;
    std::optional<EstimateAtStamp> estimate = {};
  };

  /// @throws InvalidInput for a stamp that has jumped
  StampAdmission admit(double stamp_s);
  /// Changes the frame at a stamp, and plays again what came after it.
  template <class Change>
  StampAdmission add_to_frame(double stamp_s, const Change& change);
  void reset();
  void play_again_after(double stamp_s);
  void play(double until_s);
  void play_frame(double stamp_s, const Frame& frame);
  /// Whether there is an object with this id, or will be one when the input is played.
  bool is_object(std::string_view id) const;
  void forget_old();
  std::optional<double> newest_odometry() const;
  /// T_odom_body at a time, where poses on both sides are near enough.
  std::optional<SE3d> odometry_at(double stamp_s) const;
  /// @throws InvalidInput for a name that there is not
  std::size_t frame_index(std::string_view name) const;
  std::optional<KnownFrame> frame_at(std::size_t frame, double stamp_s) const;
  /// Stamp from which on the poses of all frames that may hold an object are known; infinite as
  /// long as one is missing.
  double begin_s() const;

  StampedSlamSettings settings_;
  bool has_odometry_;
  bool is_given_;  ///< what is odometry elsewhere is the camera's pose
  State initial_;
  State now_;
  std::deque<State> checkpoints_;  ///< by their stamps, the first one before all that is kept
  std::map<double, Frame> frames_;
  std::map<double, SE3d> odometry_;
  std::vector<std::string> names_;                          ///< of frames that may hold objects
  std::vector<std::map<double, KnownFrame>> known_frames_;  ///< their poses
  std::vector<std::optional<double>> first_poses_;          ///< stamps of the first of them
  std::optional<double> newest_;
  StampCounts counts_;
};

}  // namespace posemix
