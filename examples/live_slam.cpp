// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
//
// Object SLAM in a robot's loop: one call per frame.
//
//   C    in SE(3), T_world_camera: the camera, C_0 ~ N(C0, P0)
//   X    in SE(3), T_world_mug: the mug, which stands still; never seen before
//   u_k  odometry, T_camera(k-1)_camera(k): C_k = C_(k-1) u_k Exp(w), w ~ N(0, Q) per second
//   z_k  detection, T_camera_mug: z_k = C_k^-1 X Exp(v), v ~ N(0, R), but in a quarter of the
//   frames
//        z_k = C_k^-1 X F Exp(v): the mug looks alike from both sides
//   F    half a turn about the mug's z axis
//
// The filter is given P0, Q, R and that a quarter of the detections are wrong. It estimates C_k and
// X with covariances, the alternatives for X, and the probability that its estimate of X is on the
// right mode.
#include <cstdio>
#include <map>
#include <numbers>
#include <string>

#include <posemix/base/random.hpp>
#include <posemix/base/units.hpp>
#include <posemix/slam/object_slam.hpp>

using namespace posemix;

namespace {

Matrix6d covariance(double rotation_deg, double translation_m) {
  return pose_covariance(Eigen::Vector3d::Constant(radians(rotation_deg)),
                         Eigen::Vector3d::Constant(translation_m));
}

SE3d noise(const Matrix6d& diagonal, RandomStream& random) {
  Vector6d sd = diagonal.diagonal().cwiseSqrt();
  for (double& value : sd) value *= random.normal();
  return SE3d::exp(sd);
}

}  // namespace

int main() {
  const double dt = 0.1;
  const Matrix6d P0 = covariance(0.1, 0.001);
  const Matrix6d Q = covariance(0.2, 0.002);
  const Matrix6d R = covariance(4.0, 0.005);
  const SE3d C0;
  const SE3d X(SO3d::exp({0.0, 0.4, 0.0}), {0.1, 0.0, 0.9});
  const SE3d F(SO3d::exp({0.0, 0.0, std::numbers::pi}), Eigen::Vector3d::Zero());

  ObjectSlamSettings settings;
  settings.motion.noise = {Q, NoisePer::second};
  settings.record_hypotheses = true;
  const ObjectModel mug{
      .id = "mug", .noise = DetectorNoise({{.weight = 0.75, .covariance = R}}, {.weight = 0.25})};
  ObjectSlam slam(PoseDensity(C0, P0), {mug}, settings);

  const auto by_id = [&slam](const std::map<std::string, SE3d>& detections) {
    return detections_by_id(slam.objects(), detections);
  };

  RandomStream random(1);
  SE3d C = C0 * noise(P0, random);
  FrameEstimate estimate =
      slam.step({.detections = by_id({{"mug", C.inverse() * X * noise(R, random)}})});
  for (int k = 1; k < 100; ++k) {
    const SE3d u(SO3d::exp({0.0, 0.005, 0.0}), {-0.005, 0.0, 0.0});
    C = C * u * noise(dt * Q, random);
    const SE3d seen = random.uniform() < 0.25 ? X * F : X;
    const SE3d z = C.inverse() * seen * noise(R, random);
    estimate = slam.step({.dt = dt, .motion = u, .detections = by_id({{"mug", z}})});
  }

  const ObjectEstimate found = estimate.object("mug");
  const Vector6d error = (found.world->mean() * X.inverse()).log();
  const double error_deg = degrees(error.head<3>().norm());
  std::printf("mug: error %.2f deg, on the right mode with probability %.3f\n", error_deg,
              *found.mode_probability);
  for (const ObjectAlternative& other : found.alternatives) {
    const double turned = degrees((other.pose * X.inverse()).log().head<3>().norm());
    std::printf("  alternative at %5.1f deg, probability %.3f\n", turned, other.probability);
  }
  const bool good = error_deg < 3.0 && *found.mode_probability > 0.8;
  std::puts(good ? "good" : "not good: expected less than 3 deg, probability above 0.8");
  return good ? 0 : 1;
}
