// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "moving_object_state.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "posemix/base/statistics.hpp"

namespace posemix::internal {
namespace {

/// The noise with clutter of a default weight where it has none, and with offsets nearest to none
/// under the symmetries.
ObjectSensor prepared(ObjectSensor sensor, double default_clutter) {
  std::vector<NoiseComponent> components = sensor.noise.components();
  if (!sensor.symmetries.is_trivial()) {
    for (NoiseComponent& component : components)
      component.offset = sensor.symmetries.closest(component.offset, SE3d(), Matrix6d::Identity());
  }
  Clutter clutter = sensor.noise.clutter();
  if (!(clutter.weight > 0.0)) clutter.weight = default_clutter / (1.0 - default_clutter);
  sensor.noise = DetectorNoise(std::move(components), clutter, sensor.noise.dependence());
  return sensor;
}

Eigen::MatrixXd generator_of(const MotionModels& models) {
  const auto n = static_cast<Eigen::Index>(models.models.size());
  Eigen::MatrixXd generator = models.rates;
  if (generator.size() == 0) generator = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    generator(i, i) = 0.0;
    generator(i, i) = -generator.row(i).sum();
  }
  return generator;
}

}  // namespace

MovingObjectState::MovingObjectState(ObjectSensor sensor, MotionModels models,
                                     const MovingObjectSettings& settings)
    : models_(std::move(models)),
      settings_(settings),
      detector_(prepared(std::move(sensor), settings.default_clutter)),
      modes_(detector_.sensor().noise),
      generator_(generator_of(models_)),
      explained_(chi_square_quantile(settings.explained_probability, 6, "explained_probability")),
      merge_bounds_{settings.merge_rotation_rad, settings.merge_translation_m,
                    chi_square_quantile(settings.merge_probability, 6, "merge_probability")},
      lost_(static_cast<Eigen::Index>(models_.models.size()),
            static_cast<Eigen::Index>(modes_.count())) {
  for (std::size_t k = 0; k < model_count(); ++k) {
    const double start = models_.start.empty() ? 1.0 : models_.start[k];
    lost_.right(static_cast<Eigen::Index>(k), 0) = start;
  }
  lost_ *= 1.0 / lost_.total();
}

const MovingHypothesis* MovingObjectState::leader() const {
  const auto best = std::max_element(
      hypotheses_.begin(), hypotheses_.end(),
      [](const auto& a, const auto& b) { return a.weights.total() < b.weights.total(); });
  return best == hypotheses_.end() ? nullptr : &*best;
}

double MovingObjectState::normalise() {
  double total = lost_.total();
  for (const MovingHypothesis& hypothesis : hypotheses_) total += hypothesis.weights.total();
  for (MovingHypothesis& hypothesis : hypotheses_) hypothesis.weights *= 1.0 / total;
  lost_ *= 1.0 / total;
  return total;
}

namespace {

/// The objects of a hypothesis become, model by model, the mixture of them and those of another.
void mix_objects(MovingHypothesis& first, MovingHypothesis& second,
                 const SymmetryGroup& symmetries) {
  const Eigen::ArrayXd weights = first.weights.by_model();
  const Eigen::ArrayXd added = second.weights.by_model();
  for (std::size_t k = 0; k < first.objects.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    PlacedObject& moved = second.objects[k];
    if (!symmetries.is_trivial())
      moved.pose = symmetries.closest(moved.pose, first.objects[k].pose, Matrix6d::Identity());
    const WeightedObject parts[] = {{std::max(weights[row], 1e-300), &first.objects[k]},
                                    {added[row], &moved}};
    if (added[row] > 0.0) first.objects[k] = mixed(parts);
  }
}

/// Whether the most probable models of two hypotheses agree, and fit one Gaussian.
bool are_one_place(const MovingHypothesis& first, const MovingHypothesis& second,
                   const SymmetryGroup& symmetries, const MergeBounds& bounds) {
  const auto conditional = [](const PlacedObject& object) {
    ConditionalPose pose{object.pose, {}, Matrix12d::Zero(), Matrix12x6d::Zero()};
    pose.covariance.topLeftCorner<6, 6>() = object.pose_covariance();
    return pose;
  };
  const PlacedObject& heavier = first.objects[first.best_model()];
  PlacedObject lighter = second.objects[second.best_model()];
  ConditionalPose equivalent = conditional(lighter);
  if (!agree(Matrix6d::Zero(), symmetries, bounds, conditional(heavier), equivalent)) return false;
  lighter.pose = equivalent.pose;
  return fit_one_gaussian({first.weights.total(), &heavier}, {second.weights.total(), &lighter});
}

}  // namespace

/// Hypotheses that agree become one, of the id of the more probable: "Reduction".
MovingObjectState::Merges MovingObjectState::merge() {
  const SymmetryGroup& symmetries = sensor().symmetries;
  std::stable_sort(hypotheses_.begin(), hypotheses_.end(), [](const auto& a, const auto& b) {
    return a.weights.total() > b.weights.total();
  });
  Merges merges;
  for (std::size_t a = 0; a < hypotheses_.size(); ++a) {
    for (std::size_t b = a + 1; b < hypotheses_.size();) {
      MovingHypothesis& first = hypotheses_[a];
      MovingHypothesis& second = hypotheses_[b];
      if (!are_one_place(first, second, symmetries, merge_bounds_)) {
        ++b;
        continue;
      }
      mix_objects(first, second, symmetries);
      first.detections = std::max(first.detections, second.detections);
      second.weights.redirect(first.id, kAnyPlace, true);
      first.weights.redirect(second.id, kAnyPlace, true);
      first.weights.add(second.weights);
      const std::uint64_t gone = second.id;
      const std::uint64_t kept = first.id;
      merges.emplace_back(gone, kept);
      hypotheses_.erase(hypotheses_.begin() + static_cast<std::ptrdiff_t>(b));
      for (MovingHypothesis& hypothesis : hypotheses_)
        hypothesis.weights.redirect(gone, kept, hypothesis.id == kept);
      lost_.redirect(gone, kept, false);
    }
  }
  if (trace_) trace_->merged.insert(trace_->merged.end(), merges.begin(), merges.end());
  return merges;
}

void MovingObjectState::keep_heaviest() {
  constexpr double kNegligible = 1e-14;
  std::stable_sort(hypotheses_.begin(), hypotheses_.end(), [](const auto& a, const auto& b) {
    return a.weights.total() > b.weights.total();
  });
  while (!hypotheses_.empty() && (hypotheses_.size() > settings_.max_hypotheses ||
                                  !(hypotheses_.back().weights.total() > kNegligible))) {
    const std::uint64_t gone = hypotheses_.back().id;
    lost_.add(hypotheses_.back().weights);  // its place is not known any more
    hypotheses_.pop_back();
    for (MovingHypothesis& hypothesis : hypotheses_)
      hypothesis.weights.redirect(gone, kAnyPlace, false);
    lost_.redirect(gone, kAnyPlace, false);
  }
  normalise();
}

}  // namespace posemix::internal
