// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Core>
#include <boost/math/distributions/chi_squared.hpp>

/// Sample statistics with their standard errors, for tests.
namespace posemix::testing {

/// First and second moments of a random vector from samples, each with its standard error.
class SampleMoments {
 public:
  explicit SampleMoments(Eigen::Index n) : sums_(n + n * n), squares_(n + n * n), size_(n) {
    sums_.setZero();
    squares_.setZero();
  }

  void add(const Eigen::VectorXd& value) {
    Eigen::VectorXd terms(sums_.size());
    terms.head(size_) = value;
    terms.tail(size_ * size_) = (value * value.transpose()).reshaped();
    sums_ += terms;
    squares_ += terms.cwiseAbs2();
    ++count_;
  }

  Eigen::VectorXd mean() const { return averages().head(size_); }
  /// E[x x^T].
  Eigen::MatrixXd second_moment() const {
    return averages().tail(size_ * size_).reshaped(size_, size_);
  }
  Eigen::MatrixXd covariance() const { return second_moment() - mean() * mean().transpose(); }

  /// Largest difference from the expected mean and covariance, in standard errors, after
  /// subtracting `allowance` times the size of the quantity (sqrt of a variance, product of two for
  /// the second moments).
  double worst_score(const Eigen::VectorXd& expected_mean,
                     const Eigen::MatrixXd& expected_covariance, double allowance = 0.0) const {
    const Eigen::VectorXd deviation = expected_covariance.diagonal().cwiseSqrt();
    Eigen::VectorXd expected(sums_.size());
    Eigen::VectorXd size(sums_.size());
    expected.head(size_) = expected_mean;
    size.head(size_) = deviation;
    expected.tail(size_ * size_) =
        (expected_covariance + expected_mean * expected_mean.transpose()).reshaped();
    size.tail(size_ * size_) = (deviation * deviation.transpose()).reshaped();
    const Eigen::ArrayXd average = averages();
    const Eigen::ArrayXd variance =
        squares_.array() / static_cast<double>(count_) - average.square();
    const Eigen::ArrayXd error = (variance / static_cast<double>(count_)).max(1e-300).sqrt();
    const Eigen::ArrayXd difference = (average - expected.array()).abs() - allowance * size.array();
    return (difference / error).maxCoeff();
  }

 private:
  Eigen::VectorXd averages() const { return sums_ / static_cast<double>(count_); }

  Eigen::VectorXd sums_;
  Eigen::VectorXd squares_;
  Eigen::Index size_;
  long count_ = 0;
};

/// The interval that a chi-square variable leaves with probability `outside`.
inline std::pair<double, double> chi_square_band(double degrees, double outside = 1e-6) {
  const boost::math::chi_squared law(degrees);
  return {boost::math::quantile(law, 0.5 * outside),
          boost::math::quantile(boost::math::complement(law, 0.5 * outside))};
}

}  // namespace posemix::testing
