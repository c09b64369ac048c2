// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "filter/multi_object/global_hypotheses.hpp"
#include "multi_object_scene.hpp"
#include "posemix/testing/numeric_jacobian.hpp"

/// Cameras of a rig whose poses on the body are a part of the state.
namespace posemix {
namespace {

using internal::ActiveLimits;
using internal::GlobalHypotheses;
using internal::JointGaussian;
using internal::MultiObjectState;
using testing::isotropic;
using testing::OrbitScene;
using testing::plain_settings;
using testing::pose;
using testing::ray_noise;

const SE3d kBodyCamera = pose(0.1, 0.5, -0.2, 0.2, -0.1, 0.05);

TEST(Extrinsics, TheErrorOfACameraIsThatOfTheBodyAndOfItsPoseThere) {
  JointGaussian joint(ConcentratedGaussian<SE3d>(testing::kCameraPose, isotropic(1, 0.01)));
  joint.append_extrinsic({pose(0.3, 0.1, 0.2, 1, 2, 3), isotropic(1, 0.01)});
  joint.append_extrinsic({kBodyCamera, isotropic(2, 0.02)});
  const auto seeing = [&](const Eigen::VectorXd& xi) {
    const SE3d body = SE3d::exp(xi.head<6>()) * joint.pose(0);
    const SE3d moved = body * SE3d::exp(xi.tail<6>()) * joint.pose(2) *
                       joint.seeing_camera({.camera = 1}).inverse();
    return Eigen::VectorXd(moved.log());
  };
  Eigen::MatrixXd numeric(6, 18);
  for (Eigen::Index i = 0; i < 18; ++i) {
    numeric.col(i) = testing::derivative_at_zero<double>(
        [&](double s) { return seeing(s * Eigen::VectorXd::Unit(18, i)); });
  }
  EXPECT_LT((joint.seen_by({.camera = 1}) - numeric).norm(), 1e-8);
  Eigen::MatrixXd of_body = Eigen::MatrixXd::Zero(6, 18);
  of_body.leftCols<6>().setIdentity();
  EXPECT_EQ(joint.seen_by({}), of_body);
}

/// An extended Kalman filter over the body, two extrinsics and objects, as in a textbook; but the
/// cameras are linearised at a pose of the body of its own, eq. (38).
struct PlainFilter {
  std::vector<SE3d> poses;
  Eigen::MatrixXd p;
  std::optional<SE3d> seen_at = {};

  Matrix6d map() const { return seen_at.value_or(poses[0]).adjoint(); }
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
    if (!seen_at) return;
    const SE3d to = *seen_at * significant;
    const Matrix6d rest = to.adjoint() - map() - (poses[0].adjoint() - before.adjoint());
    seen_at = to;
    for (Eigen::Index at : {6, 12})
      p.topLeftCorner<6, 6>() += rest * p.block<6, 6>(at, at) * rest.transpose();
  }
  void begin(std::optional<std::size_t> from, const SE3d& seen, const Matrix6d& r) {
    const Eigen::MatrixXd m = seeing(from);
    const Eigen::Index n = p.rows();
    poses.push_back(camera(from) * seen);
    if (from && !seen_at) seen_at = poses[0];
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
    if (!seen_at) return;
    const auto apart = [&](const SE3d& a) { return Vector6d((poses[0] * a.inverse()).log()); };
    const auto deviations = [&](const Vector6d& d) { return std::sqrt(d.dot(r.inverse() * d)); };
    if (from && deviations(apart(body_before)) > 8.0) is_seen_exactly = false;
    const Vector6d behind = apart(*seen_at);
    if (deviations(behind) <= 8.0) return;
    const Matrix6d before = map();
    seen_at = SE3d::exp((1.0 - 8.0 / deviations(behind)) * behind) * *seen_at;
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
  const std::array priors{ConcentratedGaussian<SE3d>(kBodyCamera, isotropic(2, 0.02)),
                          ConcentratedGaussian<SE3d>(kBodyCamera.inverse(), isotropic(5, 0.1))};
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
    plain.predict(motion, q, plain.seen_at ? significant.take(motion, q) : SE3d());
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

/// Beside an exact camera and without.
TEST(Extrinsics, AreIndependentOfABodyThatIsGiven) {
  for (const bool is_exact : {false, true}) {
    MultiObjectState state({SE3d(), isotropic(0.1, 1e-3)},
                           {{DetectorNoise({{.covariance = isotropic(1.0, 0.01)}})}}, {});
    state.add_camera({kBodyCamera, isotropic(5, 0.05)});
    const auto see = [&](const ObservationSource& source) {
      internal::LogTotals evidence;
      const auto seen = state.observe(0, observation_of(pose(0.1, 0, 0.2, 0, 0, 1)), source);
      state.update(0, seen, internal::Starters(1, true), evidence);
    };
    if (is_exact) see({});
    see({.camera = 0});
    const Matrix6d noise = isotropic(0.1, 1e-3);
    state.set_camera({SE3d(), noise}, 0.1);
    see({.camera = 0});
    state.set_camera({pose(1e-3, 0, 0, 1e-3, 0, 0), noise}, 0.1);
    const Matrix6d cross = state.joint.covariance(0, 1);
    EXPECT_TRUE(cross.isZero(0.0));
  }
}

/// With a body that is known and stays, a camera of uncertain pose on it is a body of uncertain
/// pose. Everything that treats the camera treats extrinsics alike, in all hypotheses.
TEST(Extrinsics, OfABodyThatIsKnownAreTheBodyItself) {
  const Matrix6d tiny = 1e-14 * Matrix6d::Identity();
  const Matrix6d wide = isotropic(2.0, 0.03);
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    OrbitScene scene(seed, 3, 0.1, 0.002);
    const SE3d start = SE3d::exp(testing::draw(wide, scene.stream)) * scene.camera;
    const std::vector<ObjectSensor> sensors(3, {ray_noise(0.1)});
    MultiObjectFilter body({start, wide}, sensors, plain_settings());
    MultiObjectFilter rig({SE3d(), tiny}, sensors, plain_settings());
    rig.add_camera({start, wide});
    // The error of a start is kept beside the joint Gaussian, that of extrinsics is not: a body
    // that is given has all of it in the joint Gaussian until the twentieth detection.
    body.set_camera({start, wide}, 0.0);
    rig.set_camera({SE3d(), tiny}, 0.0);
    for (int k = 0; k < 19; ++k) {
      const std::size_t object = static_cast<std::size_t>(k) % 3;
      const Observation seen = observation_of(scene.detect(object, 0.45, 0.05));
      const ObjectUpdateReport a = body.update(object, seen);
      const ObjectUpdateReport b = rig.update(object, seen, {.camera = 0});
      ASSERT_NEAR(a.log_evidence, b.log_evidence, 1e-4) << "seed " << seed << ", detection " << k;
      ASSERT_EQ(a.started, b.started);
      ASSERT_EQ(body.leading(object), rig.leading(object));
      ASSERT_LT((rig.extrinsic(0).mean() * body.camera().mean().inverse()).log().norm(), 1e-5);
      ASSERT_LT((rig.extrinsic(0).covariance() - body.camera().covariance()).norm(),
                1e-4 * body.camera().covariance().norm());
      const auto ours = rig.hypotheses(object);
      const auto theirs = body.hypotheses(object);
      ASSERT_EQ(ours.size(), theirs.size());
      for (std::size_t h = 0; h < ours.size(); ++h) {
        ASSERT_NEAR(ours[h].log_weight, theirs[h].log_weight, 1e-3);
        ASSERT_LT((ours[h].pose * theirs[h].pose.inverse()).log().norm(), 1e-5);
        ASSERT_LT((ours[h].covariance - theirs[h].covariance).norm(),
                  1e-4 * theirs[h].covariance.norm());
      }
    }
    EXPECT_GT(body.camera_mixture().size() + body.hypotheses(0).size(), 2U);
  }
}

/// Noise of which everything is on: typical, with a slow error.
DetectorNoise full_noise() {
  return DetectorNoise(
      ray_noise().components(), {.weight = 0.2},
      {.slow = SlowError{.covariance = pose_covariance({0.06, 0.06, 0.03}, {0.004, 0.004, 0.03}),
                         .correlation_time_s = 3.0},
       .is_typical = true});
}

/// The same without clutter, with which every object has one hypothesis.
DetectorNoise one_mode_noise() {
  return DetectorNoise(full_noise().components(), {.weight = 0.0}, full_noise().dependence());
}

/// A camera that no observation is from, or whose pose is all but exact, changes nothing.
TEST(Extrinsics, ThatAreAllButExactChangeNothing) {
  for (const bool has_odometry : {true, false}) {
    for (const bool is_used : {false, true}) {
      OrbitScene scene(3, 3, 0.1, 0.002);
      MultiObjectSettings settings;
      settings.has_odometry = has_odometry;
      const std::vector<ObjectSensor> sensors(3, {full_noise()});
      const ConcentratedGaussian<SE3d> start(scene.camera, isotropic(0.1, 0.002));
      MultiObjectFilter exact(start, sensors, settings);
      MultiObjectFilter rig = exact;
      const Matrix6d wide = isotropic(3.0, 0.1);
      rig.add_camera({kBodyCamera, is_used ? Matrix6d(1e-9 * wide) : wide});
      for (int k = 0; k < 80; ++k) {
        const SE3d motion = scene.advance();
        for (MultiObjectFilter* filter : {&exact, &rig}) {
          if (has_odometry) {
            filter->predict_with_odometry(motion, scene.q, 0.1);
          } else {
            filter->predict_constant_velocity(1.0, isotropic(0.2, 0.003), isotropic(0.1, 0.002),
                                              isotropic(2.0, 0.03), 0.1);
          }
        }
        const std::size_t object = static_cast<std::size_t>(k) % 3;
        const Observation seen =
            observation_of(kBodyCamera.inverse() * scene.detect(object, 0.4, 0.05));
        exact.update(object, seen, {.body_camera = kBodyCamera});
        rig.update(object, seen,
                   is_used ? ObservationSource{.camera = 0}
                           : ObservationSource{.body_camera = kBodyCamera});
        ASSERT_LT((exact.joint().covariance() - rig.joint().covariance()).norm(),
                  1e-4 * exact.joint().covariance().norm())
            << "detection " << k;
        ASSERT_LT((exact.camera().mean() * rig.camera().mean().inverse()).log().norm(), 1e-4);
        ASSERT_NEAR(exact.mode_probability(object), rig.mode_probability(object), 1e-3);
        ASSERT_EQ(exact.leading(object), rig.leading(object));
      }
      if (!is_used) {
        EXPECT_LT((rig.extrinsic(0).covariance() - wide).norm(), 1e-9);
      }
    }
  }
}

TEST(Extrinsics, StayWithTheCameraWhereObjectsArePassive) {
  OrbitScene scene(9, 12, 0.1, 0.002);
  const auto filter_with = [&](const ActiveLimits& limits) {
    MultiObjectState state(ConcentratedGaussian<SE3d>(scene.camera, isotropic(0.1, 0.002)),
                           std::vector<ObjectSensor>(scene.truth.size(), {one_mode_noise()}),
                           plain_settings());
    state.add_camera({kBodyCamera, isotropic(2, 0.02)});
    state.limits = limits;
    return GlobalHypotheses(state);
  };
  GlobalHypotheses dense = filter_with({.dense = 1000});
  GlobalHypotheses few = filter_with({.dense = 9, .most = 9, .kept = 4});
  for (int k = 0; k < 100; ++k) {
    const SE3d motion = scene.advance();
    const std::size_t object = static_cast<std::size_t>(k / 4 + k % 3) % scene.truth.size();
    const bool is_second = k % 2 == 1;
    const SE3d seen = scene.detect(object, 0.0, 0.0);
    const Observation observation = observation_of(is_second ? kBodyCamera.inverse() * seen : seen);
    for (GlobalHypotheses* filter : {&dense, &few}) {
      filter->for_each([&](MultiObjectState& s) { s.predict_with_odometry(motion, scene.q, 0.1); });
      filter->update(object, observation,
                     is_second ? ObservationSource{.camera = 0} : ObservationSource{});
    }
    JointGaussian a = dense.summary().joint;
    JointGaussian b = few.summary().joint;
    // With passive objects another part of the error of the world is in it.
    a.add_world_error(dense.summary().world_error);
    b.add_world_error(few.summary().world_error);
    ASSERT_LT((a.covariance() - b.covariance()).norm(), 1e-7 * a.covariance().norm()) << k;
    ASSERT_LT((a.pose(1) * b.pose(1).inverse()).log().norm(), 1e-7);
  }
  EXPECT_LT(few.summary().joint.active(), few.summary().joint.size());
}

TEST(Extrinsics, ArePredictedWithTheirUncertainty) {
  MultiObjectFilter filter({SE3d(), isotropic(0.1, 0.001)}, {{ray_noise(0.0)}}, plain_settings());
  filter.add_camera({kBodyCamera, isotropic(2, 0.02)});
  const SE3d seen = pose(0.3, 0, 0, 0, 0.1, 0.8);
  filter.update(0, observation_of(seen));
  const auto exact = filter.predicted_detection(0, 0, kBodyCamera);
  const auto uncertain = filter.predicted_detection(0, 0, ObservationSource{.camera = 0});
  EXPECT_LT((exact.mean() * uncertain.mean().inverse()).log().norm(), 1e-12);
  // In the axes of the camera the pose differs by the error of the extrinsic there, exactly.
  const Matrix6d added = kBodyCamera.inverse().adjoint_congruence(isotropic(2, 0.02));
  EXPECT_LT((uncertain.covariance() - exact.covariance() - added).norm(), 1e-9);
  // An object that was seen by that camera alone is known from it as well as it was seen.
  MultiObjectFilter other({SE3d(), isotropic(0.1, 0.001)}, {{ray_noise(0.0)}}, plain_settings());
  other.add_camera({kBodyCamera, isotropic(2, 0.02)});
  other.update(0, observation_of(seen), {.camera = 0});
  EXPECT_LT(other.predicted_detection(0, 0, ObservationSource{.camera = 0}).covariance().trace(),
            other.relative(0, 0).covariance().trace() - 0.9 * isotropic(2, 0.02).trace());
}

TEST(Extrinsics, ThatComeTooLateOrAreNotThereAreRefused) {
  MultiObjectFilter filter({SE3d(), isotropic(1, 0.01)}, {{ray_noise()}}, plain_settings());
  const Observation seen = observation_of(pose(0, 0, 0, 0, 0, 1));
  EXPECT_THROW(filter.update(0, seen, {.camera = 0}), InvalidInput);
  EXPECT_THROW(filter.extrinsic(0), InvalidInput);
  filter.add_camera({kBodyCamera, isotropic(2, 0.02)});
  EXPECT_EQ(filter.extrinsic_count(), 1U);
  EXPECT_THROW(filter.update(0, seen, {.camera = 1}), InvalidInput);
  filter.update(0, seen, {.camera = 0});
  EXPECT_THROW(filter.predicted_detection(0, 0, ObservationSource{.camera = 1}), InvalidInput);
  EXPECT_THROW(filter.add_camera({kBodyCamera, isotropic(2, 0.02)}), InvalidInput);
}

}  // namespace
}  // namespace posemix
