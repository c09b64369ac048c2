// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <mutex>
#include <optional>
#include <vector>

#include "multi_object_state.hpp"
#include "posemix/base/state_fields.hpp"
#include "posemix/density/pose_stack.hpp"
#include "posemix/mixture/mixture.hpp"

namespace posemix::internal {

/// The weights of two cases divided by their sum, which is returned.
LogTotals normalise_pair(LogTotals& a, LogTotals& b);

/// The global hypotheses of a MultiObjectFilter (docs/many-objects.md, "Global hypotheses").
///
/// Where two modes of an object tie and place the camera differently, a state that has one camera
/// for both would lose much. It is split into two: one in which the leading hypothesis of the
/// object is certain, and one in which it is impossible. States are mixed again when that loses
/// little, or when there are too many of them.
///
/// Invariants: there is at least one state; the weights sum to one; the first one is the most
/// probable, up to the margin of a leading hypothesis; a hypothesis of an object has the same id in
/// all states.
class GlobalHypotheses {
 public:
  /// `origin` is that of the state's world, in that of the caller [m].
  explicit GlobalHypotheses(const MultiObjectState& initial,
                            const Eigen::Vector3d& origin = Eigen::Vector3d::Zero());

  /// A copy makes its own summary.
  GlobalHypotheses(const GlobalHypotheses& other) : list_(other.list_), origin_(other.origin_) {}
  GlobalHypotheses(GlobalHypotheses&&) = delete;
  GlobalHypotheses& operator=(const GlobalHypotheses&) = delete;
  GlobalHypotheses& operator=(GlobalHypotheses&&) = delete;
  ~GlobalHypotheses() = default;

  /// From the world of all states, whose origin is near the camera, to that of the caller.
  WorldShift to_world() const { return WorldShift(origin_); }
  /// The origin that the world of the states should have for a camera of this pose, in the world
  /// of the caller.
  Eigen::Vector3d origin_for(const SE3d& camera) const;
  /// The same for the camera as it is.
  Eigen::Vector3d origin_for_camera() const;
  void move_origin_to(const Eigen::Vector3d& origin);
  /// The mixture of all states as one: the first state, with the hypotheses of the others. It is
  /// made when it is first asked for, which threads may do at the same time.
  const MultiObjectState& summary() const;
  /// The joint Gaussian of camera and leading hypotheses as it is reported, in the world of the
  /// caller, made likewise.
  const ConcentratedGaussian<PoseStackd>& joint() const;
  /// The first state: settings, detectors and extrinsics are as many in all.
  const MultiObjectState& first() const { return list_.front().state; }
  std::size_t object_count() const { return list_.front().state.objects.size(); }
  /// Whether the object has a hypothesis in any state.
  bool is_known(std::size_t j) const;
  /// A prediction of every state.
  template <class Predict>
  void for_each(Predict predict) {
    for (Weighted& one : list_) predict(one.state);
    reset_reports();
  }
  /// One observation of object `j`.
  ObjectUpdateReport update(std::size_t j, const Observation& observation,
                            const ObservationSource& source);
  /// The same of a pose alone.
  ObjectUpdateReport update(std::size_t j, const SE3d& camera_object);
  void forget(std::size_t j);

  /// The camera's density in the world of the caller, a component for each state.
  Mixture<ConcentratedGaussian<SE3d>> camera() const;
  /// The same of an object, given that it was detected: a component for each of its hypotheses
  /// in each state. Object `j` must have a hypothesis.
  Mixture<ConcentratedGaussian<SE3d>> object(std::size_t j) const;

 private:
  template <class>
  friend struct StateFields;

  struct Weighted {
    MultiObjectState state;
    LogTotals log = {};  ///< of its weight
  };

  const MultiObjectSettings& settings() const { return list_.front().state.settings; }
  /// The object becomes active in all states. Where too many are, those that were not seen for
  /// longest become passive.
  void activate(std::size_t j);
  /// Whether the object is to stay active when others become passive, by index; empty where none
  /// does.
  std::vector<bool> objects_kept(std::size_t j) const;
  /// All states get the base of the first one, and the same active objects.
  void rebase(const std::vector<bool>& kept);
  /// The world of the states gets its origin at the camera where that is far from it. Reports are
  /// made anew.
  void stay_near_the_origin();
  void reset_reports();
  void split(std::size_t j, KeptVector<ObservedDetection>& observed, const Starters& may_start);
  /// States whose camera would be in several places, by components of the observation, are split by
  /// those.
  void split_by_components(std::size_t j, KeptVector<ObservedDetection>& observed,
                           KeptVector<Starters>& may_start);
  void normalise();
  /// The next new hypothesis has the same id in all states, one that none has yet.
  void share_next_id();
  /// The most probable state becomes the first where it is ahead by the margin of a leading
  /// hypothesis.
  void choose_first();
  /// Mixes the pairs that lose least, as long as there are too many states or little is lost.
  void reduce();
  /// What no detection tells of is taken out of all states now and then, eq. (31).
  void take_out_world_error();
  double loss_of_mixing(const Weighted& a, const Weighted& b) const;
  /// Probability of the hypothesis with the id, over all states.
  double probability_of(std::size_t j, std::uint64_t id) const;
  /// The id of the most probable hypothesis of an object; the one that leads in the first state
  /// stays up to the margin.
  std::optional<std::uint64_t> leading_id(std::size_t j) const;
  MultiObjectState mixed() const;

  std::vector<Weighted> list_;
  Eigen::Vector3d origin_;  ///< of their world, in that of the caller [m]
  mutable std::mutex mutex_;
  mutable std::optional<MultiObjectState> summary_;                ///< where it was asked for
  mutable std::optional<ConcentratedGaussian<PoseStackd>> joint_;  ///< the same
  /// For poses alone, so that no frame asks the heap for one.
  Observation of_a_pose_ = observation_of(SE3d());
};

}  // namespace posemix::internal
