// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "rotation_ray.hpp"

#include <array>
#include <cmath>

#include <Eigen/Eigenvalues>

namespace posemix::internal {
namespace {

/// A feature is narrow if its standard deviation is below this share of the ray's.
constexpr double kNarrow = 0.5;
/// The distance from a ray in standard deviations beyond which a narrow feature does not matter.
constexpr double kReach = 12.0;
constexpr double kFeatureHalfWidth = 4.0;

}  // namespace

RotationPeak::RotationPeak(const Component<ConcentratedGaussian<SO3d>>& component)
    : weight(std::exp(component.log_weight)), mean(component.density.mean().quaternion()) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(component.density.covariance());
  const Eigen::Vector3d deviations = axes.eigenvalues().cwiseSqrt();
  root = axes.eigenvectors() * deviations.asDiagonal();
  whiten = deviations.cwiseInverse().asDiagonal() * axes.eigenvectors().transpose();
  log_scale = component.log_weight - 1.5 * kLogTwoPi - deviations.array().log().sum();
}

std::vector<RotationPeak> rotation_peaks(const RotationDensity& density) {
  std::vector<RotationPeak> peaks;
  for (const auto& component : density.components()) {
    if (std::isfinite(component.log_weight)) peaks.emplace_back(component);
  }
  return peaks;
}

RotationRay::RotationRay(const RotationPair& pair, const Eigen::Quaterniond& start,
                         const Eigen::Vector3d& direction)
    : of_p_(pair.p.size()) {
  peaks_.reserve(pair.p.size() + pair.q.size());
  const Eigen::Quaterniond turn(0.0, direction.x(), direction.y(), direction.z());
  for (const auto* side : {&pair.p, &pair.q}) {
    for (const RotationPeak& peak : *side) {
      const Eigen::Quaterniond a = start * peak.mean.conjugate();
      const Eigen::Quaterniond b = turn * a;
      peaks_.push_back({a.w(), b.w(), a.vec(), b.vec(), peak.whiten * a.vec(),
                        peak.whiten * b.vec(), peak.log_scale});
    }
  }
}

double RotationRay::log_density(const Peak* first, const Peak* last, double cosine, double sine) {
  // log sum_j k_j^2 exp(e_j), with k^2 = 1 / |det J_l| = (theta / (2 sin(theta/2)))^2.
  double largest = -std::numeric_limits<double>::infinity();
  double sum = 0.0;
  for (const Peak* peak = first; peak != last; ++peak) {
    const double scalar = std::abs(cosine * peak->a_scalar + sine * peak->b_scalar);
    const double squared = (cosine * peak->a + sine * peak->b).squaredNorm();
    const double white = (cosine * peak->white_a + sine * peak->white_b).squaredNorm();
    double stretch = 1.0;
    if (squared > 1e-30) {
      const double length = std::sqrt(squared);
      stretch = std::atan2(length, scalar) / length;
    }
    const double gain = stretch * stretch;
    const double exponent = peak->log_scale - 2.0 * gain * white;
    if (exponent > largest) {
      sum = sum == 0.0 ? gain : sum * std::exp(largest - exponent) + gain;
      largest = exponent;
    } else {
      sum += gain * std::exp(exponent - largest);
    }
  }
  return largest + std::log(sum);
}

RotationRay::LogDensities RotationRay::at(double r) const {
  const double cosine = std::cos(0.5 * r);
  const double sine = std::sin(0.5 * r);
  const Peak* middle = peaks_.data() + of_p_;
  return {log_density(peaks_.data(), middle, cosine, sine),
          log_density(middle, peaks_.data() + peaks_.size(), cosine, sine)};
}

void RotationRay::append_breaks(double end, double scale, std::vector<double>& breaks) const {
  const auto append = [&](double r) {
    if (r > 0.0 && r < end) breaks.push_back(r);
  };
  for (const Peak& peak : peaks_) {
    // The scalar part of the quaternion is a sinusoid in r/2: zero on the cut locus, extreme at the
    // closest approach.
    const double sign = peak.a_scalar < 0.0 ? -1.0 : 1.0;
    append(2.0 * std::atan2(sign * peak.a_scalar, -sign * peak.b_scalar));
    const double closest = 2.0 * std::atan2(sign * peak.b_scalar, sign * peak.a_scalar);
    const double cosine = std::cos(0.5 * closest);
    const double sine = std::sin(0.5 * closest);
    const double along = 1.0 / (cosine * peak.white_b - sine * peak.white_a).norm();
    if (along > kNarrow * scale) continue;
    if (2.0 * (cosine * peak.white_a + sine * peak.white_b).norm() > kReach) continue;
    for (const double offset : {-kFeatureHalfWidth * along, 0.0, kFeatureHalfWidth * along}) {
      append(closest + offset);
    }
  }
}

}  // namespace posemix::internal
