// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "detector/slow_error_jackknife.hpp"

#include <cmath>
#include <limits>
#include <map>

#include <Eigen/Cholesky>

namespace posemix::internal {
namespace {

/// Step of the differences, in the logs of the parameters.
constexpr double kDifferenceStep = 0.02;

/// Derivatives of the log-likelihood of a recording by the free parameters.
struct Derivatives {
  Eigen::VectorXd gradient;
  Eigen::MatrixXd hessian;
};

/// The differences of one vector of values: the values at x, and those with one and with two of the
/// parameters moved up and down.
class Differences {
 public:
  Differences(const LikelihoodByTrack& likelihood, std::span<const std::size_t> recordings,
              std::span<const double> x, const std::vector<bool>& is_free)
      : likelihood_(likelihood), x_(x.begin(), x.end()) {
    for (std::size_t i = 0; i < is_free.size(); ++i) {
      if (is_free[i]) free_.push_back(i);
    }
    std::map<std::size_t, Eigen::Index> index;
    for (const std::size_t recording : recordings) {
      const auto next = static_cast<Eigen::Index>(index.size());
      rows_.push_back(index.emplace(recording, next).first->second);
    }
    count_ = static_cast<Eigen::Index>(index.size());
  }

  const std::vector<std::size_t>& free() const { return free_; }

  /// The gradient of the sum over all recordings.
  Eigen::VectorXd gradient() const {
    Eigen::VectorXd result(static_cast<Eigen::Index>(free_.size()));
    for (std::size_t i = 0; i < free_.size(); ++i) {
      result[static_cast<Eigen::Index>(i)] =
          (values({{i, 1.0}}) - values({{i, -1.0}})).sum() / (2.0 * kDifferenceStep);
    }
    return result;
  }

  void move(const Eigen::VectorXd& step) {
    for (std::size_t i = 0; i < free_.size(); ++i)
      x_[free_[i]] += step[static_cast<Eigen::Index>(i)];
  }
  const std::vector<double>& x() const { return x_; }

  std::vector<Derivatives> by_recording() const {
    const std::size_t size = free_.size();
    const auto n = static_cast<Eigen::Index>(size);
    std::vector<Derivatives> result(static_cast<std::size_t>(count_),
                                    {Eigen::VectorXd::Zero(n), Eigen::MatrixXd::Zero(n, n)});
    const Eigen::VectorXd centre = values({});
    std::vector<Eigen::VectorXd> up;
    std::vector<Eigen::VectorXd> down;
    for (std::size_t i = 0; i < size; ++i) {
      up.push_back(values({{i, 1.0}}));
      down.push_back(values({{i, -1.0}}));
    }
    constexpr double kH = kDifferenceStep;
    for (std::size_t i = 0; i < size; ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      set(result, [&](Derivatives& d, Eigen::Index r) {
        d.gradient[row] = (up[i][r] - down[i][r]) / (2.0 * kH);
        d.hessian(row, row) = (up[i][r] - 2.0 * centre[r] + down[i][r]) / (kH * kH);
      });
      for (std::size_t j = 0; j < i; ++j) {
        const auto column = static_cast<Eigen::Index>(j);
        const Eigen::VectorXd both = values({{i, 1.0}, {j, 1.0}}) + values({{i, -1.0}, {j, -1.0}}) +
                                     2.0 * centre - up[i] - up[j] - down[i] - down[j];
        set(result, [&](Derivatives& d, Eigen::Index r) {
          d.hessian(row, column) = d.hessian(column, row) = both[r] / (2.0 * kH * kH);
        });
      }
    }
    return result;
  }

 private:
  template <class Function>
  void set(std::vector<Derivatives>& result, const Function& function) const {
    for (Eigen::Index r = 0; r < count_; ++r) function(result[static_cast<std::size_t>(r)], r);
  }

  /// The log-likelihood by recording with some of the free parameters moved.
  Eigen::VectorXd values(const std::vector<std::pair<std::size_t, double>>& moves) const {
    std::vector<double> x = x_;
    for (const auto& [parameter, steps] : moves) x[free_[parameter]] += steps * kDifferenceStep;
    const std::vector<double> by_track = likelihood_(x);
    Eigen::VectorXd sums = Eigen::VectorXd::Zero(count_);
    for (std::size_t i = 0; i < by_track.size(); ++i) sums[rows_[i]] += by_track[i];
    return sums;
  }

  const LikelihoodByTrack& likelihood_;
  std::vector<double> x_;
  std::vector<std::size_t> free_;
  std::vector<Eigen::Index> rows_;  ///< the recording of every track
  Eigen::Index count_ = 0;
};

/// The variances of the maximum when one recording after the other is left out.
Eigen::VectorXd jackknife_variances(const std::vector<Derivatives>& recordings,
                                    const Eigen::MatrixXd& hessian) {
  const auto count = static_cast<Eigen::Index>(recordings.size());
  Eigen::MatrixXd steps(hessian.rows(), count);
  for (Eigen::Index r = 0; r < count; ++r) {
    const Derivatives& left_out = recordings[static_cast<std::size_t>(r)];
    const Eigen::LDLT<Eigen::MatrixXd> rest(left_out.hessian - hessian);
    // Where the others do not determine the parameters, all of them do.
    const Eigen::LDLT<Eigen::MatrixXd> all(-hessian);
    steps.col(r) = (rest.isPositive() ? rest : all).solve(-left_out.gradient);
  }
  const Eigen::MatrixXd about = steps.colwise() - steps.rowwise().mean();
  return about.rowwise().squaredNorm() * (static_cast<double>(count) - 1.0) /
         static_cast<double>(count);
}

}  // namespace

std::vector<double> polished(const LikelihoodByTrack& likelihood, std::vector<double> x,
                             const std::vector<bool>& is_free) {
  constexpr int kMostSteps = 12;
  constexpr double kStill = 1e-9;
  constexpr double kFar = 0.2;
  const std::vector<std::size_t> one_recording(likelihood(x).size(), 0);
  Differences differences(likelihood, one_recording, x, is_free);
  if (differences.free().empty() || one_recording.empty()) return x;
  const Eigen::MatrixXd hessian = differences.by_recording().front().hessian;
  const Eigen::LLT<Eigen::MatrixXd> factor(-hessian);
  if (factor.info() != Eigen::Success) return x;
  double moved = 0.0;
  for (int round = 0; round < kMostSteps; ++round) {
    const Eigen::VectorXd step = factor.solve(differences.gradient());
    const double size = step.cwiseAbs().maxCoeff();
    moved += size;
    if (!(moved < kFar)) return x;
    differences.move(step);
    if (size < kStill) break;
  }
  return differences.x();
}

Eigen::VectorXd log_parameter_errors(const LikelihoodByTrack& likelihood,
                                     std::span<const std::size_t> recordings,
                                     std::span<const double> x, const std::vector<bool>& is_free,
                                     bool is_jackknife) {
  Eigen::VectorXd errors = Eigen::VectorXd::Constant(static_cast<Eigen::Index>(x.size()),
                                                     std::numeric_limits<double>::quiet_NaN());
  const Differences differences(likelihood, recordings, x, is_free);
  if (differences.free().empty()) return errors;
  const std::vector<Derivatives> derivatives = differences.by_recording();
  Eigen::MatrixXd hessian = derivatives.front().hessian;
  for (std::size_t r = 1; r < derivatives.size(); ++r) hessian += derivatives[r].hessian;
  const Eigen::LLT<Eigen::MatrixXd> factor(-hessian);
  if (factor.info() != Eigen::Success) return errors;
  const Eigen::MatrixXd inverse =
      factor.solve(Eigen::MatrixXd::Identity(hessian.rows(), hessian.cols()));
  Eigen::VectorXd variances = inverse.diagonal();
  if (is_jackknife) variances = variances.cwiseMax(jackknife_variances(derivatives, hessian));
  for (std::size_t i = 0; i < differences.free().size(); ++i) {
    errors[static_cast<Eigen::Index>(differences.free()[i])] =
        std::sqrt(variances[static_cast<Eigen::Index>(i)]);
  }
  return errors;
}

}  // namespace posemix::internal
