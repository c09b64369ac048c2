// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "detector/noise_rows.hpp"
#include "posemix/base/error.hpp"
#include "posemix/base/range.hpp"
#include "posemix/detector/noise_em.hpp"
#include "posemix/lie/pose_checks.hpp"

namespace posemix {
namespace {

using namespace internal;

/// Share of the observations below which a component is not estimated any more.
constexpr double kLostShare = 1e-9;
constexpr int kStepsPerOffsetStep = 5;

bool has_offset(const NoiseComponent& component) { return component.offset.log().norm() > 0.0; }

/// A component with its residuals.
struct Term {
  NoiseComponent component;
  std::shared_ptr<const ResidualRows> rows;
};

class NoiseEm {
 public:
  NoiseEm(std::span<const NoiseObservation> observations, const DetectorNoise& start,
          const NoiseEmSettings& settings)
      : observations_(observations), settings_(settings), clutter_(start.clutter()) {
    for (const NoiseComponent& component : start.components()) add(component);
    if (clutter_.weight > 0.0) set_clutter(clutter_.weight);
  }

  NoiseEmFit run() {
    double now = expect();
    history_.push_back(now);
    status_ = EmStatus::max_iterations;
    const bool moves = std::any_of(terms_.begin(), terms_.end(),
                                   [](const Term& term) { return has_offset(term.component); });
    for (int step = 1; step <= settings_.em.max_iterations; ++step) {
      const double before = now;
      maximise();
      now = expect();
      history_.push_back(now);
      const bool still = now - before <= settings_.em.tolerance * count();
      if (!moves && still) status_ = EmStatus::converged;
      if (moves && (still || step % kStepsPerOffsetStep == 0)) {
        const double after = move_offsets(now);
        if (still && after - now <= settings_.em.tolerance * count()) status_ = EmStatus::converged;
        if (after > now) history_.push_back(after);
        now = after;
      }
      if (status_ == EmStatus::converged) break;
    }
    return result(now);
  }

 private:
  double count() const { return static_cast<double>(observations_.size()); }

  void add(const NoiseComponent& component) {
    for (const Term& other : terms_) {
      if (has_offset(component) || has_offset(other.component)) continue;
      if (other.component.frame != component.frame) continue;
      terms_.push_back({component, other.rows});
      return;
    }
    terms_.push_back({component, rows_of(component)});
  }

  std::shared_ptr<const ResidualRows> rows_of(const NoiseComponent& component) const {
    return std::make_shared<const ResidualRows>(observations_, component.frame, component.offset);
  }

  /// The E-step: shares_, one column per component and one for clutter; returns the
  /// log-likelihood.
  double expect() {
    const auto columns = static_cast<Eigen::Index>(terms_.size()) + (clutter_.weight > 0.0 ? 1 : 0);
    shares_.resize(static_cast<Eigen::Index>(observations_.size()), columns);
    for (std::size_t k = 0; k < terms_.size(); ++k) {
      const NoiseComponent& component = terms_[k].component;
      shares_.col(static_cast<Eigen::Index>(k)) =
          terms_[k].rows->log_density(component.covariance) + std::log(component.weight);
    }
    if (clutter_.weight > 0.0)
      shares_.col(columns - 1)
          .setConstant(std::log(clutter_.weight) + log_uniform(clutter_.volume_m3));
    const Eigen::ArrayXd log_density = log_sum_exp_of_rows(shares_);
    shares_ = (shares_.colwise() - log_density).exp();
    return log_density.sum();
  }

  void maximise() {
    for (std::size_t k = 0; k < terms_.size(); ++k) {
      const auto share = shares_.col(static_cast<Eigen::Index>(k));
      NoiseComponent& component = terms_[k].component;
      const double weight = share.sum();
      component.weight = std::max(weight / count(), std::numeric_limits<double>::min());
      if (weight <= kLostShare * count()) continue;
      const Matrix6d second = terms_[k].rows->second_moment(share) / weight;
      component.covariance = bounded_covariance(second, settings_.em);
    }
    if (clutter_.weight > 0.0) set_clutter(shares_.col(shares_.cols() - 1).mean());
  }

  /// Sets the weight of clutter, or the least that it may have; then the components share what is
  /// left.
  void set_clutter(double weight) {
    clutter_.weight =
        std::max({weight, settings_.least_clutter, std::numeric_limits<double>::min()});
    if (clutter_.weight <= weight) return;
    for (Term& term : terms_) term.component.weight *= (1.0 - clutter_.weight) / (1.0 - weight);
  }

  /// Moves the offsets where that raises the log-likelihood `now`, and returns the log-likelihood
  /// reached. shares_ are those of the model that is kept.
  double move_offsets(double now) {
    std::vector<Vector6d> moves;
    moves.reserve(terms_.size());
    for (std::size_t k = 0; k < terms_.size(); ++k) moves.push_back(offset_step(k));
    const std::vector<Term> before = terms_;
    for (const double step : {1.0, 0.5, 0.25, 0.125}) {
      terms_ = before;
      for (std::size_t k = 0; k < terms_.size(); ++k) {
        Term& term = terms_[k];
        if (!has_offset(term.component)) continue;
        term.component.offset = term.component.offset * SE3d::exp(step * moves[k]);
        term.rows = rows_of(term.component);
      }
      const double after = expect();
      if (after >= now) return after;
    }
    terms_ = before;
    return expect();
  }

  /// The Gauss-Newton step d of an offset, offset Exp(d), which changes a residual by -S d to first
  /// order.
  Vector6d offset_step(std::size_t k) const {
    const NoiseComponent& component = terms_[k].component;
    if (!has_offset(component)) return Vector6d::Zero();
    const Matrix6d precision = component.covariance.inverse();
    Matrix6d information = Matrix6d::Zero();
    Vector6d gradient = Vector6d::Zero();
    for (std::size_t i = 0; i < observations_.size(); ++i) {
      const auto at = static_cast<Eigen::Index>(i);
      const double share = shares_(at, static_cast<Eigen::Index>(k));
      if (share < 1e-12) continue;
      const Matrix6d s = residual_turn(observations_[i].truth * component.offset, component.frame);
      information += share * s.transpose() * precision * s;
      gradient += share * s.transpose() * precision * terms_[k].rows->residuals().col(at);
    }
    const Eigen::LDLT<Matrix6d> factor(information);
    const Vector6d step = factor.solve(gradient);
    return step.allFinite() ? step : Vector6d::Zero();
  }

  NoiseEmFit result(double log_likelihood) {
    std::vector<NoiseComponent> components;
    std::size_t parameters = terms_.size() - (clutter_.weight > 0.0 ? 0 : 1);
    for (const Term& term : terms_) {
      const NoiseComponent& component = term.component;
      components.push_back(component);
      parameters += (settings_.em.diagonal ? 6 : 21) + (has_offset(component) ? 6 : 0);
      if (component.weight <= kLostShare || is_collapsed(component)) status_ = EmStatus::degenerate;
    }
    std::stable_sort(components.begin(), components.end(),
                     [](const auto& a, const auto& b) { return a.weight > b.weight; });
    if (!std::isfinite(log_likelihood)) status_ = EmStatus::degenerate;
    if (clutter_.weight <= kLostShare) clutter_.weight = 0.0;
    const double bic = static_cast<double>(parameters) * std::log(count()) - 2.0 * log_likelihood;
    return {DetectorNoise(std::move(components), clutter_),
            log_likelihood,
            std::move(history_),
            status_,
            parameters,
            bic};
  }

  /// Whether all variances are at the lower bound.
  bool is_collapsed(const NoiseComponent& component) const {
    const Eigen::VectorXd& unit = settings_.em.unit;
    Vector6d variance = component.covariance.diagonal();
    if (unit.size() != 0) variance = variance.array() / unit.array().square();
    return variance.maxCoeff() <= 1.001 * settings_.em.min_sd * settings_.em.min_sd;
  }

  std::span<const NoiseObservation> observations_;
  NoiseEmSettings settings_;
  std::vector<Term> terms_;
  Clutter clutter_;
  Eigen::ArrayXXd shares_;
  std::vector<double> history_;
  EmStatus status_ = EmStatus::converged;
};

void check(std::span<const NoiseObservation> observations, const NoiseEmSettings& settings) {
  require(!observations.empty(), "noise model: there are no observations");
  for (const NoiseObservation& observation : observations) {
    check_pose(observation.truth, "the truth of an observation");
    check_pose(observation.detected, "a detection");
  }
  EmSettings em = settings.em;
  em.components = 1;  // it has no meaning here
  internal::check_em_settings(em, 6);
  kPositive.check(settings.clutter_volume_m3, "noise model: clutter_volume_m3");
  kUnitInterval.check(settings.least_clutter, "noise model: least_clutter");
}

}  // namespace

Eigen::ArrayXd noise_log_density(const DetectorNoise& of_dependent,
                                 std::span<const NoiseObservation> observations) {
  const DetectorNoise noise = of_dependent.as_white();
  const auto size = static_cast<Eigen::Index>(observations.size());
  const bool clutter = noise.clutter().weight > 0.0;
  Eigen::ArrayXXd terms(size,
                        static_cast<Eigen::Index>(noise.components().size()) + (clutter ? 1 : 0));
  for (std::size_t k = 0; k < noise.components().size(); ++k) {
    const NoiseComponent& component = noise.components()[k];
    const ResidualRows rows(observations, component.frame, component.offset);
    terms.col(static_cast<Eigen::Index>(k)) =
        rows.log_density(component.covariance) + std::log(component.weight);
  }
  if (clutter) terms.col(terms.cols() - 1).setConstant(noise.log_clutter_density());
  return log_sum_exp_of_rows(terms);
}

NoiseEmFit refine_noise(std::span<const NoiseObservation> observations, const DetectorNoise& start,
                        const NoiseEmSettings& settings) {
  check(observations, settings);
  return NoiseEm(observations, start, settings).run();
}

}  // namespace posemix
