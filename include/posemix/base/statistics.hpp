// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

/// Statistics of studies.
namespace posemix {

struct MeanWithError {
  double mean;
  double standard_error;  ///< of the mean; NaN for fewer than two values
};

MeanWithError mean_with_error(std::span<const double> values);

double mean(std::span<const double> values);

/// For an even number of values the mean of the two in the middle; NaN without values.
double median(std::span<const double> values);

/// For an even number of values the upper of the two in the middle; NaN without values.
double upper_median(std::vector<double> values);

/// The value of rank floor(p (n - 1)), counted from zero, among n values; NaN without values.
double quantile(std::vector<double> values, double p);

/// The value below which a chi-square distributed number of `dof` degrees of freedom lies with the
/// probability.
/// @throws InvalidInput when the probability, called `name`, is not in (0, 1) or dof is zero
double chi_square_quantile(double probability, std::size_t dof, const char* name = "probability");

/// The interval in which the mean of `count` normalised squared errors of `dof` degrees of freedom
/// lies with probability 0.95 when the errors are independent and the covariances right: quantiles
/// of the chi-square distribution over count dof.
std::pair<double, double> chi_square_band(std::size_t count, std::size_t dof);

/// A comparison of paired values a_i - b_i.
struct PairedTest {
  double mean_difference;
  double standard_error;
  double p_value;  ///< two-sided, Student's t; 1 where all differences are zero; NaN below two
};

/// @throws InvalidInput when the two have different sizes
PairedTest paired_test(std::span<const double> a, std::span<const double> b);

}  // namespace posemix
