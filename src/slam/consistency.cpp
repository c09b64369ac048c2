// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/consistency.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include <fmt/format.h>
#include <Eigen/Eigenvalues>

#include "consistency_findings.hpp"
#include "posemix/base/error.hpp"
#include "posemix/base/statistics.hpp"
#include "series_statistics.hpp"

namespace posemix {
namespace {

using namespace internal;

/// The tail of the intervals by which rotation and position are judged, that of the limits of
/// directions, too.
constexpr double kPartTail = 0.005;

constexpr std::array kAxisNames{"rotation x", "rotation y", "rotation z",
                                "position x", "position y", "position z"};

/// Squared normalised errors of one part of the pose, and the whitened errors, one column a frame.
struct Part {
  Part(std::size_t dimension, std::size_t frames)
      : dof(dimension),
        whitened(static_cast<Eigen::Index>(dimension), static_cast<Eigen::Index>(frames)) {}

  double add(const ObservedPart& part) {
    const auto frame = static_cast<Eigen::Index>(squares.size());
    if (dof > 0) whitened.col(frame) = part.whitened();
    squares.push_back(part.nees());
    return squares.back();
  }

  std::size_t dof;
  std::vector<double> squares;
  Eigen::MatrixXd whitened;
};

/// Degrees of freedom that the NEES of all frames have together: fewer where it scatters more than
/// chi-square does.
double dof_in_all(const Part& part, double anees, double frames) {
  double squares = 0.0;
  const auto dof = static_cast<double>(part.dof);
  for (const double square : part.squares) squares += std::pow(square / dof - anees, 2.0);
  const double variance = squares / static_cast<double>(part.squares.size());
  return frames * dof / std::max(1.0, 0.5 * dof * variance / (anees * anees));
}

ConsistencyVerdict verdict_of(const Interval& interval) {
  if (interval.low > 1.0) return ConsistencyVerdict::overconfident;
  return interval.high < 1.0 ? ConsistencyVerdict::cautious : ConsistencyVerdict::consistent;
}

/// The summary of a part, with the verdict of an interval with `tail` on either side.
NeesSummary summary_of(const Part& part, std::span<const EstimateWithTruth> series, double tail) {
  const auto dof = static_cast<double>(part.dof);
  const auto worst = std::max_element(part.squares.begin(), part.squares.end());
  NeesSummary summary;
  summary.dof = part.dof;
  summary.anees = mean(part.squares) / dof;
  summary.median = median(part.squares) / dof;
  summary.worst = *worst / dof;
  summary.worst_stamp_s = series[static_cast<std::size_t>(worst - part.squares.begin())].stamp_s;
  summary.effective_frames = effective_frames(part.whitened);
  if (summary.anees > 0.0) {
    const double dof_of_mean = dof_in_all(part, summary.anees, summary.effective_frames);
    summary.interval = confidence_interval(summary.anees, dof_of_mean);
    summary.verdict = verdict_of(confidence_interval(summary.anees, dof_of_mean, tail));
  } else {
    summary.verdict = ConsistencyVerdict::cautious;  // there is no error at all
  }
  summary.band = chi_square_interval(1.0, summary.effective_frames * dof);
  summary.independent_band =
      chi_square_interval(1.0, static_cast<double>(part.squares.size()) * dof);
  summary.frame_band = chi_square_interval(1.0, dof);
  const auto within = std::count_if(part.squares.begin(), part.squares.end(), [&](double square) {
    return summary.frame_band.contains(square / dof);
  });
  summary.within_frame_band =
      static_cast<double>(within) / static_cast<double>(part.squares.size());
  summary.coverage = coverage_of(part.squares, part.dof);
  return summary;
}

/// Errors and variances along the six axes over the frames.
class AxisSums {
 public:
  explicit AxisSums(std::size_t frames)
      : errors_(6, static_cast<Eigen::Index>(frames)), variances_(errors_) {
    covariances_.reserve(frames);
  }

  void add(const Vector6d& error, const Matrix6d& covariance) {
    errors_.col(frame_) = error;
    variances_.col(frame_++) = covariance.diagonal();
    squared_ += error * error.transpose();
    covariance_ += covariance;
    covariances_.push_back(covariance);
  }

  /// Axes of which some can be observed.
  std::vector<AxisConsistency> axes() const {
    std::vector<AxisConsistency> axes;
    for (Eigen::Index i = 0; i < 6; ++i) {
      if (is_seen(i)) axes.push_back(axis(i));
    }
    return axes;
  }

  /// The directions of the extreme ratios, least first.
  std::pair<ErrorDirection, ErrorDirection> directions(std::size_t dof, double frames) const;

 private:
  /// Of how many frames with one covariance the sums over these would scatter as much and be as
  /// skewed: in sums the frames that are least certain have most of the weight.
  struct EqualFrames {
    double by_scatter;
    double by_skewness;
  };
  EqualFrames equal_frames(const Matrix6d& inverse, double dof) const;
  Interval direction_limits(const Matrix6d& inverse, std::size_t dof, double frames) const;

  bool is_seen(Eigen::Index axis) const {
    constexpr double kLeast = 1e-9;  // of the variance of the other axes of the kind
    const Eigen::Index half = axis < 3 ? 0 : 3;
    return covariance_(axis, axis) > kLeast * covariance_.diagonal().segment<3>(half).maxCoeff();
  }

  AxisConsistency axis(Eigen::Index i) const {
    const Eigen::VectorXd errors = errors_.row(i);
    const Eigen::VectorXd normalized =
        errors.cwiseQuotient(Eigen::VectorXd(variances_.row(i)).cwiseSqrt());
    const std::vector<double> squares = [&] {
      const Eigen::VectorXd values = normalized.cwiseAbs2();
      return std::vector<double>(values.begin(), values.end());
    }();
    const double spread = standard_error_of_mean(normalized);
    AxisConsistency axis;
    axis.axis = kAxisNames[static_cast<std::size_t>(i)];
    axis.mean_error = errors.mean();
    axis.rms_error = std::sqrt(errors.cwiseAbs2().mean());
    axis.rms_sd = std::sqrt(variances_.row(i).mean());
    axis.normalized_mean = normalized.mean();
    axis.normalized_rms = std::sqrt(mean(squares));
    axis.bias_significance = spread > 0.0 ? std::abs(axis.normalized_mean) / spread : 0.0;
    axis.coverage = coverage_of(squares, 1);
    return axis;
  }

  Eigen::MatrixXd errors_;
  Eigen::MatrixXd variances_;
  Eigen::Index frame_ = 0;
  Matrix6d squared_ = Matrix6d::Zero();
  Matrix6d covariance_ = Matrix6d::Zero();
  std::vector<Matrix6d> covariances_;
};

/// With `inverse` A = (sum_k P_k)^-1 in d dimensions and t_m = sum_k tr (P_k A)^m: d / t_2, and
/// t_2^3 / (d t_3^2), which are all frames where their covariances are equal.
AxisSums::EqualFrames AxisSums::equal_frames(const Matrix6d& inverse, double dof) const {
  double second = 0.0;
  double third = 0.0;
  for (const Matrix6d& covariance : covariances_) {
    const Matrix6d once = covariance * inverse;
    const Matrix6d twice = once * once;
    second += twice.trace();
    third += (twice * once).trace();
  }
  return {dof / second, second * second * second / (dof * third * third)};
}

/// Limits of the extreme eigenvalues of a sum over frames that are worth `frames` independent ones.
/// The law for equal covariances, with the skewness of the sum, is stretched to its scatter, as
/// Pearson (1959) does with weighted sums of chi-squares. The lower tail is shorter than that; it
/// has the limit by the scatter, which is wider.
Interval AxisSums::direction_limits(const Matrix6d& inverse, std::size_t dof, double frames) const {
  const EqualFrames equal = equal_frames(inverse, static_cast<double>(dof));
  const double part = frames / static_cast<double>(frame_);
  const double scatter = std::max(part * equal.by_scatter, 1.0);
  const double skewness = std::max(part * equal.by_skewness, 1.0);
  const double high = eigenvalue_limits(skewness, dof).high;
  return {eigenvalue_limits(scatter, dof).low, 1.0 + std::sqrt(skewness / scatter) * (high - 1.0)};
}

/// E[e e^T] u = ratio E[P] u in coordinates in which E[P] is the identity, on its range.
std::pair<ErrorDirection, ErrorDirection> AxisSums::directions(std::size_t dof,
                                                               double frames) const {
  Vector6d inverse_sd = Vector6d::Zero();
  for (Eigen::Index i = 0; i < 6; ++i) {
    if (is_seen(i)) inverse_sd[i] = 1.0 / std::sqrt(covariance_(i, i));
  }
  const Matrix6d correlation = inverse_sd.asDiagonal() * covariance_ * inverse_sd.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Matrix6d> range(correlation);
  const auto size = static_cast<Eigen::Index>(dof);
  const Eigen::MatrixXd root = range.eigenvectors().rightCols(size) *
                               range.eigenvalues().tail(size).cwiseSqrt().asDiagonal();
  const Eigen::MatrixXd whitening =
      range.eigenvectors().rightCols(size) *
      range.eigenvalues().tail(size).cwiseSqrt().cwiseInverse().asDiagonal();
  const Matrix6d scaled = inverse_sd.asDiagonal() * squared_ * inverse_sd.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> ratios(whitening.transpose() * scaled *
                                                              whitening);
  const Matrix6d inverse = inverse_sd.asDiagonal() * Matrix6d(whitening * whitening.transpose()) *
                           inverse_sd.asDiagonal();
  const Interval limits = direction_limits(inverse, dof, frames);
  const auto direction = [&](Eigen::Index i, double limit) {
    ErrorDirection found;
    found.ratio = std::max(0.0, ratios.eigenvalues()[i]);
    found.limit = limit;
    found.correlation = root * ratios.eigenvectors().col(i);
    found.name = direction_name(found.correlation);
    return found;
  };
  return {direction(0, limits.low), direction(size - 1, limits.high)};
}

void check(std::span<const EstimateWithTruth> series) {
  if (series.size() < 2) {
    throw InvalidInput(fmt::format("consistency: got {} estimates with truth, expected at least 2",
                                   series.size()));
  }
  for (std::size_t k = 0; k < series.size(); ++k) {
    if (k > 0 && !(series[k].stamp_s > series[k - 1].stamp_s)) {
      throw InvalidInput(
          fmt::format("consistency: stamp {} after stamp {}, expected stamps that "
                      "increase strictly",
                      series[k].stamp_s, series[k - 1].stamp_s));
    }
    checked_covariance(series[k].estimate.covariance(), 6,
                       fmt::format("consistency: the covariance at stamp {}", series[k].stamp_s));
  }
}

double constant_share(const Eigen::MatrixXd& whitened) {
  const double squares = whitened.colwise().squaredNorm().mean();
  return squares > 0.0 ? whitened.rowwise().mean().squaredNorm() / squares : 0.0;
}

/// By the limits of the extreme directions.
ConsistencyVerdict verdict_of(const ErrorDirection& most, const ErrorDirection& least) {
  if (most.ratio > most.limit) return ConsistencyVerdict::overconfident;
  return least.ratio < least.limit ? ConsistencyVerdict::cautious : ConsistencyVerdict::consistent;
}

ConsistencyVerdict worst_verdict(const ConsistencyReport& report) {
  std::vector<ConsistencyVerdict> verdicts{
      report.pose.verdict, report.position.verdict,
      verdict_of(report.most_overconfident, report.most_cautious)};
  if (report.rotation) verdicts.push_back(report.rotation->verdict);
  for (const auto worst : {ConsistencyVerdict::overconfident, ConsistencyVerdict::cautious}) {
    if (std::ranges::find(verdicts, worst) != verdicts.end()) return worst;
  }
  return ConsistencyVerdict::consistent;
}

}  // namespace

ConsistencyReport consistency_of(std::span<const EstimateWithTruth> series,
                                 const ConsistencySettings& settings) {
  check(series);
  const ErrorReduction reduction(settings.symmetries);
  Part pose(reduction.dof(), series.size());
  Part rotation(reduction.rotation_dof(), series.size());
  Part position(3, series.size());
  AxisSums axes(series.size());
  ConsistencyReport report;
  for (const auto& [stamp, estimate, truth] : series) {
    const ObservedError error = reduction(estimate, truth);
    report.frames.push_back(
        {stamp, pose.add(error.pose), rotation.add(error.rotation), position.add(error.position)});
    Matrix6d to_axes = Matrix6d::Identity();
    if (settings.axes == ErrorAxes::reference) {
      to_axes.topLeftCorner<3, 3>() = estimate.mean().rotation().matrix();
      to_axes.bottomRightCorner<3, 3>() = to_axes.topLeftCorner<3, 3>();
    }
    axes.add(to_axes * error.error, to_axes * error.covariance * to_axes.transpose());
  }
  report.pose = summary_of(pose, series, kBandTail);
  if (rotation.dof > 0) report.rotation = summary_of(rotation, series, kPartTail);
  report.position = summary_of(position, series, kPartTail);
  report.axes = axes.axes();
  // Turned to the reference, what cannot be observed is another direction in every frame.
  const bool turns = settings.axes == ErrorAxes::reference && rotation.dof == 2;
  std::tie(report.most_cautious, report.most_overconfident) =
      axes.directions(turns ? 6 : reduction.dof(), report.pose.effective_frames);
  report.constant_share = constant_share(pose.whitened);
  report.verdict = worst_verdict(report);
  report.findings = findings_of(report);
  return report;
}

}  // namespace posemix
