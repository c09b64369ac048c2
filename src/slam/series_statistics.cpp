// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "series_statistics.hpp"

#include <algorithm>
#include <cmath>

#include <boost/math/distributions/chi_squared.hpp>

#include "base/in_double.hpp"

namespace posemix::internal {
namespace {

using ChiSquared = boost::math::chi_squared_distribution<double, InDouble>;

/// Lags grow by this part, so that a long series costs n log n; between them r_k is linear.
constexpr Eigen::Index kLagsPerOctave = 16;
/// A squared correlation below this is taken for noise.
constexpr double kLeastSquared = 0.02;

Eigen::Index next_lag(Eigen::Index lag) {
  return lag + std::max<Eigen::Index>(1, lag / kLagsPerOctave);
}

/// 2 sum of the correlations over all lags until they are not above `least`.
template <class CorrelationAt>
double twice_sum(Eigen::Index frames, double least, const CorrelationAt& correlation_at) {
  double sum = 0.0;
  double before = 0.0;
  Eigen::Index last = 0;
  for (Eigen::Index lag = 1; lag < frames; lag = next_lag(lag)) {
    const double here = correlation_at(lag);
    if (!(here > least)) break;
    const auto steps = static_cast<double>(lag - last);
    sum += last == 0 ? here : 0.5 * (steps * (before + here) + here - before);
    before = here;
    last = lag;
  }
  return 2.0 * sum;
}

}  // namespace

double effective_frames(const Eigen::MatrixXd& whitened) {
  const Eigen::Index frames = whitened.cols();
  const auto n = static_cast<double>(frames);
  const Eigen::ArrayXd power = whitened.rowwise().squaredNorm();
  const double all = power.square().sum();
  // Two frames say nothing of how alike they are.
  if (frames <= 2 || !(all > 0.0)) return 1.0;
  // The variance of a mean over n frames weighs the correlation at a lag by (n - lag) / n. White
  // errors have a mean squared correlation of 1 / (n - lag): what lies between that and one counts,
  // so that an error that never changes has a correlation of one in a short series, too.
  const auto correlation_at = [&](Eigen::Index lag) {
    const Eigen::Index rest = frames - lag;
    if (rest < 2) return 0.0;
    const auto m = static_cast<double>(rest);
    const Eigen::ArrayXd products =
        whitened.leftCols(rest).cwiseProduct(whitened.rightCols(rest)).rowwise().sum();
    const double squared = products.square().sum() / all * std::pow(n / m, 2);
    return m / n * (m * squared - 1.0) / (m - 1.0);
  };
  return std::clamp(n / (1.0 + twice_sum(frames, kLeastSquared, correlation_at)), 1.0, n);
}

double standard_error_of_mean(const Eigen::VectorXd& values) {
  const Eigen::Index frames = values.size();
  const auto n = static_cast<double>(frames);
  const Eigen::VectorXd rest = values.array() - values.mean();
  const double power = rest.squaredNorm();
  if (!(power > 0.0)) return 0.0;
  const auto correlation_at = [&](Eigen::Index lag) {
    return rest.head(frames - lag).dot(rest.tail(frames - lag)) / power;
  };
  const double variance = power / (n - 1.0);
  return std::sqrt(variance * (1.0 + twice_sum(frames, 0.0, correlation_at)) / n);
}

Interval chi_square_interval(double value, double dof) {
  const ChiSquared distribution(dof);
  return {value * boost::math::quantile(distribution, kBandTail) / dof,
          value * boost::math::quantile(boost::math::complement(distribution, kBandTail)) / dof};
}

Interval confidence_interval(double mean, double dof, double tail) {
  const ChiSquared distribution(dof);
  return {mean * dof / boost::math::quantile(boost::math::complement(distribution, tail)),
          mean * dof / boost::math::quantile(distribution, tail)};
}

Interval eigenvalue_limits(double count, std::size_t dimension) {
  constexpr double kTracyWidom = 2.4224;  // the 0.995 quantile of the law for real matrices
  const auto d = static_cast<double>(dimension);
  // Johnstone 2001, Theorem 1.1, in the form centred for small matrices.
  const double n_root = std::sqrt(std::max(count - 0.5, 0.5));
  const double d_root = std::sqrt(d - 0.5);
  const double high_centre = (n_root + d_root) * (n_root + d_root);
  const double high_scale = (n_root + d_root) * std::cbrt(1.0 / n_root + 1.0 / d_root);
  Interval limits{0.0, (high_centre + kTracyWidom * high_scale) / count};
  if (n_root <= d_root + 1e-6) return limits;
  // Ma 2012, Theorem 2: the logarithm of the smallest eigenvalue.
  const double low_centre = (n_root - d_root) * (n_root - d_root);
  const double low_scale = (n_root - d_root) * std::cbrt(1.0 / d_root - 1.0 / n_root);
  const double tau = low_scale / low_centre;
  limits.low = std::exp(std::log(low_centre) + tau * tau / 8.0 - kTracyWidom * tau) / count;
  return limits;
}

Coverage coverage_of(std::span<const double> squares, std::size_t dof) {
  const ChiSquared distribution(static_cast<double>(dof));
  Coverage coverage{};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto sigma = static_cast<double>(i + 1);
    const auto within = std::count_if(squares.begin(), squares.end(),
                                      [&](double square) { return square <= sigma * sigma; });
    coverage.shares[i] = static_cast<double>(within) / static_cast<double>(squares.size());
    coverage.nominal[i] = boost::math::cdf(distribution, sigma * sigma);
  }
  return coverage;
}

}  // namespace posemix::internal
