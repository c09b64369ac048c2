// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <span>

#include <Eigen/Core>

#include "posemix/slam/consistency.hpp"

/// Statistics of correlated time series of normalised errors.
namespace posemix::internal {

/// The probability below and above an interval of 95 %.
inline constexpr double kBandTail = 0.025;

/// Effective number of frames for the mean of |z_k|^2, z one column per frame with unit variance
/// when consistent: n / (1 + 2 sum r_k), r_k the squared autocorrelations of the components about
/// zero, weighted by their squared variances. From 1 to n, and 1 for two frames, which say nothing
/// of their correlation.
double effective_frames(const Eigen::MatrixXd& whitened);

/// The standard error of the mean of a series, from its autocorrelation about the mean.
double standard_error_of_mean(const Eigen::VectorXd& values);

/// The interval of `value` * chi-square(dof) / dof with probability 0.95.
Interval chi_square_interval(double value, double dof);

/// The confidence interval of the mean of chi-square variables over their degrees of freedom, given
/// the mean and the degrees of freedom in all, outside which the mean is with probability `tail` on
/// either side.
Interval confidence_interval(double mean, double dof, double tail = kBandTail);

/// The values below which the smallest and above which the largest eigenvalue of the sample
/// covariance of `count` standard normal vectors are with probability 0.005 each. The smallest is 0
/// where there are too few.
Interval eigenvalue_limits(double count, std::size_t dimension);

/// Shares within 1, 2 and 3 of sqrt(squares), whose expectations are those of chi-square.
Coverage coverage_of(std::span<const double> squares, std::size_t dof);

}  // namespace posemix::internal
