// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <span>

#include "posemix/base/state_fields.hpp"

/// The probability that an instance exists, apart from that of its modes (docs/existence.md).
namespace posemix {

/// A beta distribution of a rate in (0, 1), with the density proportional to r^(a-1) (1-r)^(b-1).
struct BetaDistribution {
  double a = 1.0;
  double b = 1.0;
};

/// Settings of the existence of instances.
struct ExistenceSettings {
  /// Probability that a detection that is of no known instance is of an object of its class.
  double birth_probability = 0.25;
  /// Distribution over objects of the probability that the detector finds one that is in view and
  /// not hidden, per image.
  BetaDistribution object_rate = {1.0, 1.0};
  /// The same for what the detector takes for an object, and is none of this class: a part of
  /// another object, an object of another class, a thing in the background.
  BetaDistribution clutter_rate = {0.5, 8.0};
  double visible_time_s = 30.0;  ///< mean time after which an object in view becomes hidden
  double hidden_time_s = 10.0;   ///< mean time after which a hidden object appears again
  double lifetime_s = 1e3;       ///< mean time for which an object stays where it is
  /// Images that follow each other by less than this tell the same in part: one that follows by dt
  /// counts as 1 - exp(-dt / look_time_s) of an image.
  double look_time_s = 0.3;
  /// Two instances of classes whose origins are nearer than this do not both exist [m].
  double exclusion_m = 0.04;
  /// An instance is confirmed from this probability on, ...
  double confirmed_probability = 0.95;
  /// ... and an instance of a class is forgotten below this one.
  double deleted_probability = 1e-3;
};

/// @throws InvalidInput when a setting is out of range
void validate(const ExistenceSettings& settings);

/// The part of a look of its own that an image is, `dt` seconds after the last one.
double part_of_a_look(double dt, const ExistenceSettings& settings);

/// What an image says of an instance.
enum class Sighting {
  detected,
  missed,      ///< in view, and not detected
  out_of_view  ///< it could not be detected
};

/// Existence of one instance: a Bernoulli component of a labelled multi-Bernoulli filter with an
/// unknown probability of detection, and clutter that has one, too (docs/existence.md, eq. 1 to 4).
///
/// Invariant: the probabilities of all states sum to one.
class Existence {
 public:
  /// An instance that a detection begins.
  /// @throws InvalidInput when a setting is out of range
  explicit Existence(const ExistenceSettings& settings);

  /// Time goes on by `dt` seconds, eq. (1).
  void predict(double dt, const ExistenceSettings& settings);
  /// One image, `dt` seconds after the last one, eq. (2) and (3).
  void update(Sighting sighting, double dt, const ExistenceSettings& settings);

  /// Probability that the instance is an object that is there, whatever other instances there are.
  double probability() const;
  /// The same as odds.
  double odds() const;
  /// Probability that what was detected is in sight of the camera, hidden by nothing and not gone.
  double visible_probability() const;
  /// Mean of the probability with which the detector finds it, given that it is visible.
  double detection_probability() const;

 private:
  template <class>
  friend struct internal::StateFields;

  /// Values that a rate of detection is taken to have.
  static constexpr int kRates = 24;
  using Rates = Eigen::Array<double, kRates, 1>;

  static Rates rates();
  void normalise();

  Rates is_object_;  ///< probability that a rate is that of an object of the class
  Rates visible_;
  Rates hidden_;
  double gone_ = 0.0;
};

/// How often one instance was detected since its first detection.
struct InstanceCounts {
  double images = 0.0;      ///< in which it was in view, each as the part of a look that it is
  double detections = 0.0;  ///< in these
  bool is_object = false;   ///< whether it was an object of its class, by the truth of a recording
};

/// The settings as learned from instances of recordings with truth: birth_probability, object_rate
/// and clutter_rate of the largest posterior of the counts, beta-binomial distributions with a
/// normal prior of deviation one around the logarithms of the parameters as given.
/// @throws InvalidInput for counts that are negative, not finite or more detections than images,
/// and without at least two instances of objects and two that are none
ExistenceSettings fit_existence(std::span<const InstanceCounts> counts,
                                const ExistenceSettings& settings = {});

/// The part of the images of one camera in which anything was ever detected, which stands for the
/// field of view where it is not known: an object outside of it is not expected to be seen.
class FieldOfView {
 public:
  /// A detection at `position`, camera frame [m].
  void add(const Eigen::Vector3d& position);
  bool contains(const Eigen::Vector3d& position) const;

 private:
  template <class>
  friend struct internal::StateFields;

  Eigen::AlignedBox2d box_;  ///< of [x/z, y/z]
  double farthest_ = 0.0;    ///< largest z [m]
};

}  // namespace posemix
