// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "base/kept_memory.hpp"
#include "camera_regression.hpp"
#include "filter/moving/mode_weights.hpp"
#include "joint_gaussian.hpp"
#include "other_cameras.hpp"
#include "posemix/base/state_fields.hpp"
#include "posemix/filter/multi_object_filter.hpp"

namespace posemix::internal {

struct PutDownEvidence;
struct ShownModes;

/// The weight of a hypothesis and its history.
struct Standing {
  double log_weight = 0.0;       ///< among the hypotheses of the object and its absence [nats]
  double log_probability = 0.0;  ///< the same, with dependent detections counted once
  double score = 0.0;            ///< recent log evidence over that of clutter [nats]
  std::uint64_t id = 0;          ///< constant over time; a merge keeps that of the heavier
  std::uint64_t detections = 0;  ///< number of detections since the birth, the first included
  /// T_camera_object when the slow error was predicted last.
  std::optional<SE3d> seen_from = {};
  /// For an object that is put down elsewhere: given this hypothesis, what each detector shows. The
  /// weights of every detector sum to one.
  std::vector<ModeWeights> shown = {};
  /// The slow errors of cameras that saw the object and do not now, the latest last.
  std::vector<OtherCamera> others = {};
};

/// Log of a sum of weights, and of the same with dependent detections counted once [nats].
struct LogTotals {
  double weight = 0.0;
  double probability = 0.0;
};

/// A hypothesis whose log weight is so far below that of another can win no more [nats]. Every
/// detection moves log weights by ten and more, and detectors stay with a mode for a hundred of
/// them.
inline constexpr double kDecided = 2000.0;

/// A hypothesis that does not lead.
struct Alternative {
  Standing standing;
  ConditionalPose pose;
};

using Alternatives = KeptVector<Alternative>;

/// Runnalls' bound on the loss of one Gaussian for the camera where it has the moments `b` with
/// probability `weight` and `a` else [nats].
double merge_loss(double weight, const CameraMoments& a, const CameraMoments& b);

/// Eq. (10): the part `back` of the camera's correction is taken back by a shift of the world.
/// `follows` is the regression of the pose on the camera by which it took part in the correction;
/// zero for a pose that the detection itself moved.
void shift_back(ConditionalPose& pose, const CameraChange& change, const Matrix6d& back,
                const Matrix12x6d& follows);
/// The same with extrinsics: `follows`, 12 rows, is the regression on camera and extrinsics.
void shift_back_with_rig(ConditionalPose& pose, const CameraChange& change, const Matrix6d& back,
                         const Eigen::MatrixXd& follows);
/// The same for a pose that follows camera and extrinsics, whose moments are `camera`.
void shift_back(ConditionalPose& pose, const CameraChange& change, const Matrix6d& back,
                const CameraMoments& camera);

/// Two hypotheses are merged when their poses differ by less than these bounds.
struct MergeBounds {
  double rotation_rad;
  double translation_m;
  double squared_distance;  ///< squared Mahalanobis distance as seen from the camera
};

/// A hypothesis as an observation sees it.
struct SeenHypothesis {
  DetectionState state;
  const WeighedObservation& observation;
  const ObjectSensor& sensor;
};

/// What is taken out of the error of the world at once, eq. (31).
struct WorldPart {
  Matrix6d d;
  /// Inverse of what D would be by what leads alone; none where no alternative may know the world
  /// better.
  std::optional<Matrix6d> first_inverse = {};
};

/// The hypotheses of an object in another state, with the weights that they get in a mixture.
struct OtherBelief {
  Alternatives hypotheses;  ///< depend on the camera alone, as this state has it
  LogTotals log_absence;
  bool shares_leader;  ///< whether the joint Gaussian has the moments of both leading ones already
  std::vector<ModeWeights> lost_shown = {};  ///< ObjectBelief::lost_shown()
};

/// The hypotheses of one object: their weights, the one that leads, and the alternatives.
///
/// Hypotheses have indices 0, 1, ... in the order of their births. The pose of the leading one is
/// in the joint Gaussian and nowhere else, so that functions that read or change it take the joint
/// Gaussian as an argument.
///
/// Invariants:
/// - there is a leading hypothesis as soon as there is any;
/// - the weights of the hypotheses and of absence sum to one after normalise().
class ObjectBelief {
 public:
  /// Number of hypotheses.
  std::size_t size() const { return alternatives_.size() + (leader_ ? 1 : 0); }
  /// Log weight of the case that no detection so far was the object [nats].
  double log_absent() const { return log_absent_; }
  /// The same, with dependent detections counted once.
  double log_absence_probability() const { return log_absence_probability_; }
  void set_log_absent(double log_weight) {
    log_absent_ = log_weight;
    log_absence_probability_ = log_weight;
  }
  /// Index of the leading hypothesis.
  std::optional<std::size_t> leading() const;
  /// Index of the leading hypothesis' pose in the joint Gaussian.
  std::optional<std::size_t> pose_index() const;
  /// Weight and history of hypothesis `h`.
  const Standing& standing(std::size_t h) const;
  /// The pose of hypothesis `h`.
  ConditionalPose pose(const JointGaussian& joint, std::size_t h) const;
  /// The mean pose of hypothesis `h`.
  const SE3d& mean(const JointGaussian& joint, std::size_t h) const;
  /// The camera, hypothesis `h` and its slow error.
  DetectionState state(const JointGaussian& joint, std::size_t h) const;
  /// The same with the camera that makes an observation, and its error, in place of the body.
  DetectionState state_from(const JointGaussian& joint, std::size_t h,
                            const ObservationSource& source) const;
  /// The same with the slow error of that camera, which need not be the one that saw last.
  DetectionState state_seen_from(const JointGaussian& joint, std::size_t h,
                                 const ObservationSource& source, const ObjectSensor& sensor) const;
  /// The slow error of a camera under hypothesis `h`, by the world's errors of object and body: the
  /// pose of the camera on it counts as exact. Where none saw the object, b is that of `first`.
  CameraSlowError slow_error_of(const JointGaussian& joint, std::size_t h,
                                const ObservationSource& source, const ObservationSource& first,
                                const ObjectSensor& sensor) const;
  /// Probability of every hypothesis, with dependent detections counted once.
  std::vector<double> probabilities() const;

  /// So many blocks at `erased` were erased from the joint Gaussian, and those behind moved up.
  void move_pose_index_up(std::size_t erased, std::size_t blocks);

  // --- prediction

  /// Before the camera moves: the moments of the slow errors of other cameras, by hypothesis, then
  /// camera. The camera's error is another one after it where it is `released`.
  OtherMomentsList moments_of_others(const JointGaussian& joint, bool released);
  /// The slow error after `dt` seconds and the motion of the camera from `camera_before`, for a
  /// detector whose slow error has the covariance `stationary`; those of other cameras had the
  /// moments `others`. Returns the turn of the view (view_turn), as the leading hypothesis has it.
  Eigen::Vector3d decay_slow_error(JointGaussian& joint, const SlowError& slow,
                                   const Matrix6d& stationary,
                                   const std::optional<SE3d>& camera_before, double dt,
                                   const OtherMomentsList& others = {});
  /// b <- f b and xi_O <- xi_O + A (1 - f) b for every hypothesis, with `factor` f by coordinate
  /// and the map A of the first component of `sensor`: the sum that a detection sees stays.
  void rescale_slow_error(JointGaussian& joint, const ObjectSensor& sensor, const Vector6d& factor);
  /// The pose that stands for all equivalent ones is chosen: the directions in which the symmetries
  /// leave it free become independent of everything, with a small variance.
  void fix_unobserved(JointGaussian& joint, const SymmetryGroup& symmetries);
  /// The same after a detection: they get what camera and object have in common there, r of
  /// eq. (33), so that all may still turn together.
  void fix_unobserved_beside_camera(JointGaussian& joint, const ObjectSensor& sensor);
  /// Adds the covariance of an independent shift of the world to all alternatives.
  void add_world_error(const Matrix6d& shift);
  /// W^-1 of eq. (31) of the alternatives that know the world so well that D, whose inverse is
  /// given, is more than the shift that they have left.
  std::vector<Matrix6d> world_information_beyond(const Matrix6d& inverse,
                                                 const CameraMoments& camera,
                                                 const SymmetryGroup& symmetries) const;
  /// Takes a part of the error of the world out of all alternatives, of a camera with these moments
  /// before.
  void take_out_world_error(const WorldPart& part, const CameraMoments& camera,
                            const SymmetryGroup& symmetries);
  /// The origin of the world moves.
  void move_world(const WorldShift& shift);
  /// Alternatives become independent of the camera.
  void release_camera();
  /// Adds P_OC times `factor` to P_OC of every alternative; with extrinsics, [P_OC P_OE ...] times
  /// as many rows.
  void add_to_cross_covariances(const Eigen::Ref<const SixColumns>& factor);

  // --- the stages of an update

  /// The slow error becomes that of the camera that makes an observation; that of the one that saw
  /// last is kept, eq. (41).
  void see_from(JointGaussian& joint, const ObservationSource& source, const ObjectSensor& sensor);
  /// Eq. (2) to (4): the update of every hypothesis on its own pair, by index.
  DetectionUpdates observe(const JointGaussian& joint, const WeighedObservation& observation,
                           const ObjectSensor& sensor, const GainFactors& factors) const;
  /// Multiplies the weight of every hypothesis by its evidence and that of absence by clutter's;
  /// the probabilities by the same to the power `share`, the part of the detection that is
  /// independent of those before.
  void multiply_weights(const DetectionUpdates& updates, double log_clutter, double share);
  /// s <- memory s + log sum_c exp e_c - e_0 (docs/many-objects.md, "Reduction").
  void update_scores(const DetectionUpdates& updates, double log_clutter, double memory);
  /// Counts one more detection for every hypothesis.
  void count_detection();
  /// Log of the summed weights of hypotheses, births and absence [nats].
  double log_total(const Alternatives& births) const;
  /// The camera's moments (m_a, P_a) and weight w_a under everything but the leading hypothesis,
  /// see eq. (6). Births and absence leave the camera at `before`, its covariance.
  CameraAlternative camera_alternative(const DetectionUpdates& updates, const Alternatives& births,
                                       double log_evidence, const CameraMoments& before) const;
  /// Eq. (9) for the object that was detected: every alternative takes its own posterior pair, then
  /// follows the camera to `after`.
  void follow_camera(const DetectionUpdates& updates, const CameraMoments& after);
  /// Eq. (9) for an object that was not detected.
  void follow_camera(const CameraRegression& step);

  /// Appends the poses of the hypotheses that do not lead.
  void append_alternatives(KeptVector<ConditionalPose*>& poses) {
    for (Alternative& alternative : alternatives_) poses.push_back(&alternative.pose);
  }
  /// Eq. (10) for the hypotheses that do not lead, of the object that was detected or of another;
  /// `camera` has the moments of camera and extrinsics before.
  void shift_back(const CameraChange& change, const Matrix6d& back, const CameraMoments& camera,
                  bool detected);

  // --- objects that are put down elsewhere

  /// What detectors show before the object was seen, which makes it one that is put down elsewhere.
  void begin_unseen(std::vector<ModeWeights> shown) { lost_shown_ = std::move(shown); }
  /// What detectors show where the place is not known.
  const std::vector<ModeWeights>& lost_shown() const { return lost_shown_; }
  /// The same for a hypothesis that begins with a detection in a mode.
  std::vector<ModeWeights> shown_at_birth(std::size_t detector, std::size_t mode) const;
  /// Eq. (21): so many times in the mean the object was put down elsewhere.
  void leak(double jumps);
  /// Eq. (22): the update of every hypothesis is appended to `updates`; a component within
  /// the squared distance `explained` is explained by a hypothesis.
  PutDownEvidence observe_put_down(const JointGaussian& joint,
                                   const WeighedObservation& observation,
                                   const ObjectSensor& sensor, const GainFactors& factors,
                                   const ShownModes& shown, double explained,
                                   DetectionUpdates& updates) const;
  /// The weights, modes and scores after such an observation, whose components are at `places`.
  void take_in(const PutDownEvidence& seen, const DetectionUpdates& updates,
               const std::vector<std::uint64_t>& places,
               std::span<const ObservationComponent> components, double log_clutter, double memory);
  /// The weight of objects that were put down at the place of hypothesis `h`.
  void add_jump(std::size_t h, double log_weight, std::size_t detector, std::size_t mode);
  /// Drops hypotheses that do not lead and have no weight.
  void forget_places();

  // --- the stages of the reduction

  /// Appends hypotheses. The first one of an object leads and enters the joint Gaussian.
  void add(JointGaussian& joint, const Alternatives& births);
  /// Merges hypotheses that agree up to a symmetry. Returns the number of merges.
  std::size_t merge(JointGaussian& joint, const SymmetryGroup& symmetries,
                    const MergeBounds& bounds);
  /// Keeps at most `most` hypotheses: the heaviest, except for `best_scores` places, which go to
  /// those of the best score among the others, the newest of equals. The leading one always stays.
  void keep_best(std::size_t most, std::size_t best_scores);
  /// Divides all weights by their sum. Returns the logs of the sums.
  LogTotals normalise();
  /// The most probable hypothesis takes the lead where it is ahead by more than `margin` [nats].
  void choose_leader(JointGaussian& joint, double margin);
  /// Hypothesis `h` takes the lead.
  void make_leader(JointGaussian& joint, std::size_t h);

  // --- global hypotheses

  /// Index of the hypothesis with the id.
  std::optional<std::size_t> find(std::uint64_t id) const;

  /// Whether an alternative can still win: it has a score above this, and a weight that few
  /// detections can make up for.
  bool has_alternative_that_can_win(double score) const;
  /// Keeps the leading hypothesis alone; absence is impossible.
  void keep_leader();
  /// Drops the leading hypothesis; the heaviest alternative takes its place. Without any, returns
  /// the index of the pose, which the caller then erases.
  std::optional<std::size_t> drop_leader(JointGaussian& joint);
  /// Becomes the mixture of this, with weights times those of `own`, and of `other`. Hypotheses
  /// with the same id become one where they agree; else that of `other` gets the id `next_id`.
  void mix(JointGaussian& joint, const LogTotals& own, const OtherBelief& other,
           const SymmetryGroup& symmetries, const MergeBounds& bounds, std::uint64_t& next_id);

 private:
  template <class>
  friend struct StateFields;

  struct Leader {
    Standing standing;
    std::size_t position;    ///< index among the hypotheses
    std::size_t pose_index;  ///< index of its pose in the joint Gaussian
  };

  /// The leading hypothesis gets the largest weight there is: a camera that followed a heavier one,
  /// of less probability, would take the pose of the leading one anywhere.
  void catch_up();
  /// The update of hypothesis `h` by an observation with this explanation.
  DetectionUpdate moved_by(const JointGaussian& joint, std::size_t h, const SeenHypothesis& seen,
                           Explanation explanation, const GainFactors& factors) const;
  /// The places of all hypotheses, and runs at a place that become such at another.
  std::vector<std::uint64_t> places() const;
  void redirect_runs(std::uint64_t gone, std::uint64_t place);
  bool leads(std::size_t h) const { return leader_ && h == leader_->position; }
  /// Index of hypothesis `h`, one that does not lead, in alternatives_.
  std::size_t slot(std::size_t h) const { return leader_ && h > leader_->position ? h - 1 : h; }
  /// Index of the hypothesis at `slot` of alternatives_.
  std::size_t index_of(std::size_t slot) const {
    return leader_ && slot >= leader_->position ? slot + 1 : slot;
  }
  Standing& mutable_standing(std::size_t h);
  /// x <- F x for [xi_O; b] of hypothesis `h`.
  void transform(JointGaussian& joint, std::size_t h, const Matrix12d& f);
  /// xi_O <- xi_O - F (xi_O - xi_C) of hypothesis `h`.
  void approach_camera(JointGaussian& joint, std::size_t h, const Matrix6d& f);
  void add_noise(JointGaussian& joint, std::size_t h, const Matrix6d& q);
  /// The slow error of a camera that does not see now, but `last` does.
  OtherCamera seen_next(const JointGaussian& joint, std::size_t h, const ObservationSource& last,
                        const ObservationSource& source, const ObjectSensor& sensor) const;
  void see_from(JointGaussian& joint, std::size_t h, const ObservationSource& source,
                const ObjectSensor& sensor);
  /// Eq. (42), before the slow error itself decays, from the moments `before`.
  void decay_other_cameras(const JointGaussian& joint, std::size_t h, const SlowError& slow,
                           double a, const Matrix6d& stationary,
                           const std::optional<OtherMoments>* before);
  void erase_alternative(std::size_t h);
  void merge_two(JointGaussian& joint, std::size_t a, std::size_t b, const ConditionalPose& at_a,
                 const ConditionalPose& at_b);

  std::optional<Leader> leader_;
  Alternatives alternatives_;  ///< in the order of their births
  double log_absent_ = 0.0;
  double log_absence_probability_ = 0.0;
  std::vector<ModeWeights> lost_shown_;  ///< by detector; empty unless it is put down elsewhere
  std::optional<ObservationSource> seen_by_;  ///< whose slow errors those of the hypotheses are
};

}  // namespace posemix::internal
