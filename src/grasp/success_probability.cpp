// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/grasp/success_probability.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>
#include <stdexcept>
#include <utility>

#include <nlopt.hpp>

#include "grasp/box_integral.hpp"
#include "posemix/base/error.hpp"
#include "posemix/base/range.hpp"
#include "posemix/lie/pose_checks.hpp"
#include "posemix/mixture/log_weights.hpp"

namespace posemix {
namespace {

using internal::BoxIntegral;
using internal::Cover;

template <class D>
SuccessEstimate estimate(const BoxIntegral<D>& integral, std::size_t components, const SE3d& m,
                         RandomStream& stream, const SuccessSettings& settings) {
  Eigen::ArrayXd values(static_cast<Eigen::Index>(settings.replicates));
  for (double& value : values) value = integral(m, settings.points, stream, Cover::whole);
  const double n = static_cast<double>(settings.replicates);
  const double variance = (values - values.mean()).square().sum() / (n - 1.0);
  const double unseen = integral.one_draw(m, settings.points) / n;
  return {std::clamp(values.mean(), 0.0, 1.0), std::hypot(std::sqrt(variance / n), unseen),
          settings.points * settings.replicates * components};
}

void check(const SuccessSettings& settings) {
  require(settings.replicates >= 2, "success probability: expected at least 2 replicates");
  require(settings.points >= 1, "success probability: expected at least 1 point");
  internal::check_count(settings.replicates, "success probability: replicates");
  internal::check_count(settings.points, "success probability: points");
  require(settings.points <= internal::kLargestCount / settings.replicates,
          "success probability: too many points in so many replicates");
}

/// The box at `start` moved by x, in units of its sides.
SE3d moved(const SE3d& start, const ToleranceBox& box, std::span<const double> x) {
  const Eigen::Map<const Vector6d> step(x.data());
  return start * SE3d(SO3d::exp(step.head<3>().cwiseProduct(box.rotation)),
                      step.tail<3>().cwiseProduct(box.translation));
}

/// Ascends from one start with the same points for every m, so that the function is smooth.
template <class D>
class Ascent {
 public:
  Ascent(const BoxIntegral<D>& integral, const ToleranceBox& box, const SE3d& start,
         const RandomStream& stream, const BestGraspSettings& settings)
      : integral_(integral), box_(box), start_(start), stream_(stream), settings_(settings) {}

  SE3d run() {
    nlopt::opt search(nlopt::LD_LBFGS, 6);
    search.set_max_objective(
        [](const std::vector<double>& x, std::vector<double>& gradient, void* self) {
          return static_cast<Ascent*>(self)->value(x, gradient);
        },
        this);
    search.set_ftol_rel(settings_.tolerance);
    search.set_maxeval(settings_.max_evaluations);
    std::vector<double> x(6, 0.0);
    best_ = x;
    try {
      double reached = 0.0;
      search.optimize(x, reached);
    } catch (const std::runtime_error&) {  // rounding stopped progress: the best point stands
    }
    return moved(start_, box_, best_);
  }

  int evaluations = 0;

 private:
  double log_probability(std::span<const double> x) {
    ++evaluations;
    RandomStream same = stream_;
    constexpr double kLeast = 1e-300;
    return std::log(
        std::max(integral_(moved(start_, box_, x), settings_.points, same, Cover::smooth), kLeast));
  }

  double value(const std::vector<double>& x, std::vector<double>& gradient) {
    const double here = log_probability(x);
    if (here > best_value_) {
      best_value_ = here;
      best_ = x;
    }
    constexpr double kStep = 1e-4;
    std::vector<double> near = x;
    for (std::size_t i = 0; i < gradient.size(); ++i) {
      near[i] = x[i] + kStep;
      const double up = log_probability(near);
      near[i] = x[i] - kStep;
      gradient[i] = (up - log_probability(near)) / (2.0 * kStep);
      near[i] = x[i];
    }
    return here;
  }

  const BoxIntegral<D>& integral_;
  const ToleranceBox& box_;
  SE3d start_;
  RandomStream stream_;
  const BestGraspSettings& settings_;
  std::vector<double> best_;
  double best_value_ = -std::numeric_limits<double>::infinity();
};

/// Indices of the heaviest components, heaviest first.
template <class D>
std::vector<std::size_t> heaviest(const Mixture<D>& mixture, std::size_t count) {
  std::vector<std::size_t> order =
      heaviest_first(mixture.size(), [&](std::size_t i) { return mixture[i].log_weight; });
  order.resize(std::min(count, order.size()));
  return order;
}

}  // namespace

template <class D>
SuccessEstimate success_probability(const Mixture<D>& mixture, const ToleranceBox& box,
                                    const SE3d& m, RandomStream& stream,
                                    const SuccessSettings& settings) {
  check(settings);
  check_pose(m, "success_probability: the grasp");
  return estimate(BoxIntegral<D>(mixture, box), mixture.size(), m, stream, settings);
}

template <class D>
BestGrasp best_grasp(const Mixture<D>& mixture, const ToleranceBox& box, RandomStream& stream,
                     const BestGraspSettings& settings) {
  check(settings.final);
  require(settings.starts > 0, "best_grasp: expected at least 1 start");
  require(settings.points > 0, "best_grasp: expected at least 1 point");
  internal::check_count(settings.points, "best_grasp: points");
  kNotNegative.check(settings.tolerance, "best_grasp: tolerance");
  const BoxIntegral<D> integral(mixture, box);
  BestGrasp best{{}, {}, {}, 0};
  for (const std::size_t k : heaviest(mixture, settings.starts)) {
    const SE3d start = mixture[k].density.mean();
    Ascent<D> ascent(integral, box, start, stream, settings);
    const SE3d reached = ascent.run();
    best.evaluations += ascent.evaluations;
    RandomStream same = stream;
    best.candidates.push_back(
        {start, reached, estimate(integral, mixture.size(), reached, same, settings.final)});
  }
  std::stable_sort(best.candidates.begin(), best.candidates.end(),
                   [](const GraspCandidate& a, const GraspCandidate& b) {
                     return a.success.probability > b.success.probability;
                   });
  best.pose = best.candidates.front().pose;
  best.success = best.candidates.front().success;
  return best;
}

template SuccessEstimate success_probability(const Mixture<ConcentratedGaussian<SE3d>>&,
                                             const ToleranceBox&, const SE3d&, RandomStream&,
                                             const SuccessSettings&);
template SuccessEstimate success_probability(const Mixture<ProjectedGaussian<SE3d>>&,
                                             const ToleranceBox&, const SE3d&, RandomStream&,
                                             const SuccessSettings&);
template BestGrasp best_grasp(const Mixture<ConcentratedGaussian<SE3d>>&, const ToleranceBox&,
                              RandomStream&, const BestGraspSettings&);
template BestGrasp best_grasp(const Mixture<ProjectedGaussian<SE3d>>&, const ToleranceBox&,
                              RandomStream&, const BestGraspSettings&);

}  // namespace posemix
