// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "posemix/base/range.hpp"
#include "posemix/base/units.hpp"
#include "posemix/density/concentrated_gaussian.hpp"
#include "posemix/detector/default_noise.hpp"
#include "posemix/detector/observation.hpp"
#include "posemix/detector/symmetry.hpp"
#include "posemix/mixture/mixture.hpp"

/// The objects of a scene from the detections in several images whose camera poses are known.
namespace posemix {

/// One image.
struct View {
  SE3d world_camera = {};  ///< T_world_camera, exact
  std::vector<Observation> observations = {};
};

/// What is known of the objects of one class.
struct ViewClass {
  DetectorNoise noise = default_detector_noise();
  SymmetryGroup symmetries = {};
};

/// By `Observation::class_id`, or `Observation::object` where it is not empty.
using ViewClasses = std::map<std::string, ViewClass>;

struct FuseViewsSettings {
  static constexpr NumberRange kProbability = kOpenUnitInterval;
  static constexpr NumberRange kShare{.lowest = 0, .highest = 1, .without_highest = true};
  /// Probability that an object of the scene is detected in a view.
  double detection_probability = 0.5;
  /// The part of a detector's clutter that is at the place of the object, in any orientation.
  double turned_share = 0.5;
  /// Two observations further apart than this part of the distribution of the difference of their
  /// positions (chi-square, 3 degrees of freedom) are of different objects.
  double gate_probability = 0.9999;
  /// Detectors err in the same way where they look from the same side: for the weights of modes,
  /// views within about this angle of each other count as one. Zero: all of them count.
  double mode_angle_rad = radians(30.0);
  /// Of two instances of a class that are nearer than this, the less probable one is dropped [m].
  double least_separation_m = 0.02;
  /// Number of hypotheses that are kept while observations are fused, and while they are
  /// associated.
  std::size_t max_hypotheses = 64;
  std::size_t max_association_hypotheses = 8;
  /// Number of components that are kept of an instance, and their least weight.
  std::size_t max_components = 6;
  double prune_below = 1e-3;
  /// Whether covariances of the observations replace that of the white error of the noise.
  bool use_given_covariances = true;

  bool operator==(const FuseViewsSettings&) const = default;
};

/// The observation of one view that an instance took.
struct ViewSupport {
  std::size_t view = 0;
  std::size_t observation = 0;  ///< index in the view
  /// Probability, given the leading mode, that one of its poses is of it, up to the error.
  double probability = 0.0;
};

/// An object of the scene.
struct FusedInstance {
  std::string class_id = {};  ///< the key of ViewClasses
  /// T_world_object, heaviest component first: its mean is the leading mode.
  Mixture<ConcentratedGaussian<SE3d>> density;
  double probability = 0.0;  ///< that there is an object, and not only clutter
  /// Sum of the probabilities of `support`: the number of views that agree on the leading mode.
  double supporting_views = 0.0;
  std::vector<ViewSupport> support = {};  ///< in the order of the views
};

/// The objects that the observations of several views are of.
///
/// **Fusion.** The product of what the views say of one object. For each view one case is true: a
/// component of the observation with a component of the noise, a pose that is turned (at the place
/// of the object, in any orientation), or clutter. Given the cases, errors are Gaussian, with the
/// slow error of two views correlated by the angle between them as (D2) of docs/many-objects.md
/// says: views from nearly the same side share it, and do not average it away. Gross errors
/// (NoiseComponent::run_length above one) draw their slow error anew. The pose is the maximum of
/// the joint density, found by Gauss-Newton, with its covariance, and that of the error in common
/// is added. Cases of little weight are dropped; those with the same pose are merged by the midway
/// rule. Without slow and common errors, clutter and turns this is the product of independent
/// mixtures (`fuse`).
///
/// **Association.** Observations of one class are joined, the pair or group with the largest gain
/// of log evidence first, while there is a gain: that all of them are of one object, or clutter,
/// against two objects. Objects and clutter are uniform over the volume of the noise's clutter. An
/// instance has one observation of each view at most.
///
/// **Symmetries.** Each pose is replaced by the equivalent one nearest to the instance; an angle
/// about an axis of symmetry is reported as uniform.
///
/// Instances are in the order of falling probability; of a class that is named by
/// `Observation::object` only the first. Classes without an entry have a ViewClass of defaults.
/// @throws InvalidInput naming view and observation for an observation that is not valid or without
/// object and class, a camera that is not finite, and for settings out of range
std::vector<FusedInstance> fuse_views(std::span<const View> views, const ViewClasses& classes = {},
                                      const FuseViewsSettings& settings = {});

}  // namespace posemix
