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
constexpr double kRayReach = 12.0;
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

RotationRay::RotationRay(const RotationPair& pair)
    : pair_(&pair),
      of_p_(pair.p.size()),
      peaks_(pair.p.size() + pair.q.size()),
      vectors_(peaks_.size()),
      scratch_(2 * kRayPoints * peaks_.size()) {}

void RotationRay::begin(const Eigen::Quaterniond& start, const Eigen::Vector3d& direction) {
  const Eigen::Quaterniond turn(0.0, direction.x(), direction.y(), direction.z());
  std::size_t i = 0;
  for (const auto* side : {&pair_->p, &pair_->q}) {
    for (const RotationPeak& peak : *side) {
      const Eigen::Quaterniond a = start * peak.mean.conjugate();
      const Eigen::Quaterniond b = turn * a;
      RayPeak& seen = peaks_[i];
      seen.a_scalar = a.w();
      seen.b_scalar = b.w();
      Eigen::Map<Eigen::Vector3d>(seen.white_a) = peak.whiten * a.vec();
      Eigen::Map<Eigen::Vector3d>(seen.white_b) = peak.whiten * b.vec();
      seen.log_scale = peak.log_scale;
      vectors_[i++] = {a.vec(), b.vec()};
    }
  }
}

namespace {

Eigen::Map<const Eigen::Vector3d> vector_of(const double (&values)[3]) {
  return Eigen::Map<const Eigen::Vector3d>(values);
}

}  // namespace

double RotationRay::log_density(std::size_t first, std::size_t last, double cosine,
                                double sine) const {
  // log sum_j k_j^2 exp(e_j), with k^2 = 1 / |det J_l| = (theta / (2 sin(theta/2)))^2.
  double largest = -std::numeric_limits<double>::infinity();
  double sum = 0.0;
  for (std::size_t i = first; i < last; ++i) {
    const RayPeak& peak = peaks_[i];
    const double scalar = std::abs(cosine * peak.a_scalar + sine * peak.b_scalar);
    const double squared = (cosine * vectors_[i].a + sine * vectors_[i].b).squaredNorm();
    const double white =
        (cosine * vector_of(peak.white_a) + sine * vector_of(peak.white_b)).squaredNorm();
    double stretch = 1.0;
    if (squared > 1e-30) {
      const double length = std::sqrt(squared);
      stretch = std::atan2(length, scalar) / length;
    }
    const double gain = stretch * stretch;
    const double exponent = peak.log_scale - 2.0 * gain * white;
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
  return {log_density(0, of_p_, cosine, sine), log_density(of_p_, peaks_.size(), cosine, sine)};
}

void RotationRay::append_breaks(double end, double scale, std::vector<double>& breaks) const {
  const auto append = [&](double r) {
    if (r > 0.0 && r < end) breaks.push_back(r);
  };
  for (const RayPeak& peak : peaks_) {
    const auto white_a = vector_of(peak.white_a);
    const auto white_b = vector_of(peak.white_b);
    // The scalar part of the quaternion is a sinusoid in r/2: zero on the cut locus, extreme at the
    // closest approach.
    const double sign = peak.a_scalar < 0.0 ? -1.0 : 1.0;
    append(2.0 * std::atan2(sign * peak.a_scalar, -sign * peak.b_scalar));
    const double closest = 2.0 * std::atan2(sign * peak.b_scalar, sign * peak.a_scalar);
    const double cosine = std::cos(0.5 * closest);
    const double sine = std::sin(0.5 * closest);
    const double along = 1.0 / (cosine * white_b - sine * white_a).norm();
    if (along > kNarrow * scale) continue;
    if (2.0 * (cosine * white_a + sine * white_b).norm() > kRayReach) continue;
    for (const double offset : {-kFeatureHalfWidth * along, 0.0, kFeatureHalfWidth * along}) {
      append(closest + offset);
    }
  }
}

}  // namespace posemix::internal
