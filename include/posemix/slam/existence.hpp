// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <optional>

/// The probability that an instance exists, apart from that of its modes (docs/existence.md).
namespace posemix {

/// Settings of the existence of instances.
struct ExistenceSettings {
  /// Probability that the detector finds an object that is in view and not hidden, per image.
  double detection_probability = 0.6;
  /// Mean number of detections of one class in an image that are of no object.
  double clutter_rate = 0.3;
  /// Probability that a detection of no known instance is of an object.
  double birth_probability = 0.5;
  /// Mean time for which an object stays in the scene [s].
  double lifetime_s = 1e4;
  /// Mean time after which an object in view becomes hidden by another, or appears again [s].
  double occlusion_time_s = 10.0;
  /// Share of the detections that name another class than that of the object.
  double confusion_probability = 0.1;
  /// Two objects whose origins would be nearer than this do not both exist [m].
  double exclusion_m = 0.03;
  /// An instance is confirmed from this probability on, ...
  double confirmed_probability = 0.95;
  /// ... and forgotten below this one.
  double deleted_probability = 0.01;
};

/// @throws InvalidInput when a setting is out of range
void validate(const ExistenceSettings& settings);

/// What an image says of an instance.
struct ExistenceEvidence {
  /// Whether the instance would lie in the field of view.
  bool in_view = true;
  /// Log of the density of its detection given the instance over the intensity of clutter [nats];
  /// none where it was not detected.
  std::optional<double> log_ratio = {};
  /// The same of a detection that names another class at its place.
  std::optional<double> log_confused = {};
};

/// Existence of one instance: a hidden Markov model of the states "visible", "hidden" and "does not
/// exist" (docs/existence.md, eq. 1 to 3).
class Existence {
 public:
  /// An instance that a detection begins.
  /// @throws InvalidInput for a probability that is not in (0, 1)
  explicit Existence(double birth_probability);

  /// Time goes on by `dt` seconds, eq. (1).
  void predict(double dt, const ExistenceSettings& settings);
  /// One image, eq. (2) and (3).
  void update(const ExistenceEvidence& evidence, const ExistenceSettings& settings);

  /// Probability that the instance exists, whatever other instances there are.
  double probability() const { return visible_ + hidden_; }
  /// Probability that it exists and is hidden.
  double hidden() const { return hidden_; }
  /// Odds of existence.
  double odds() const { return probability() / absent_; }

 private:
  void normalise();

  double visible_;
  double hidden_ = 0.0;
  double absent_;
};

/// The part of the images of one camera in which anything was ever detected, which stands for the
/// field of view: an object outside of it is not expected to be seen.
class FieldOfView {
 public:
  /// A detection at `position`, camera frame [m].
  void add(const Eigen::Vector3d& position);
  bool contains(const Eigen::Vector3d& position) const;

 private:
  Eigen::AlignedBox2d box_;  ///< of [x/z, y/z]
  double farthest_ = 0.0;    ///< largest z [m]
};

}  // namespace posemix
