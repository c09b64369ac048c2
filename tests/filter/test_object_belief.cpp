// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "filter/multi_object/object_belief.hpp"
#include "filter/scenario.hpp"
#include "posemix/density/pose_stack.hpp"

namespace posemix::internal {
namespace {

using posemix::testing::isotropic;
using posemix::testing::pose;

const Matrix6d kCameraCovariance = isotropic(1.0, 0.01);

JointGaussian camera_alone() {
  return JointGaussian(ConcentratedGaussian<SE3d>(pose(0.1, 0, 0, 0, 0, -1), kCameraCovariance));
}

/// A hypothesis at `at` with the covariance of a birth.
Alternative hypothesis(std::uint64_t id, double log_weight, const SE3d& at) {
  ConditionalPose pose{at, {}, Matrix12d::Zero(), Matrix12x6d::Zero()};
  pose.covariance.topLeftCorner<6, 6>() = kCameraCovariance + isotropic(2.0, 0.02);
  pose.cross_covariance.topRows<6>() = kCameraCovariance;
  return {{.log_weight = log_weight, .log_probability = log_weight, .id = id, .detections = 1},
          pose};
}

/// Multiplies the weights.
void add_log_evidence(ObjectBelief& belief, const std::vector<double>& evidence) {
  DetectionUpdates updates(evidence.size());
  for (std::size_t h = 0; h < evidence.size(); ++h)
    updates[h].explanation.log_evidence = evidence[h];
  belief.multiply_weights(updates, 0.0, 1.0);
}

void expect_same(const ConditionalPose& a, const ConditionalPose& b) {
  EXPECT_EQ(a.pose.matrix(), b.pose.matrix());
  EXPECT_EQ(a.covariance, b.covariance);
  EXPECT_EQ(a.cross_covariance, b.cross_covariance);
}

TEST(ObjectBelief, TheFirstBirthLeads) {
  JointGaussian joint = camera_alone();
  ObjectBelief belief;
  EXPECT_EQ(belief.leading(), std::nullopt);
  EXPECT_EQ(belief.pose_index(), std::nullopt);
  belief.add(joint, {});
  EXPECT_EQ(belief.size(), 0U);
  const Alternative first = hypothesis(7, -1.0, pose(0, 0, 0, 0, 0, 0.1));
  const Alternative second = hypothesis(8, -0.1, pose(0, 0, 2, 0, 0, 0.1));
  belief.add(joint, {first, second});
  EXPECT_EQ(belief.size(), 2U);
  EXPECT_EQ(belief.leading(), std::optional<std::size_t>(0));
  EXPECT_EQ(belief.pose_index(), std::optional<std::size_t>(1));
  EXPECT_EQ(joint.size(), 2U);
  expect_same(belief.pose(joint, 0), first.pose);
  expect_same(belief.pose(joint, 1), second.pose);
}

TEST(ObjectBelief, AChangeOfTheLeaderKeepsOrderAndPoses) {
  JointGaussian joint = camera_alone();
  ObjectBelief belief;
  Alternatives births;
  for (std::uint64_t id = 0; id < 4; ++id)
    births.push_back(hypothesis(id, -1.0, pose(0, 0, static_cast<double>(id), 0, 0, 0)));
  belief.add(joint, births);
  // Each in turn, so that the leader moves up and down.
  for (const std::size_t next : {2U, 1U, 3U, 0U}) {
    std::vector<double> evidence(4, -5.0);
    evidence[next] = 5.0;
    add_log_evidence(belief, evidence);
    add_log_evidence(belief, evidence);
    belief.normalise();
    belief.choose_leader(joint, 0.7);
    EXPECT_EQ(belief.leading(), std::optional<std::size_t>(next));
    EXPECT_EQ(belief.pose_index(), std::optional<std::size_t>(1));
    EXPECT_EQ(joint.size(), 2U);
    for (std::size_t h = 0; h < 4; ++h) {
      EXPECT_EQ(belief.standing(h).id, births[h].standing.id);
      expect_same(belief.pose(joint, h), births[h].pose);
    }
    std::vector<double> back(4, 10.0);
    back[next] = -10.0;
    add_log_evidence(belief, back);
  }
}

TEST(ObjectBelief, TheLeaderStaysUntilAnotherIsAheadByTheMargin) {
  JointGaussian joint = camera_alone();
  ObjectBelief belief;
  belief.add(joint, {hypothesis(0, -1.0, SE3d()), hypothesis(1, -0.5, pose(0, 0, 2, 0, 0, 0))});
  belief.choose_leader(joint, 0.7);
  EXPECT_EQ(belief.leading(), std::optional<std::size_t>(0));
  belief.choose_leader(joint, 0.4);
  EXPECT_EQ(belief.leading(), std::optional<std::size_t>(1));
}

TEST(ObjectBelief, KeepsTheHeaviestTheBestScoreAndTheLeader) {
  JointGaussian joint = camera_alone();
  ObjectBelief belief;
  Alternatives births;
  for (std::uint64_t id = 0; id < 6; ++id)
    births.push_back(hypothesis(id, id == 0 ? -50.0 : -1.0 - static_cast<double>(id),
                                pose(0, 0, 0.5 * static_cast<double>(id), 0, 0, 0)));
  births[4].standing.score = 9.0;
  births[5].standing.score = 9.0;  // the newest of equal scores stays
  ObjectBelief without_room;
  JointGaussian other_joint = joint;
  without_room.add(other_joint, births);
  belief.add(joint, births);

  belief.keep_best(4, 1);  // places: weights of 1, 2, 3; score of 5, which the leader takes
  ASSERT_EQ(belief.size(), 4U);
  EXPECT_EQ(belief.leading(), std::optional<std::size_t>(0));
  for (std::size_t h = 0; h < 4; ++h) EXPECT_EQ(belief.standing(h).id, h);

  add_log_evidence(without_room, {60.0, 0.0, 0.0, 0.0, 0.0, 0.0});
  without_room.keep_best(3, 1);  // weights of 0 and 1, score of 5
  ASSERT_EQ(without_room.size(), 3U);
  EXPECT_EQ(without_room.standing(1).id, 1U);
  EXPECT_EQ(without_room.standing(2).id, 5U);
  expect_same(without_room.pose(other_joint, 2), births[5].pose);
}

// Two of three hypotheses agree, and the younger of the two leads.
TEST(ObjectBelief, AMergeWithTheLeaderIsTheLeader) {
  JointGaussian joint = camera_alone();
  ObjectBelief belief;
  const SE3d near = pose(0, 0, 0.02, 0, 0, 0);
  const SE3d far = pose(0, 0, 3, 0, 0, 0);
  belief.add(joint, {hypothesis(0, std::log(0.2), SE3d()), hypothesis(1, std::log(0.6), near),
                     hypothesis(2, std::log(0.1), far)});
  belief.choose_leader(joint, 0.0);
  ASSERT_EQ(belief.leading(), std::optional<std::size_t>(1));

  EXPECT_EQ(belief.merge(joint, SymmetryGroup(), {1.0, 0.5, 10.0}), 1U);
  ASSERT_EQ(belief.size(), 2U);
  EXPECT_EQ(belief.leading(), std::optional<std::size_t>(0));
  EXPECT_EQ(joint.size(), 2U);
  EXPECT_EQ(belief.standing(0).id, 1U);
  EXPECT_NEAR(belief.standing(0).log_weight, std::log(0.8), 1e-14);
  // Three quarters of the way to the heavier one (midway-merge paper, eq. 12).
  EXPECT_TRUE(belief.pose(joint, 0).pose.is_approx(pose(0, 0, 0.015, 0, 0, 0), 1e-14));
  EXPECT_EQ(joint.covariance(), joint.covariance().transpose());
  EXPECT_EQ(belief.pose(joint, 1).pose.matrix(), far.matrix());
}

// A merge keeps the id of the heavier hypothesis at the place of the older one, so that ids do not
// ascend. The mixture of a belief with itself is the belief.
TEST(ObjectBelief, AMixtureWithAnEqualOneChangesNothing) {
  JointGaussian joint = camera_alone();
  ObjectBelief belief;
  const SE3d far = pose(0, 0, 3, 0, 0, 0);
  belief.add(joint, {hypothesis(0, std::log(0.2), SE3d()), hypothesis(1, std::log(0.3), far),
                     hypothesis(2, std::log(0.5), pose(0, 0, 0.02, 0, 0, 0))});
  ASSERT_EQ(belief.merge(joint, SymmetryGroup(), {1.0, 0.5, 10.0}), 1U);
  belief.normalise();
  ASSERT_EQ(belief.standing(0).id, 2U);
  ASSERT_EQ(belief.standing(1).id, 1U);
  const ObjectBelief before = belief;
  const LogTotals half{std::log(0.5), std::log(0.5)};
  OtherBelief other{
      {},
      {before.log_absent() + half.weight, before.log_absence_probability() + half.probability},
      true};
  for (std::size_t h = 0; h < before.size(); ++h) {
    other.hypotheses.push_back({before.standing(h), before.pose(joint, h)});
    other.hypotheses.back().standing.log_weight += half.weight;
    other.hypotheses.back().standing.log_probability += half.probability;
  }
  std::uint64_t next_id = 3;
  belief.mix(joint, half, other, SymmetryGroup(), {1.0, 0.5, 10.0}, next_id);
  belief.normalise();
  ASSERT_EQ(belief.size(), before.size());
  EXPECT_EQ(next_id, 3U);
  for (std::size_t h = 0; h < before.size(); ++h) {
    EXPECT_EQ(belief.standing(h).id, before.standing(h).id);
    EXPECT_NEAR(belief.standing(h).log_weight, before.standing(h).log_weight, 1e-12);
    EXPECT_LT((belief.pose(joint, h).pose * before.pose(joint, h).pose.inverse()).log().norm(),
              1e-12);
  }
  // The same id at a place that is far away is another hypothesis.
  other.hypotheses[1].pose.pose = pose(0, 0, -1.5, 0, 0, 0);
  belief.mix(joint, half, other, SymmetryGroup(), {1.0, 0.5, 10.0}, next_id);
  EXPECT_EQ(belief.size(), before.size() + 1);
  EXPECT_EQ(belief.standing(before.size()).id, 3U);
  EXPECT_EQ(next_id, 4U);
}

/// A random covariance of a pose and a slow error, and its cross-covariance with the camera.
ConditionalPose pose_with_slow_error(const SE3d& at, RandomStream& stream) {
  const Eigen::MatrixXd p = posemix::testing::correlated_covariance(3, stream);
  ConditionalPose object{at, Vector6d::Constant(0.01), Matrix12d(p.bottomRightCorner<12, 12>()),
                         Matrix12x6d(p.bottomLeftCorner<12, 6>())};
  return object;
}

/// Two hypotheses with the same pose and slow error, of which the first leads.
struct BeliefOfEqualHypotheses {
  explicit BeliefOfEqualHypotheses(std::uint64_t seed) : stream(seed) {
    const ConditionalPose object = pose_with_slow_error(pose(0.2, -0.1, 0.4, 0.1, 0, 0.2), stream);
    belief.add(joint,
               {{{.log_weight = -0.5, .id = 0}, object}, {{.log_weight = -1, .id = 1}, object}});
  }

  RandomStream stream;
  JointGaussian joint = camera_alone();
  ObjectBelief belief;
};

// b <- a b + w with Cov w = (1 - a^2) B, whether a hypothesis leads or not.
TEST(ObjectBelief, TheSlowErrorOfEveryHypothesisDecays) {
  BeliefOfEqualHypotheses given(3);
  const ConditionalPose before = given.belief.pose(given.joint, 1);
  const Matrix6d stationary = isotropic(1.5, 0.02);
  given.belief.decay_slow_error(given.joint, {.covariance = stationary, .correlation_time_s = 2.0},
                                stationary, std::nullopt, 0.5);
  const double a = std::exp(-0.25);
  Matrix12d f = Matrix12d::Identity();
  f.bottomRightCorner<6, 6>() *= a;
  Matrix12d covariance = f * before.covariance * f;
  covariance.bottomRightCorner<6, 6>() += (1.0 - a * a) * stationary;
  for (const std::size_t h : {0U, 1U}) {
    const ConditionalPose after = given.belief.pose(given.joint, h);
    EXPECT_TRUE(after.slow->isApprox(a * *before.slow, 1e-12)) << h;
    EXPECT_TRUE(after.covariance.isApprox(covariance, 1e-12)) << h;
    EXPECT_TRUE(after.cross_covariance.isApprox(f * before.cross_covariance, 1e-12)) << h;
    EXPECT_EQ(after.pose.matrix(), before.pose.matrix()) << h;
  }
}

/// As a detection leaves two equal hypotheses that begin with it, of which the first leads.
struct DetectedBelief {
  explicit DetectedBelief(const Matrix6d& slow) {
    Alternative born = hypothesis(0, -0.5, pose(0.2, -0.1, 0.4, 0.1, 0, 0.2));
    born.pose.slow = Vector6d::Constant(0.01);
    born.pose.covariance.topLeftCorner<6, 6>() += slow;
    born.pose.covariance.topRightCorner<6, 6>() = -slow;
    born.pose.covariance.bottomLeftCorner<6, 6>() = -slow;
    born.pose.covariance.bottomRightCorner<6, 6>() = slow;
    Alternative other = born;
    other.standing.id = 1;
    belief.add(joint, {born, other});
  }

  JointGaussian joint = camera_alone();
  ObjectBelief belief;
};

Matrix18d moments_of(const DetectedBelief& given, std::size_t h) {
  return given.belief.state(given.joint, h).covariance;
}

/// Covariance of [xi_O - xi_C; b].
Matrix12d seen_moments(const DetectedBelief& given, std::size_t h) {
  Eigen::Matrix<double, 12, 18> f = Eigen::Matrix<double, 12, 18>::Zero();
  f.topLeftCorner<6, 6>() = -Matrix6d::Identity();
  f.block<12, 12>(0, 6).setIdentity();
  return f * moments_of(given, h) * f.transpose();
}

// Whether a hypothesis leads or not, and what a camera sees is what it saw when it sees again.
TEST(ObjectBelief, TheSlowErrorBecomesThatOfAnotherCamera) {
  DetectedBelief given(isotropic(3.0, 0.03));
  ObjectSensor sensor{posemix::testing::gaussian_noise()};
  NoiseDependence dependence;
  dependence.slow = {.covariance = isotropic(3.0, 0.03), .correlation_angle_rad = 1.0};
  sensor.noise = DetectorNoise(sensor.noise.components(), sensor.noise.clutter(), dependence);
  const ObservationSource first;
  const ObservationSource second{.body_camera = pose(0, 0.4, 0, 0.4, 0.1, 0)};
  const ObservationSource third{.body_camera = pose(0, -0.4, 0, -0.4, 0.1, 0.1)};
  given.belief.see_from(given.joint, first, sensor);
  const Matrix12d before = seen_moments(given, 0);
  const Vector6d mean = given.belief.state(given.joint, 0).slow;
  const DetectionState preview = given.belief.state_seen_from(given.joint, 1, second, sensor);
  for (const ObservationSource& source : {second, third}) {
    given.belief.see_from(given.joint, source, sensor);
    EXPECT_TRUE(moments_of(given, 0).isApprox(moments_of(given, 1), 1e-9));
    EXPECT_FALSE(seen_moments(given, 0).isApprox(before, 1e-3));
    if (is_same_camera(source, second)) {
      EXPECT_TRUE(moments_of(given, 1).isApprox(preview.covariance, 1e-9));
      EXPECT_TRUE(given.belief.state(given.joint, 0).slow.isApprox(preview.slow, 1e-9));
    }
  }
  given.belief.see_from(given.joint, first, sensor);
  for (const std::size_t h : {0U, 1U}) {
    EXPECT_TRUE(seen_moments(given, h).isApprox(before, 1e-9)) << h;
    EXPECT_TRUE(given.belief.state(given.joint, h).slow.isApprox(mean, 1e-9)) << h;
  }
}

// To the last bit, as factors of them read one half.
TEST(ObjectBelief, CovariancesStaySymmetricWhereSlowErrorsAreRescaled) {
  const ObjectSensor sensor{posemix::testing::gaussian_noise()};
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    BeliefOfEqualHypotheses given(seed);
    given.belief.rescale_slow_error(given.joint, sensor, Vector6d::LinSpaced(0.7, 1.3));
    const ConditionalPose leading = given.belief.pose(given.joint, 0);
    const ConditionalPose other = given.belief.pose(given.joint, 1);
    EXPECT_EQ(other.covariance, other.covariance.transpose()) << seed;
    EXPECT_EQ(leading.covariance, leading.covariance.transpose()) << seed;
    EXPECT_TRUE(other.covariance.isApprox(leading.covariance, 1e-12)) << seed;
  }
}

}  // namespace
}  // namespace posemix::internal
