// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors

/// Learns the noise of a detector from detections with their truth.
///
/// T   true pose of the object in the camera's frame, T_camera_object
/// Y   detected pose, T_camera_object:
///       Y = T Exp(n)        with probability 1 - p - c, the object seen as it is
///       Y = T D Exp(n)      with probability p, the object taken for itself turned by half
///       Y uniform           with probability c, clutter
/// n   error of a detection, n ~ N(0, R): rotation [rad], then translation as a fraction of the
///     range, along the viewing ray (NoiseFrame::ray): z along the ray, x and y across it
/// R   covariance of n, diagonal
/// D   pose of the wrong mode in the object's frame, half a turn about its z axis
///
/// T and Y are known; R, p, c and D are learned. The result is printed as TOML for a sequence file.

#include <array>
#include <cmath>
#include <iostream>
#include <numbers>

#include "posemix/base/random.hpp"
#include "posemix/base/units.hpp"
#include "posemix/config/noise_toml.hpp"
#include "posemix/detector/noise_fit.hpp"

using posemix::Matrix6d;
using posemix::SE3d;
using posemix::SO3d;
using posemix::Vector6d;

namespace {

/// A draw of n with standard deviations sd, carried from the viewing ray at the mode M to the axes
/// of M.
Vector6d draw_error(const Vector6d& sd, const SE3d& M, posemix::RandomStream& random) {
  const auto [ray, range] = posemix::viewing_ray(M);
  Vector6d n;
  for (Eigen::Index i = 0; i < 6; ++i) n[i] = sd[i] * random.normal();
  const SO3d to_mode = M.rotation().inverse() * ray;
  Vector6d along_mode;
  along_mode << to_mode * Eigen::Vector3d(n.head<3>()),
      to_mode * Eigen::Vector3d(range * n.tail<3>());
  return along_mode;
}

SE3d uniform_pose(const SE3d& T, posemix::RandomStream& random) {
  Eigen::Vector4d q;
  for (double& entry : q) entry = random.normal();
  const Eigen::Vector3d shift(random.uniform() - 0.5, random.uniform() - 0.5,
                              random.uniform() - 0.5);
  return SE3d(SO3d::from_quaternion(Eigen::Quaterniond(q[0], q[1], q[2], q[3])),
              T.translation() + shift);
}

}  // namespace

int main() {
  Vector6d sd;  // the square root of the diagonal of R
  sd << posemix::radians(4.0), posemix::radians(4.0), posemix::radians(2.0), 0.008, 0.008, 0.04;
  const Matrix6d R = sd.cwiseAbs2().asDiagonal();
  const SE3d D(SO3d::exp({0.0, 0.0, std::numbers::pi}), Eigen::Vector3d::Zero());
  constexpr double p = 0.15;
  constexpr double c = 0.05;

  // Three recordings of 500 frames with known T and simulated Y.
  posemix::RandomStream random(1);
  std::array<posemix::NoiseTrack, 3> recordings;
  for (std::size_t k = 0; k < recordings.size(); ++k) {
    for (int frame = 0; frame < 500; ++frame) {
      const SE3d T(SO3d::exp({0.01 * frame, 0.5, 0.0}), {0.2, -0.1, 0.5 + 0.002 * frame});
      const double u = random.uniform();
      const SE3d M = u < p ? T * D : T;
      SE3d Y = M * SE3d::exp(draw_error(sd, M, random));
      if (u > 1.0 - c) Y = uniform_pose(T, random);
      recordings[k].push_back(posemix::NoiseObservation{T, Y, k});
    }
  }

  const posemix::NoiseFit fit = posemix::fit_noise(recordings, {.max_components = 1}, random);
  std::cout << posemix::format_noise_toml("my_detector", fit.noise);

  // The simulated noise is found again: frame, R, p, c and D.
  const auto& components = fit.noise.components();
  const Matrix6d& learned = components.front().covariance;
  const bool found =
      fit.frame == posemix::NoiseFrame::ray && components.size() == 2 &&
      (learned.diagonal().array() / R.diagonal().array() - 1.0).abs().maxCoeff() < 0.25 &&
      std::abs(components.back().weight - p) < 0.04 &&
      std::abs(fit.noise.clutter().weight - c) < 0.03 &&
      components.back().offset.is_approx(D, 0.05);
  std::cout << (found ? "good\n" : "not good: the learned noise is not the simulated one\n");
  return found ? 0 : 1;
}
