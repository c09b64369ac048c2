// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "detector_modes.hpp"
#include "filter/multi_object/noise_scale.hpp"
#include "filter/multi_object/object_belief.hpp"
#include "filter/multi_object/object_merge.hpp"
#include "filter/world_shift.hpp"
#include "mode_weights.hpp"
#include "observed_cases.hpp"
#include "placed_object.hpp"
#include "posemix/base/state_fields.hpp"

/// The posterior of MovingObjectFilter (docs/moving-objects.md).
namespace posemix::internal {

/// A hypothesis for the place of the object: a Gaussian per motion model.
struct MovingHypothesis {
  std::uint64_t id;
  std::uint64_t detections = 1;
  std::vector<PlacedObject> objects;  ///< by model
  ModeWeights weights;
  std::optional<SE3d> seen_from = {};  ///< T_camera_object at the last observation
  /// Before an observation, the part of the right weights in which the object has been turned.
  Eigen::ArrayXXd turned = {};

  /// Index of the most probable model.
  std::size_t best_model() const;
};

/// An observation with what the stages of an update need.
struct MovingObservation {
  WeighedObservation weighed;  ///< without clutter
  KnownFrame camera;
  double clutter;
  double stay;  ///< persistence of the detector's mode
  /// Probability, by model, that the object was turned since the last observation.
  Eigen::ArrayXd turned;
};

/// Weight that a hypothesis gains at an observation from other cases than itself, models x modes;
/// one column where modes are summed.
struct Arrival {
  std::uint64_t id = 0;
  Eigen::ArrayXXd weight = {};  ///< all of it
  /// The place was not known. Empty: this is a part of the hypothesis in `turned`, which was split.
  Eigen::ArrayXXd from_lost = {};
  /// The object was at the place of a hypothesis, of which this is the id, and has been turned.
  std::vector<std::pair<std::uint64_t, Eigen::ArrayXXd>> turned = {};
};

/// What a backward pass must know of one update besides the posteriors before and after it.
struct StepTrace {
  /// By hypothesis, the weights after the observation and before merges, by model.
  std::vector<std::pair<std::uint64_t, Eigen::ArrayXd>> weights = {};
  std::vector<Arrival> arrivals = {};
  std::vector<std::pair<std::uint64_t, std::uint64_t>> merged = {};  ///< ids: gone, and kept
  /// Of the slow error over the step, by hypothesis.
  std::vector<std::pair<std::uint64_t, double>> correlation = {};
  Vector6d slow_factor = Vector6d::Ones();  ///< of the scale of the slow error, learned
  KnownFrame camera = {};
};

/// The hypotheses and the case that the place is not known.
struct MovingBelief {
  std::vector<MovingHypothesis> hypotheses;
  ModeWeights lost;
};

/// The posterior after an observation, and how it came about.
struct StepRecord {
  double time_s;
  MovingBelief belief;
  std::vector<KnownFrame> frames;
  Matrix6d constant;
  StepTrace trace;
  Matrix6d change = Matrix6d::Zero();  ///< covariance, of the error of the camera's pose
  Eigen::Vector3d origin =
      Eigen::Vector3d::Zero();  ///< of all that, in the world of the caller [m]
};

Matrix6d moved(const Matrix6d& covariance, const WorldShift& shift);
KnownFrame moved(const KnownFrame& frame, const WorldShift& shift);
std::vector<KnownFrame> moved(std::vector<KnownFrame> frames, const WorldShift& shift);

/// The posterior of one object that moves, in a world whose origin is near the scene ("Far from the
/// origin" of docs/many-objects.md). What is given, and what is reported, is in the world of the
/// caller.
class MovingObjectState {
 public:
  MovingObjectState(ObjectSensor sensor, MotionModels models, const MovingObjectSettings& settings);

  /// Eq. (7) to (9).
  void advance(double time_s, const std::vector<KnownFrame>& frames);
  MovingObjectReport update(const Observation& observation, const KnownCamera& camera);

  MovingObjectEstimate estimate() const;
  using Components = std::vector<Component<ConcentratedGaussian<SE3d>>>;
  /// Components of the density given that the place is known.
  Components components() const;
  /// The same from a camera.
  Components relative_components(const KnownFrame& camera) const;
  /// The most probable hypothesis, over all models, from a camera.
  ConcentratedGaussian<SE3d> relative(const KnownFrame& camera) const;
  ConcentratedGaussian<SE3d> predicted_detection(const KnownFrame& camera) const;
  void move_world(const SE3d& by, const Matrix6d& added, const Matrix6d& constant);

  const ObjectSensor& sensor() const { return detector_.sensor(); }
  const MotionModels& models() const { return models_; }
  const MovingObjectSettings& settings() const { return settings_; }
  std::optional<double> time_s() const { return time_s_; }
  std::uint64_t observations() const { return observations_; }
  bool has_hypotheses() const { return !hypotheses_.empty(); }
  Matrix6d constant_covariance() const { return moved(constant_, to_world()); }
  /// Number of frames that the models name.
  std::size_t frames_needed() const;

  /// From now on updates leave a trace.
  void trace() { trace_.emplace(); }
  /// The trace of a step without an observation.
  void trace_prediction();
  /// The posterior, with the trace of the last update, before which the error of the camera's pose
  /// had become another one with the covariance `change`.
  StepRecord record(const Matrix6d& change) const;
  /// The posterior becomes that of a record, with the hypotheses and weights of `belief`.
  void restore(const StepRecord& record, const MovingBelief& belief);
  /// Given all that comes later, the belief at the time of this posterior from that at the time of
  /// the next record: docs/moving-objects.md, "Looking ahead".
  MovingBelief pulled_back(const StepRecord& next, const MovingBelief& after) const;
  /// As what a hypothesis goes on after a step, with the smoothed weight by model.
  struct LaterPart {
    Eigen::ArrayXd weight;
    const MovingHypothesis* hypothesis;
  };

 private:
  template <class>
  friend struct StateFields;

  using Evidence = std::vector<std::vector<ModeEvidence>>;  ///< by hypothesis and model

  WorldShift to_world() const { return WorldShift(origin_); }
  WorldShift to_scene() const { return WorldShift(-origin_); }
  void move_origin_to(const Eigen::Vector3d& origin);
  /// update() and pulled_back() in the world of this state.
  MovingObjectReport update_here(const Observation& observation, const KnownCamera& camera);
  MovingBelief pulled_back_here(const StepRecord& next, const MovingBelief& after) const;
  /// Components in that world; `added` is the covariance of what is not estimated and the same at
  /// every pose.
  Components components_here(const Matrix6d& added) const;

  std::size_t model_count() const { return models_.models.size(); }
  /// The frame that holds the object by a model; none for models without.
  const KnownFrame* frame_of(std::size_t model) const;
  PlacedObject as_of_model(const PlacedObject& object, std::size_t from, std::size_t to,
                           Matrix12d& jacobian) const;
  std::vector<PlacedObject> mixed_models(const MovingHypothesis& hypothesis,
                                         const Eigen::MatrixXd& transition) const;
  /// Motions of the frames up to a later time.
  std::vector<SE3d> frame_motions(const std::vector<KnownFrame>& later) const;
  MotionPrediction predicted(const PlacedObject& object, std::size_t model, double dt,
                             const std::vector<SE3d>& moved) const;
  Eigen::MatrixXd transition_over(double dt) const;
  /// Probability, by model, that the place is not known any more after so many seconds. Something
  /// stays of every hypothesis, so that there is a place to report however long the object was not
  /// seen.
  Eigen::ArrayXd gone_in(double dt) const;
  void leak(double dt);
  /// Probability, by model, of a turn to any orientation in so many seconds.
  Eigen::ArrayXd turned_in(double dt) const;
  KnownFrame camera_for(const KnownFrame& camera, std::size_t model) const;
  void decay_slow_errors(const KnownFrame& camera, double dt);
  Evidence evidence_of(const MovingObservation& observation) const;
  std::vector<double> place_evidence(const Evidence& evidence) const;
  /// Eq. (13): the likelihood ratio that the offsets of runs are as they were, for every run.
  std::vector<double> keep_offsets(MovingHypothesis& hypothesis) const;
  void draw_modes(MovingHypothesis& hypothesis, const MovingObservation& observation) const;
  /// What an observation says of runs: by place, the part of each that is kept, and the parts of
  /// wrong detections.
  struct RunEvidence {
    const std::vector<double>& places;
    const std::vector<double>& kept;
    WrongShares wrong;
    double peak;
  };
  double density_at(std::uint64_t place, const std::vector<double>& places, double peak,
                    double elsewhere) const;
  double weigh_runs(ModeWeights& weights, Eigen::Index row, const ModeEvidence& seen,
                    const RunEvidence& given, double& begun) const;
  /// A hypothesis after eq. (11), by model.
  struct WeighedHypothesis {
    Eigen::ArrayXd total = {};
    Eigen::ArrayXXd alone = {};  ///< of wrong detections that stand alone, by mode before
    Eigen::ArrayXd begun = {};   ///< of runs that began
  };
  /// Hypotheses in parts, as the cases of an observation fit no single Gaussian.
  struct SplitHypotheses {
    /// What became of a hypothesis: 0 is itself, and more, less one, the index of a part.
    struct Place {
      /// Where a component of the observation is; none where no case of it is probable.
      std::vector<std::optional<std::size_t>> of_component = {};
      std::size_t of_wrong = 0;   ///< where the detector is wrong
      Eigen::ArrayXd begun = {};  ///< weight of runs that began
      bool is_split = false;
      /// Of what the detector shows where it is right, by id, its own first; empty where it is not
      /// split.
      std::vector<PlaceShare> shares = {};
    };
    std::vector<Place> places = {};            ///< by hypothesis
    std::vector<MovingHypothesis> parts = {};  ///< the less probable ones
  };
  MovingHypothesis& at_place(std::size_t hypothesis, std::size_t place, SplitHypotheses& split) {
    return place == 0 ? hypotheses_[hypothesis] : split.parts[place - 1];
  }
  WeighedHypothesis weigh_modes(MovingHypothesis& hypothesis, std::vector<ModeEvidence>& evidence,
                                const std::vector<double>& places, const std::vector<double>& kept,
                                const MovingObservation& observation, double peak) const;
  void move(std::size_t index, const WeighedHypothesis& weighed,
            const std::vector<ModeEvidence>& evidence, const MovingObservation& observation,
            SplitHypotheses& split);
  MovingHypothesis part_of(MovingHypothesis& whole, const CaseGroup& group,
                           const WeighedHypothesis& weighed,
                           const std::vector<ModeEvidence>& evidence) const;
  template <class Belongs>
  void mix_cases(const std::vector<std::vector<ObservedCase>>& cases, const Belongs& belongs,
                 MovingHypothesis& hypothesis) const;
  std::vector<PlaceShare> shares_of(const std::vector<CaseGroup>& groups,
                                    const std::vector<std::uint64_t>& ids,
                                    const WeighedHypothesis& weighed,
                                    const std::vector<ModeEvidence>& evidence) const;
  void divide_runs(SplitHypotheses& split);
  void trace_split(std::uint64_t whole, const MovingHypothesis& part);
  MovingHypothesis birth(const ObservationComponent& seen, std::size_t mode,
                         const KnownFrame& camera) const;
  MovingHypothesis* explaining(const Evidence& evidence, std::size_t component, double least_weight,
                               SplitHypotheses& split);
  Eigen::ArrayXXd begun_from_lost(const MovingObservation& observation, double peak,
                                  std::size_t component) const;
  Eigen::ArrayXXd begun_by_turn(const MovingObservation& observation, const Evidence& evidence,
                                double peak, std::size_t component, std::size_t hypothesis) const;
  Arrival arrival(const MovingObservation& observation, const Evidence& evidence, double peak,
                  std::size_t component) const;
  void trace_arrival(const Arrival& all, std::uint64_t id, std::optional<std::size_t> mode);
  void trace_weights(const std::vector<MovingHypothesis>& births);
  std::vector<std::uint64_t> begin(const MovingObservation& observation, const Evidence& evidence,
                                   double peak, SplitHypotheses& split,
                                   std::vector<MovingHypothesis>& births);
  void place_runs(const MovingObservation& observation, const std::vector<std::uint64_t>& places,
                  SplitHypotheses& split);
  void make_probabilities(const std::vector<double>& of_mode, double total,
                          ModeEvidence& seen) const;
  MovingObservation weighed(const Observation& given, const KnownFrame& camera) const;
  double largest(const Evidence& evidence) const;
  /// Log density of a pose that may be anywhere in the volume of clutter.
  double log_anywhere() const;
  double take_in(const MovingObservation& observation, Evidence& evidence, SplitHypotheses& split,
                 std::vector<MovingHypothesis>& births);
  void describe(const ModeEvidence& seen, MovingObjectReport& report) const;
  void weigh_lost(const MovingObservation& observation, const std::vector<double>& places,
                  double peak);
  /// A part of a hypothesis that moved by a model, given all that comes later.
  struct SmoothedPart {
    std::size_t model;
    double weight;
    PlacedObject object;
  };
  PlacedObject smoothed_mixture(const PlacedObject& mixed, std::size_t model,
                                const MovingHypothesis& hypothesis, const StepRecord& next,
                                PlacedObject smoothed) const;
  void split_models(const MovingHypothesis& hypothesis, const Eigen::ArrayXd& sources,
                    const PlacedObject& mixed, const PlacedObject& smoothed, std::size_t k,
                    double weight, std::vector<SmoothedPart>& parts) const;
  void go_back(const MovingHypothesis& hypothesis, const Eigen::MatrixXd& transition,
               const LaterPart& later, const StepRecord& next,
               std::vector<SmoothedPart>& parts) const;
  void merge_parts(const std::vector<SmoothedPart>& parts, MovingHypothesis& hypothesis) const;
  /// Factors on the gain: slow errors of a typical noise are only considered.
  Vector18d gain_factors() const;
  double normalise();
  using Merges = std::vector<std::pair<std::uint64_t, std::uint64_t>>;  ///< gone, and kept
  Merges merge();
  void keep_heaviest();
  void learn(const MovingHypothesis& leader, const ModeEvidence& evidence,
             const Observation& observation, const KnownFrame& camera);
  /// What every hypothesis expected, by the id of it and of the parts that it was split into.
  using Expected = std::map<std::uint64_t, const ModeEvidence*>;
  Expected expected(const Evidence& evidence, const SplitHypotheses& split) const;
  Matrix6d reported_covariance(const PlacedObject& object, std::size_t model,
                               const Matrix6d& added) const;
  PlacedObject reported(const PlacedObject& object, std::size_t model, const Matrix6d& added) const;
  /// What is reported of a hypothesis, over all models.
  PlacedObject reported(const MovingHypothesis& hypothesis, const Matrix6d& added) const;
  /// The places of all hypotheses but one.
  std::vector<std::uint64_t> places_but(std::uint64_t own) const;
  const MovingHypothesis* leader() const;

  MotionModels models_;
  MovingObjectSettings settings_;
  LearnedSensor detector_;
  DetectorModes modes_;
  Eigen::MatrixXd generator_;  ///< of the Markov chain of models
  double explained_;
  MergeBounds merge_bounds_;
  std::vector<MovingHypothesis> hypotheses_;
  ModeWeights lost_;  ///< the place is not known
  std::vector<KnownFrame> frames_;
  Matrix6d constant_ = Matrix6d::Zero();  ///< constant error of the camera
  Eigen::Vector3d origin_ =
      Eigen::Vector3d::Zero();  ///< of all that, in the world of the caller [m]
  std::optional<double> time_s_;
  std::optional<double> seen_s_;  ///< time of the last observation
  std::uint64_t observations_ = 0;
  std::uint64_t next_id_ = 1;
  std::optional<StepTrace> trace_;
};

}  // namespace posemix::internal
