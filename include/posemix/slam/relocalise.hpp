// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "posemix/base/units.hpp"
#include "posemix/base/words.hpp"
#include "posemix/slam/multi_object_slam.hpp"

/// An old map in the world of a new run, found by objects that are in both (docs/state.md).
namespace posemix {

/// Settings of `relocalise`.
struct RelocaliseSettings {
  /// Fewer objects that agree are not enough.
  std::size_t least_objects = 2;
  /// Of two maps that differ in where they place the new world, the better one has this probability
  /// at least, else they are ambiguous.
  double least_probability = 0.95;
  /// Two objects agree within this quantile of their error (chi-square, 6 degrees of freedom).
  double agreement_probability = 0.999;
  /// Probability that an object is not where it was, ...
  double moved_probability = 0.1;
  double volume_m3 = 1.0;  ///< ... but anywhere in this volume
  /// The rotation between the worlds is known with this standard deviation about any axis, else
  /// it is taken as undetermined [rad].
  double largest_rotation_sd_rad = radians(10.0);
  /// Objects that exist with less than this probability take no part.
  double least_existence = 0.5;
};

/// What a relocalisation found.
enum class RelocaliseOutcome {
  found,
  too_few_shared,  ///< fewer objects are in both maps than needed
  too_few_agree,   ///< fewer agree on one pose than needed
  undetermined,    ///< those that agree leave the rotation free, as objects with symmetries may
  ambiguous        ///< another pose is about as probable
};

/// The words of RelocaliseOutcome in messages and in Python.
template <>
inline constexpr WordTable<RelocaliseOutcome, 5> words<RelocaliseOutcome>{{
    {"found", RelocaliseOutcome::found},
    {"too_few_shared", RelocaliseOutcome::too_few_shared},
    {"too_few_agree", RelocaliseOutcome::too_few_agree},
    {"undetermined", RelocaliseOutcome::undetermined},
    {"ambiguous", RelocaliseOutcome::ambiguous},
}};

/// An object of the old map and the one of the new run that it is, under one hypothesis each.
struct AgreedObject {
  std::string old_object;      ///< id
  std::size_t old_hypothesis;  ///< index in MultiObjectSlam::hypotheses
  std::string new_object;      ///< id
  std::size_t new_hypothesis;
  double squared_distance;  ///< from where all others expect it, in standard deviations
};

/// An object of the old map in the new world.
struct RelocatedObject {
  std::string object;  ///< its id in the old map
  PoseDensity world;   ///< T_newworld_object, with all that both maps know of it
  /// Its covariance where the camera of the new run is at its estimate: without what the errors of
  /// both have in common.
  Matrix6d given_camera;
  double probability;  ///< that it is there
  bool is_agreed;      ///< whether it is one of Relocalisation::agreed
};

/// Result of `relocalise`.
struct Relocalisation {
  RelocaliseOutcome outcome = RelocaliseOutcome::too_few_shared;
  /// T_newworld_oldworld; only where it was found. Its covariance (perturbation on the left) has
  /// what the errors of both maps have in common taken into account.
  std::optional<PoseDensity> new_old = {};
  double probability = 0.0;  ///< of the best pose among all that were found
  std::size_t shared = 0;    ///< number of objects of the new run that the old map may have
  std::vector<AgreedObject> agreed = {};      ///< of the best pose, found or not
  std::vector<std::string> disagreeing = {};  ///< ids of objects of the new run that are elsewhere
  /// Where found: the objects of the old map that stand still, but for those that may be one of
  /// `disagreeing`.
  std::vector<RelocatedObject> objects = {};
};

/// The pose of an old map in the world of a new run, from the objects that are in both: those of
/// one id, or of one class, which instance being which is found too. Every object may be at any of
/// its hypotheses in both maps, up to its symmetries, and some may have been moved: the pose is
/// that of the largest posterior over which objects agree, under which hypotheses. Objects that
/// move take no part.
/// @throws InvalidInput when a setting is out of range
Relocalisation relocalise(const MultiObjectSlam& old_map, const MultiObjectSlam& now,
                          const RelocaliseSettings& settings = {});

/// The models of the old map with where they are in the new world as priors, for a tracker that
/// begins where the new run has its camera. That pose is exact there, and the priors are
/// RelocatedObject::given_camera: what the world is to that tracker. Models of objects that were
/// not relocated have no prior.
/// @throws InvalidInput, with the outcome, where the pose was not found
std::vector<ObjectModel> models_with_priors(const MultiObjectSlam& old_map,
                                            const Relocalisation& relocalisation);

}  // namespace posemix
