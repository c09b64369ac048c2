// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>

#include <numbers>

#include "filter/multi_object_scene.hpp"
#include "posemix/slam/run.hpp"
#include "posemix/slam/symmetric_error.hpp"
#include "posemix/testing/expect.hpp"

namespace posemix {
namespace {

using testing::isotropic;
using testing::OrbitScene;
using testing::pose;
using testing::ray_noise;
using testing::thrown_message;

constexpr std::size_t kModels = 5;

SymmetryGroup half_turn() { return SymmetryGroup({pose(0, 0, std::numbers::pi, 0, 0, 0)}); }

std::vector<ObjectModel> bolts(std::size_t count, const SymmetryGroup& symmetries) {
  std::vector<ObjectModel> models;
  for (std::size_t i = 0; i < count; ++i) {
    models.push_back({.id = "bolt." + std::to_string(i),
                      .noise = ray_noise(),
                      .symmetries = symmetries,
                      .class_id = "bolt"});
  }
  return models;
}

ObjectSlam make_candidates(const SE3d& camera, const std::vector<ObjectModel>& models) {
  return ObjectSlam(ConcentratedGaussian<SE3d>(camera, isotropic(0.01, 1e-4)), models, {});
}

std::vector<std::optional<SE3d>> none(std::size_t count) {
  return std::vector<std::optional<SE3d>>(count);
}

/// Detections in arbitrary order: half of them turned, a fifth missing, and in two of five frames a
/// false one.
std::vector<Candidate> detect(OrbitScene& scene) {
  std::vector<Candidate> candidates;
  for (std::size_t j = 0; j < scene.truth.size(); ++j) {
    if (scene.stream.uniform() < 0.2) continue;
    const Candidate candidate{"bolt", scene.detect(j, 0.5, 0.0),
                              0.6 + 0.4 * scene.stream.uniform()};
    const auto place = static_cast<std::ptrdiff_t>(scene.stream.uniform() *
                                                   static_cast<double>(candidates.size() + 1));
    candidates.insert(candidates.begin() + place, candidate);
  }
  if (scene.stream.uniform() < 0.4) {
    const SE3d anywhere(
        SO3d::exp({scene.stream.normal(), scene.stream.normal(), 0.0}),
        {scene.stream.uniform() - 0.5, scene.stream.uniform() - 0.5, 0.6 + scene.stream.uniform()});
    candidates.push_back({"bolt", anywhere, 0.55});
  }
  return candidates;
}

struct Followed {
  std::vector<std::optional<std::size_t>> models;  ///< at the end, of each true object
  std::size_t changes = 0;                         ///< of these, after the first ten frames
  std::size_t flips = 0;                           ///< jumps of more than 20 deg
  std::size_t recycled = 0;
  double worst_deg = 0.0;  ///< symmetric, at the end
  double worst_m = 0.0;
};

/// Which confirmed model is at each true object, and how its pose moves.
Followed follow(OrbitScene& scene, const SymmetryGroup& declared, int frames) {
  ObjectSlam slam = make_candidates(scene.camera, bolts(kModels, declared));
  Followed result;
  result.models.resize(scene.truth.size());
  std::vector<std::optional<SE3d>> before(scene.truth.size());
  for (int k = 0; k < frames; ++k) {
    FrameInput input{.dt = 0.1, .motion = {}, .detections = none(kModels)};
    if (k > 0) input.motion = scene.advance();
    input.candidates = detect(scene);
    const FrameReport report = slam.step(input).report;
    for (const CandidateReport& candidate : report.candidates)
      result.recycled += candidate.recycled;
    for (std::size_t j = 0; j < scene.truth.size(); ++j) {
      std::optional<std::size_t> nearest;
      double least = 0.07;
      for (std::size_t m = 0; m < kModels; ++m) {
        if (!slam.pose_index(m) || slam.detections(m) < 3) continue;
        const SE3d& estimate = slam.estimate().mean()[*slam.pose_index(m)];
        const double distance = (estimate.translation() - scene.truth[j].translation()).norm();
        if (distance >= least) continue;
        least = distance;
        nearest = m;
      }
      if (k > 10 && nearest != result.models[j]) ++result.changes;
      result.models[j] = nearest;
      if (!nearest) continue;
      const SE3d estimate = slam.estimate().mean()[*slam.pose_index(*nearest)];
      if (before[j] && symmetric_pose_error(estimate, *before[j], {}).rotation_rad > radians(20.0))
        ++result.flips;
      before[j] = estimate;
      if (k + 1 < frames) continue;
      const auto error = symmetric_pose_error(estimate, scene.truth[j], half_turn());
      result.worst_deg = std::max(result.worst_deg, degrees(error.rotation_rad));
      result.worst_m = std::max(result.worst_m, error.translation_m);
    }
  }
  return result;
}

TEST(ObjectCandidates, EqualSymmetricObjectsAreToldApart) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    SCOPED_TRACE(seed);
    OrbitScene scene(seed, 3, 0.05, 1e-3);
    const Followed result = follow(scene, half_turn(), 80);
    for (std::size_t j = 0; j < 3; ++j) {
      ASSERT_TRUE(result.models[j].has_value());
      for (std::size_t i = 0; i < j; ++i) EXPECT_NE(result.models[i], result.models[j]);
    }
    EXPECT_EQ(result.changes, 0U);
    EXPECT_EQ(result.flips, 0U);
    EXPECT_GT(result.recycled, 0U);
    // Detections err by 7.5 deg and 6 cm (one standard deviation); about 60 of each.
    EXPECT_LT(result.worst_deg, 6.0);
    EXPECT_LT(result.worst_m, 0.04);
  }
}

// The test above is not vacuous: without the symmetry half of the detections are of another mode.
TEST(ObjectCandidates, FlipsWithoutTheSymmetry) {
  std::size_t flips = 0;
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    OrbitScene scene(seed, 3, 0.05, 1e-3);
    flips += follow(scene, {}, 80).flips;
  }
  EXPECT_GT(flips, 0U);
}

std::vector<Candidate> candidate_at(double x, double score = 1.0) {
  return {{"bolt", pose(0.3, 0.2, 0.1, x, 0.0, 0.8), score}};
}

/// The first frame, with candidates for one model.
FrameInput first(const std::vector<Candidate>& candidates) {
  return {.detections = none(1), .candidates = candidates};
}

TEST(ObjectCandidates, ATentativeInstanceGivesWay) {
  ObjectSlam slam = make_candidates(SE3d(), bolts(1, {}));
  EXPECT_EQ(slam.step(first(candidate_at(0.0))).report.candidates[0].status,
            CandidateStatus::fresh);
  EXPECT_EQ(slam.step({0.1, SE3d(), none(1), candidate_at(0.0)}).report.candidates[0].status,
            CandidateStatus::assigned);
  EXPECT_EQ(slam.detections(0), 2U);
  const CandidateReport taken =
      slam.step({0.1, SE3d(), none(1), candidate_at(0.4)}).report.candidates[0];
  EXPECT_EQ(taken.status, CandidateStatus::fresh);
  EXPECT_EQ(taken.object, std::optional<std::size_t>(0));
  EXPECT_TRUE(taken.recycled);
  EXPECT_EQ(slam.detections(0), 1U);
  EXPECT_EQ(slam.multi_object()->hypotheses(0).size(), 1U);
}

TEST(ObjectCandidates, AConfirmedInstanceStays) {
  ObjectSlam slam = make_candidates(SE3d(), bolts(1, {}));
  slam.step(first(candidate_at(0.0)));
  for (int k = 0; k < 2; ++k) slam.step({0.1, SE3d(), none(1), candidate_at(0.0)});
  const CandidateReport other =
      slam.step({0.1, SE3d(), none(1), candidate_at(0.4)}).report.candidates[0];
  EXPECT_EQ(other.status, CandidateStatus::dropped);
  EXPECT_FALSE(other.object.has_value());
  EXPECT_EQ(slam.detections(0), 3U);
}

TEST(ObjectCandidates, TheSurestTakesTheLastModel) {
  ObjectSlam slam = make_candidates(SE3d(), bolts(1, {}));
  std::vector<Candidate> both = candidate_at(0.0, 0.5);
  both.push_back(candidate_at(0.4, 0.9).front());
  both.push_back({"nut", SE3d(), 1.0});
  const FrameReport report = slam.step(first(both)).report;
  // One that was seen in this frame does not give way.
  EXPECT_EQ(report.candidates[0].status, CandidateStatus::dropped);
  EXPECT_EQ(report.candidates[1].status, CandidateStatus::fresh);
  EXPECT_EQ(report.candidates[2].status, CandidateStatus::dropped);
  EXPECT_EQ(report.statuses[0], DetectionStatus::started);
}

TEST(ObjectCandidates, AnObjectIsAClassOfItsOwn) {
  ObjectModel bolt{.id = "bolt", .noise = ray_noise()};
  ObjectSlam slam = make_candidates(SE3d(), {bolt});
  slam.step({.detections = {candidate_at(0.0).front().camera_object}});
  const FrameReport report = slam.step({0.1, SE3d(), none(1), candidate_at(0.0)}).report;
  EXPECT_EQ(report.candidates[0].status, CandidateStatus::assigned);
  EXPECT_EQ(slam.detections(0), 2U);
}

TEST(ObjectCandidates, ModelsOfOneClassAreAlike) {
  std::vector<ObjectModel> models = bolts(3, half_turn());
  EXPECT_NO_THROW(make_candidates(SE3d(), models));
  models[2].symmetries = {};
  EXPECT_EQ(thrown_message([&] { make_candidates(SE3d(), models); }),
            "objects 'bolt.0' and 'bolt.2' are of class 'bolt', but their symmetries differ; "
            "expected the same");
  models[2] = bolts(3, half_turn())[2];
  NoiseComponent component = models[1].noise.components().front();
  component.covariance *= 1.5;
  models[1].noise = DetectorNoise({component}, models[1].noise.clutter());
  EXPECT_EQ(thrown_message([&] { make_candidates(SE3d(), models); }),
            "objects 'bolt.0' and 'bolt.1' are of class 'bolt', but their noise models differ; "
            "expected the same");
  models[1].class_id = "nut";
  EXPECT_NO_THROW(make_candidates(SE3d(), models)) << "classes may differ";
}

TEST(ObjectCandidates, TheGaussianSumFilterRefusesThem) {
  ObjectSlamSettings settings;
  settings.tracker = GaussianSumSettings{};
  ObjectSlam slam(ConcentratedGaussian<SE3d>(SE3d(), isotropic(0.1, 1e-3)), bolts(1, {}), settings);
  EXPECT_NE(thrown_message([&] { slam.step(first(candidate_at(0.0))); }).find("Gaussian-sum"),
            std::string::npos);
}

TEST(ObjectCandidates, RunPassesThoseOfARecording) {
  Sequence sequence;
  sequence.objects = {{"bolt.0", none(2), {}, {}}, {"bolt.1", none(2), {}, {}}};
  sequence.stamps = {0.0, 0.1};
  sequence.odometry = {SE3d(), SE3d()};
  sequence.candidates = {candidate_at(0.0), candidate_at(0.4)};
  const ConcentratedGaussian<SE3d> camera(SE3d(), isotropic(0.1, 1e-3));
  const SlamRun done = run(sequence, camera, bolts(2, {}), {});
  EXPECT_TRUE(done.frames[0].objects[0].has_value());
  EXPECT_FALSE(done.frames[0].objects[1].has_value());
  EXPECT_TRUE(done.frames[1].objects[1].has_value());
  EXPECT_EQ(done.frames[1].report.candidates[0].object, std::optional<std::size_t>(1));
  sequence.candidates.pop_back();
  EXPECT_THROW(run(sequence, camera, bolts(2, {}), {}), InvalidInput);
}

}  // namespace
}  // namespace posemix
