// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/existence.hpp"

#include <algorithm>
#include <cmath>

#include "posemix/base/range.hpp"

namespace posemix {
namespace {

/// Probability, per image, that something else is detected at the place of an object that is hidden
/// or gone.
constexpr double kChance = 2e-3;

/// Time alone makes it no less probable that the instance is there.
constexpr double kLeastThere = 1e-6;

void check(const BetaDistribution& rate, const char* name) {
  kPositive.check(rate.a, std::string(name) + ".a");
  kPositive.check(rate.b, std::string(name) + ".b");
}

/// Masses of a beta distribution at the given rates.
template <class Rates>
Rates masses(const BetaDistribution& rate, const Rates& at) {
  const Rates density = at.pow(rate.a - 1.0) * (1.0 - at).pow(rate.b - 1.0);
  return density / density.sum();
}

}  // namespace

void validate(const ExistenceSettings& settings) {
  kOpenUnitInterval.check(settings.birth_probability, "birth_probability");
  check(settings.object_rate, "object_rate");
  check(settings.clutter_rate, "clutter_rate");
  kPositive.check(settings.visible_time_s, "visible_time_s");
  kPositive.check(settings.hidden_time_s, "hidden_time_s");
  kPositive.check(settings.lifetime_s, "lifetime_s");
  kNotNegative.check(settings.look_time_s, "look_time_s");
  kNotNegative.check(settings.exclusion_m, "exclusion_m");
  kOpenUnitInterval.check(settings.confirmed_probability, "confirmed_probability");
  NumberRange{.lowest = 0.0, .highest = settings.confirmed_probability, .without_highest = true}
      .check(settings.deleted_probability, "deleted_probability");
}

double part_of_a_look(double dt, const ExistenceSettings& settings) {
  return settings.look_time_s > 0.0 ? -std::expm1(-dt / settings.look_time_s) : 1.0;
}

Existence::Rates Existence::rates() { return Rates::LinSpaced(0.5 / kRates, 1.0 - 0.5 / kRates); }

Existence::Existence(const ExistenceSettings& settings) {
  validate(settings);
  // That it was detected once makes high rates more probable, and is no news of its kind.
  const auto seen_once = [](const Rates& prior) {
    const Rates seen = prior * rates();
    return Rates(seen / seen.sum());
  };
  const Rates object =
      settings.birth_probability * seen_once(masses(settings.object_rate, rates()));
  const Rates clutter =
      (1.0 - settings.birth_probability) * seen_once(masses(settings.clutter_rate, rates()));
  visible_ = object + clutter;
  is_object_ = object / visible_;
  hidden_.setZero();
}

void Existence::normalise() {
  const double sum = visible_.sum() + hidden_.sum() + gone_;
  visible_ /= sum;
  hidden_ /= sum;
  gone_ /= sum;
}

void Existence::predict(double dt, const ExistenceSettings& settings) {
  // Eq. (1): the chain between visible and hidden has the rates 1/v and 1/h, and leaks.
  const double leave = 1.0 / settings.visible_time_s;
  const double back = 1.0 / settings.hidden_time_s;
  const double mixed = -std::expm1(-(leave + back) * dt) / (leave + back);
  const double there = visible_.sum() + hidden_.sum();
  // Over days nothing would be left, and no sighting could bring it back.
  const double stays =
      std::max(std::exp(-dt / settings.lifetime_s), std::min(kLeastThere / there, 1.0));
  gone_ += (1.0 - stays) * there;
  const Rates moved = mixed * (leave * visible_ - back * hidden_);
  visible_ = stays * (visible_ - moved);
  hidden_ = stays * (hidden_ + moved);
  normalise();
}

void Existence::update(Sighting sighting, double dt, const ExistenceSettings& settings) {
  if (sighting == Sighting::out_of_view) return;
  const double part = part_of_a_look(dt, settings);
  const bool detected = sighting == Sighting::detected;
  // Eq. (2) and (3), to the power of the part of a look that the image is.
  const Rates likelihood = detected ? rates() : Rates(1.0 - rates());
  const double by_chance = detected ? kChance : 1.0 - kChance;
  visible_ *= likelihood.pow(part);
  hidden_ *= std::pow(by_chance, part);
  gone_ *= std::pow(by_chance, part);
  normalise();
}

double Existence::probability() const { return (is_object_ * (visible_ + hidden_)).sum(); }

double Existence::odds() const {
  return probability() / (gone_ + ((1.0 - is_object_) * (visible_ + hidden_)).sum());
}

double Existence::visible_probability() const { return visible_.sum(); }

double Existence::detection_probability() const {
  return (rates() * visible_).sum() / visible_.sum();
}

void FieldOfView::add(const Eigen::Vector3d& position) {
  if (!(position.z() > 0.0)) return;
  box_.extend(Eigen::Vector2d(position.head<2>() / position.z()));
  farthest_ = std::max(farthest_, position.z());
}

bool FieldOfView::contains(const Eigen::Vector3d& position) const {
  // What stands still before a camera that does is always at one place, but for rounding.
  constexpr double kRounding = 1e-6;
  const Eigen::Vector2d direction = position.head<2>() / position.z();
  return position.z() > 0.0 && position.z() <= farthest_ * (1.0 + kRounding) &&
         box_.squaredExteriorDistance(direction) <= kRounding * kRounding;
}

}  // namespace posemix
