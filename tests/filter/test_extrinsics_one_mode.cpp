// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Cameras of a rig whose poses on the body are a part of the state, against an extended Kalman
// filter that is written out.
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "filter/multi_object/significant_motion.hpp"
#include "multi_object_scene.hpp"
#include "posemix/filter/multi_object_filter.hpp"

namespace posemix {
namespace {

using testing::isotropic;
using testing::plain_settings;
using testing::pose;

const SE3d kOneModeCamera = pose(0.1, 0.5, -0.2, 0.2, -0.1, 0.05);

/// An extended Kalman filter over the body, two extrinsics and objects, as in a textbook; but the
/// cameras are linearised at a pose of the body of its own, eq. (38).
struct PlainFilter {
  std::vector<SE3d> poses;
  Eigen::MatrixXd p;
  std::optional<SE3d> linearised_at = {};

  Matrix6d map() const { return linearised_at.value_or(poses[0]).adjoint(); }
  Eigen::MatrixXd seeing(std::optional<std::size_t> camera) const {
    Eigen::MatrixXd m = Eigen::MatrixXd::Zero(6, p.cols());
    m.leftCols<6>().setIdentity();
    if (camera) m.middleCols<6>(6 + 6 * static_cast<Eigen::Index>(*camera)) = map();
    return m;
  }
  SE3d camera(std::optional<std::size_t> camera) const {
    return camera ? poses[0] * poses[1 + *camera] : poses[0];
  }
  /// With the part of the motion that is `significant`.
  void predict(const SE3d& motion, const Matrix6d& q, const SE3d& significant) {
    const SE3d before = poses[0];
    poses[0] = before * motion;
    p.topLeftCorner<6, 6>() += poses[0].adjoint_congruence(q);
    if (!linearised_at) return;
    const SE3d to = *linearised_at * significant;
    const Matrix6d rest = to.adjoint() - map() - (poses[0].adjoint() - before.adjoint());
    linearised_at = to;
    for (Eigen::Index at : {6, 12})
      p.topLeftCorner<6, 6>() += rest * p.block<6, 6>(at, at) * rest.transpose();
  }
  void begin(std::optional<std::size_t> from, const SE3d& seen, const Matrix6d& r) {
    const Eigen::MatrixXd m = seeing(from);
    const Eigen::Index n = p.rows();
    poses.push_back(camera(from) * seen);
    if (from && !linearised_at) linearised_at = poses[0];
    if (!from) is_seen_exactly = true;
    Eigen::MatrixXd next(n + 6, n + 6);
    next << p, p * m.transpose(), m * p, m * p * m.transpose() + poses.back().adjoint_congruence(r);
    p = next;
  }
  void update(std::size_t object, std::optional<std::size_t> from, const SE3d& seen,
              const Matrix6d& r) {
    Eigen::MatrixXd h = -seeing(from);
    h.middleCols<6>(6 * static_cast<Eigen::Index>(object)) = Matrix6d::Identity();
    const SE3d& at = poses[object];
    const Vector6d z = (camera(from) * seen * at.inverse()).log();
    const Matrix6d noise = at.adjoint_congruence(r);
    const Matrix6d s = h * p * h.transpose() + noise;
    const Eigen::MatrixXd k = p * h.transpose() * s.inverse();
    const Eigen::VectorXd moved = k * z;
    const std::vector<SE3d> before = poses;
    for (std::size_t i = 0; i < poses.size(); ++i)
      poses[i] = SE3d::exp(moved.segment<6>(6 * static_cast<Eigen::Index>(i))) * poses[i];
    p -= k * s * k.transpose();
    if (from) move_body_with_camera(before[0], before[1 + *from], *from, moved);
    follow_body(from, noise, before[0]);
  }
  void move_body_with_camera(const SE3d& body, const SE3d& extrinsic, std::size_t from,
                             const Eigen::VectorXd& moved) {
    const Eigen::Index at = 6 + 6 * static_cast<Eigen::Index>(from);
    const Vector6d by_camera = moved.head<6>() + map() * moved.segment<6>(at);
    poses[0] = SE3d::exp(by_camera) * body * extrinsic * poses[1 + from].inverse();
  }
  /// Beyond eight standard deviations of a detection. The error of the camera that saw stays but
  /// beside an exact one, which did not tell of it where one detection moved the body so far.
  void follow_body(std::optional<std::size_t> from, const Matrix6d& r, const SE3d& body_before) {
    if (!from) is_seen_exactly = true;
    if (!linearised_at) return;
    const auto apart = [&](const SE3d& a) { return Vector6d((poses[0] * a.inverse()).log()); };
    const auto deviations = [&](const Vector6d& d) { return std::sqrt(d.dot(r.inverse() * d)); };
    if (from && deviations(apart(body_before)) > 8.0) is_seen_exactly = false;
    const Vector6d behind = apart(*linearised_at);
    if (deviations(behind) <= 8.0) return;
    const Matrix6d before = map();
    linearised_at = SE3d::exp((1.0 - 8.0 / deviations(behind)) * behind) * *linearised_at;
    followed = true;
    if (!from || is_seen_exactly) return;
    Eigen::MatrixXd t = Eigen::MatrixXd::Identity(p.rows(), p.cols());
    t.block<6, 6>(0, 6 + 6 * static_cast<Eigen::Index>(*from)) = before - map();
    p = t * p * t.transpose();
  }
  bool is_seen_exactly = false;
  bool followed = false;
};

/// A part of one step of the motion below is within the second noise, and beyond the third a
/// detection corrects it by more than where cameras are linearised stays behind.
class ExtrinsicsWithOneMode : public ::testing::TestWithParam<double> {};

TEST_P(ExtrinsicsWithOneMode, AreOfTheJointKalmanFilter) {
  RandomStream random(5, 1);
  const Matrix6d r = isotropic(1.0, 0.005);
  const Matrix6d q = isotropic(GetParam(), 0.01 * GetParam());
  internal::SignificantMotion significant;
  const DetectorNoise noise({{.covariance = r}});
  const ConcentratedGaussian<SE3d> body(SE3d(), isotropic(0.5, 0.01));
  const std::array priors{ConcentratedGaussian<SE3d>(kOneModeCamera, isotropic(2, 0.02)),
                          ConcentratedGaussian<SE3d>(kOneModeCamera.inverse(), isotropic(5, 0.1))};
  MultiObjectFilter filter(body, {{noise}, {noise}}, plain_settings());
  PlainFilter plain{{body.mean(), priors[0].mean(), priors[1].mean()},
                    Eigen::MatrixXd::Zero(18, 18)};
  plain.p.topLeftCorner<6, 6>() = body.covariance();
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(filter.add_camera(priors[i]), i);
    plain.p.block<6, 6>(6 + 6 * static_cast<Eigen::Index>(i),
                        6 + 6 * static_cast<Eigen::Index>(i)) = priors[i].covariance();
  }
  const std::array truth{pose(0.2, 0.1, 0, 0.1, 0.2, 1), pose(0, 0.3, 1, -0.2, 0.1, 0.8)};
  SE3d at;
  for (int k = 0; k < 12; ++k) {
    const SE3d motion = pose(0.05, 0.02, 0.1, 0.03, 0, 0.02);
    at = at * motion;
    filter.predict_with_odometry(motion, q, 0.1);
    plain.predict(motion, q, plain.linearised_at ? significant.take(motion, q) : SE3d());
    const std::size_t object = k < 2 ? 0 : (k / 2) % 2;
    const std::optional<std::size_t> from =
        k % 3 == 2 ? std::nullopt : std::optional<std::size_t>(k % 3);
    const SE3d camera = from ? at * priors[*from].mean() : at;
    const SE3d seen = camera.inverse() * truth[object] * SE3d::exp(testing::draw(r, random));
    if (!filter.is_known(object)) {
      plain.begin(from, seen, r);
    } else {
      plain.update(3 + object, from, seen, r);
    }
    filter.update(object, observation_of(seen), {.camera = from});
    if (from) significant.see();
  }
  EXPECT_LT((filter.camera().mean() * plain.poses[0].inverse()).log().norm(), 1e-9);
  for (std::size_t i = 0; i < 2; ++i) {
    const Eigen::Index e = 6 + 6 * static_cast<Eigen::Index>(i);
    EXPECT_LT((filter.extrinsic(i).mean() * plain.poses[1 + i].inverse()).log().norm(), 1e-9);
    EXPECT_LT((filter.extrinsic(i).covariance() - plain.p.block<6, 6>(e, e)).norm(), 1e-10);
    EXPECT_LT(filter.extrinsic(i).covariance().trace(), 0.5 * priors[i].covariance().trace());
    EXPECT_EQ(filter.pose_index(i), 1 + i);
  }
  const std::vector<Eigen::Index> poses{0,  1,  2,  3,  4,  5,  18, 19, 20,
                                        21, 22, 23, 24, 25, 26, 27, 28, 29};
  EXPECT_EQ(filter.joint().mean().size(), 3U);
  EXPECT_LT((filter.joint().covariance() - plain.p(poses, poses)).norm(), 1e-10);
  EXPECT_EQ(plain.followed, GetParam() > 1.0);
}

INSTANTIATE_TEST_SUITE_P(Noise, ExtrinsicsWithOneMode, ::testing::Values(0.03, 0.3, 2.0));

}  // namespace
}  // namespace posemix
