// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>

/// Means, quantiles and tests for evaluations.
namespace posemix {

/// The mean of some values and its accuracy.
struct MeanWithError {
  double mean;
  double standard_error;  ///< standard error of the mean; NaN for fewer than two values
};

MeanWithError mean_with_error(std::span<const double> values);

/// The arithmetic mean; NaN for no values.
double mean(std::span<const double> values);

/// The median, for an even number of values the mean of the two in the middle; NaN for no values.
double median(std::span<const double> values);

/// The median, for an even number of values the upper of the two in the middle; NaN for no values.
double upper_median(std::vector<double> values);

/// The value of rank floor(p (n - 1)), counted from zero, among n values; NaN without values.
/// @throws InvalidInput when p is not in [0, 1]
double quantile(std::vector<double> values, double p);

/// The quantile of the chi-square distribution with `dof` degrees of freedom: the value that a draw
/// does not exceed with the given probability.
/// @throws InvalidInput when the probability, called `name`, is not in (0, 1) or dof is zero
double chi_square_quantile(double probability, std::size_t dof, const char* name = "probability");

/// The norm that a Gaussian vector with mean zero and this covariance does not exceed with the
/// given probability. Its square is a weighted sum of chi-square variables; it is replaced by one
/// with the same mean, variance and skewness (Liu, Tang and Zhang 2009), which is exact for a
/// sphere and for a line, and within 1 % for three dimensions.
/// @throws InvalidInput when the probability is not in (0, 1), or the covariance is not square or
/// not finite
double gaussian_norm_quantile(const Eigen::MatrixXd& covariance, double probability);

/// The interval in which the ANEES of `count` errors of `dof` degrees of freedom lies with
/// probability 0.95 if the errors are independent and the covariances right: quantiles of the
/// chi-square distribution with count * dof degrees of freedom, divided by count * dof.
std::pair<double, double> chi_square_band(std::size_t count, std::size_t dof);

/// Result of a paired t-test on the differences a_i - b_i.
struct PairedTest {
  double mean_difference;
  double standard_error;  ///< standard error of the mean difference
  double p_value;  ///< two-sided; 1 if all differences are zero; NaN for fewer than two pairs
};

/// Student's t-test of paired values.
/// @throws InvalidInput when the two samples have different sizes
PairedTest paired_test(std::span<const double> a, std::span<const double> b);

}  // namespace posemix
