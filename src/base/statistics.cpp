// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/base/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/students_t.hpp>

#include "base/in_double.hpp"
#include "posemix/base/error.hpp"
#include "posemix/base/range.hpp"

namespace posemix {
namespace {

using ChiSquared = boost::math::chi_squared_distribution<double, internal::InDouble>;
using StudentsT = boost::math::students_t_distribution<double, internal::InDouble>;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

double value_of_rank(std::vector<double>& values, std::size_t rank) {
  if (values.empty()) return kNaN;
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(rank);
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

}  // namespace

double mean(std::span<const double> values) {
  if (values.empty()) return kNaN;
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

MeanWithError mean_with_error(std::span<const double> values) {
  const double centre = mean(values);
  if (values.size() < 2) return {centre, kNaN};
  const auto n = static_cast<double>(values.size());
  double squares = 0.0;
  for (const double value : values) squares += (value - centre) * (value - centre);
  return {centre, std::sqrt(squares / (n - 1.0) / n)};
}

double median(std::span<const double> values) {
  if (values.empty()) return kNaN;
  std::vector<double> sorted(values.begin(), values.end());
  std::sort(sorted.begin(), sorted.end());
  const std::size_t half = sorted.size() / 2;
  return sorted.size() % 2 == 1 ? sorted[half] : 0.5 * (sorted[half - 1] + sorted[half]);
}

double upper_median(std::vector<double> values) { return value_of_rank(values, values.size() / 2); }

double quantile(std::vector<double> values, double p) {
  kUnitInterval.check(p, "p");
  const double last = static_cast<double>(values.size()) - 1.0;
  return value_of_rank(values, static_cast<std::size_t>(p * std::max(last, 0.0)));
}

double chi_square_quantile(double probability, std::size_t dof, const char* name) {
  kOpenUnitInterval.check(probability, name);
  require(dof > 0, "chi_square_quantile: dof is 0, expected at least 1");
  return boost::math::quantile(ChiSquared(static_cast<double>(dof)), probability);
}

double gaussian_norm_quantile(const Eigen::MatrixXd& covariance, double probability) {
  kOpenUnitInterval.check(probability, "probability");
  require(covariance.rows() == covariance.cols() && covariance.allFinite(),
          "gaussian_norm_quantile: covariance is not square or not finite");
  const double largest = covariance.size() == 0 ? 0.0 : covariance.cwiseAbs().maxCoeff();
  if (!(largest > 0.0)) return 0.0;
  // In a unit of its own, a power of two, so that the sixth power of no covariance overflows.
  const int unit = std::ilogb(largest);
  const Eigen::MatrixXd scaled = covariance * std::ldexp(1.0, -unit);
  const Eigen::MatrixXd squared = scaled * scaled;
  const double first = scaled.trace();
  const double second = squared.trace();
  const double third = (squared * scaled).trace();
  if (!(second > 0.0 && third > 0.0)) return 0.0;
  const double dof = second * second * second / (third * third);
  const double quantile = boost::math::quantile(ChiSquared(dof), probability);
  const double standard = (quantile - dof) / std::sqrt(2.0 * dof);
  const double square = std::max(0.0, first + std::sqrt(2.0 * second) * standard);
  return std::sqrt(std::ldexp(square, unit));
}

std::pair<double, double> chi_square_band(std::size_t count, std::size_t dof) {
  require(count > 0 && dof > 0, "chi_square_band: count or dof is 0, expected at least 1");
  internal::check_count(count, "chi_square_band: count");
  internal::check_count(dof, "chi_square_band: dof");
  const double n = static_cast<double>(count) * static_cast<double>(dof);
  const ChiSquared distribution(n);
  return {boost::math::quantile(distribution, 0.025) / n,
          boost::math::quantile(distribution, 0.975) / n};
}

PairedTest paired_test(std::span<const double> a, std::span<const double> b) {
  require(a.size() == b.size(), "paired_test: two samples of different sizes");
  std::vector<double> differences(a.size());
  std::transform(a.begin(), a.end(), b.begin(), differences.begin(), std::minus<>());
  const MeanWithError difference = mean_with_error(differences);
  if (differences.size() < 2) return {difference.mean, kNaN, kNaN};
  if (difference.standard_error == 0.0) {
    return {difference.mean, 0.0, difference.mean == 0.0 ? 1.0 : 0.0};
  }
  const StudentsT distribution(static_cast<double>(differences.size()) - 1.0);
  const double t = std::abs(difference.mean) / difference.standard_error;
  if (!std::isfinite(t)) return {difference.mean, difference.standard_error, kNaN};
  return {difference.mean, difference.standard_error,
          2.0 * boost::math::cdf(boost::math::complement(distribution, t))};
}

}  // namespace posemix
