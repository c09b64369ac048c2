// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cmath>
#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

#include "posemix/base/random.hpp"
#include "posemix/lie/se3.hpp"

/// Random processes of the simulation. Every process draws the same count of numbers per frame.
namespace posemix::internal::simulation {

using Real = long double;
using Pose = SE3<Real>;
using Vector3 = Eigen::Matrix<Real, 3, 1>;
using Vector6 = Eigen::Matrix<Real, 6, 1>;

/// The stream with a name (its FNV-1a hash is the stream index): what is drawn for one purpose does
/// not change when others come or go.
inline RandomStream named_stream(std::uint64_t seed, std::string_view name) {
  std::uint64_t hash = 0xcbf29ce484222325U;
  for (const char c : name) {
    hash ^= static_cast<unsigned char>(c);
    hash *= 0x100000001b3U;
  }
  return RandomStream(seed, hash);
}

inline Vector6 draw_normal(RandomStream& random) {
  Vector6 values;
  for (Real& value : values) value = random.normal();
  return values;
}

/// A rotation that is uniform over SO(3): the direction of a normal vector in four-space.
inline SO3<Real> draw_rotation(RandomStream& random) {
  Eigen::Quaternion<Real> q;
  for (Real& value : q.coeffs()) value = random.normal();
  return SO3<Real>::from_quaternion(q);
}

/// A Markov chain that keeps its state with the given probability and otherwise draws a state by
/// the weights. Stationary from the start: the states have the frequencies of the weights.
class StickyChain {
 public:
  StickyChain(std::vector<double> weights, Real keep, RandomStream random)
      : weights_(std::move(weights)), keep_(keep), random_(random) {
    for (const double weight : weights_) total_ += weight;
  }

  std::size_t next() {
    const bool kept = random_.uniform() < keep_;
    const std::size_t drawn = draw();
    if (!started_ || !kept) state_ = drawn;
    started_ = true;
    return state_;
  }

 private:
  std::size_t draw() {
    const Real target = random_.uniform() * total_;
    Real sum = 0;
    std::size_t last = 0;
    for (std::size_t i = 0; i < weights_.size(); ++i) {
      if (!(weights_[i] > 0.0)) continue;
      sum += weights_[i];
      last = i;
      if (target < sum) break;
    }
    return last;
  }

  std::vector<double> weights_;
  Real total_ = 0;
  Real keep_;
  RandomStream random_;
  std::size_t state_ = 0;
  bool started_ = false;
};

/// z_k = r z_(k-1) + sqrt(1 - r^2) w_k: standard normal at every step, from the start.
class CorrelatedNormal {
 public:
  CorrelatedNormal(Real correlation, RandomStream random)
      : correlation_(correlation), random_(random) {}

  const Vector6& next() {
    const Vector6 white = draw_normal(random_);
    if (started_) {
      state_ = correlation_ * state_ + std::sqrt(1 - correlation_ * correlation_) * white;
    } else {
      state_ = white;
    }
    started_ = true;
    return state_;
  }

 private:
  Real correlation_;
  RandomStream random_;
  Vector6 state_ = Vector6::Zero();
  bool started_ = false;
};

}  // namespace posemix::internal::simulation
