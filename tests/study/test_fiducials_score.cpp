// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "study/fiducials/score.hpp"
#include "tag_recording.hpp"

namespace posemix {
namespace {

using testing::TagRecording;

/// The reference at every second stamp.
ReferencePath reference_of(const TagRecording& recording) {
  std::vector<StampedPose> poses;
  for (std::size_t k = 0; k < recording.path.size(); k += 2) poses.push_back(recording.path[k]);
  return ReferencePath(poses);
}

/// The path in another frame, with errors of up to two centimetres.
std::vector<StampedPose> wavering_path(const TagRecording& recording) {
  const SE3d other(SO3d::exp({0.1, 0.2, 0.3}), {1.0, 2.0, 3.0});
  std::vector<StampedPose> path;
  for (const StampedPose& pose : recording.path) {
    const double t = pose.stamp;
    const Eigen::Vector3d error(0.01 * std::sin(3 * t), 0.02 * std::cos(2 * t), 0.01 * std::sin(t));
    path.push_back({t, other * *pose.pose * SE3d(SO3d(), error)});
  }
  return path;
}

TEST(ReferencePath, IsInterpolatedAndStopsAtGaps) {
  const SE3d turned(SO3d::exp({0.0, 0.0, 1.0}), {1.0, 0.0, 0.0});
  const std::vector<StampedPose> poses{
      {0.0, SE3d()}, {0.1, turned}, {5.0, SE3d(turned.rotation(), {9.0, 0.0, 0.0})}};
  const ReferencePath path(poses);
  EXPECT_FALSE(path.at(-1.0));
  EXPECT_FALSE(path.at(3.0));
  EXPECT_FALSE(path.at(6.0));
  EXPECT_TRUE(path.at(0.1)->is_approx(turned, 1e-12));
  EXPECT_TRUE(path.at(5.0 + 1e-7).has_value());
  const SE3d quarter(SO3d::exp({0.0, 0.0, 0.25}), {0.25, 0.0, 0.0});
  EXPECT_TRUE(path.at(0.025)->is_approx(quarter, 1e-12));
  EXPECT_FALSE(ReferencePath().at(0.0));
}

TEST(FiducialsScore, APathInAnotherFrameHasNoError) {
  const TagRecording recording;
  std::vector<StampedPose> moved = recording.path;
  const SE3d other(SO3d::exp({1.0, 2.0, 0.5}), {3.0, 2.0, 1.0});
  for (StampedPose& pose : moved) pose.pose = other.inverse() * *pose.pose;
  const auto score = score_path(moved, ReferencePath(recording.path), PathAlignment::rigid);
  ASSERT_TRUE(score);
  EXPECT_LT(score->max_m, 1e-12);
  EXPECT_TRUE(score->alignment.is_approx(other, 1e-9));
  const auto direct = score_path(moved, ReferencePath(recording.path), PathAlignment::none);
  EXPECT_GT(direct->rms_m, 1.0);
  EXPECT_FALSE(
      score_path(std::span(moved).first(2), ReferencePath(recording.path), PathAlignment::rigid));
}

TEST(FiducialsScore, ReferenceTagsDoNotFollowTheWeights) {
  const TagRecording recording;
  const ReferenceTags tags =
      reference_tags(recording.observations, recording.cameras, ReferencePath(recording.path));
  ASSERT_EQ(tags.size(), recording.tags.size());
  for (const auto& [name, tag] : tags) {
    EXPECT_LT(angle_between_deg(tag.pose, recording.tags.at(name)), 0.3) << name;
    EXPECT_EQ(tag.sightings, 80U);
    EXPECT_EQ(tag.share, 1.0);
  }
}

TEST(FiducialsScore, ASpanIsTheLargestAngleOfTwoViews) {
  // Cameras at one metre, at 0, 10 and 40 degrees, that look at a tag at the origin.
  std::vector<Observation> observations;
  std::vector<StampedPose> path;
  for (const double deg : {0.0, 40.0, 10.0}) {
    const SE3d map_rig =
        SE3d(SO3d::exp({0.0, deg * std::numbers::pi / 180.0, 0.0}), Eigen::Vector3d::Zero()) *
        SE3d(SO3d(), {0.0, 0.0, -1.0});
    Observation observation = observation_of(map_rig.inverse());
    observation.object = "7";
    observation.stamp_s = static_cast<double>(path.size());
    observations.push_back(observation);
    path.push_back({observation.stamp_s, map_rig});
  }
  const ReferenceTags tags = reference_tags(observations, {{"", SE3d()}}, ReferencePath(path));
  EXPECT_NEAR(tags.at("7").span_deg, 40.0, 1e-6);
  EXPECT_TRUE(reference_tags(observations, {}, ReferencePath(path)).empty());
}

// The numbers are those of score_path, reference_tags and wrong_modes of
// bench/python/fiducials_score.py on the same poses, which are formulas without random numbers.
TEST(FiducialsScore, IsThatOfThePythonProgram) {
  const TagRecording recording;
  const ReferencePath reference = reference_of(recording);
  const auto path = score_path(wavering_path(recording), reference, PathAlignment::rigid);
  ASSERT_TRUE(path);
  EXPECT_EQ(path->distances_m.size(), 39U);
  EXPECT_NEAR(path->rms_m, 0.010298351187375002, 1e-12);
  EXPECT_NEAR(path->max_m, 0.01724591795549612, 1e-12);

  const ReferenceTags tags = reference_tags(recording.observations, recording.cameras, reference);
  const std::map<std::string, Eigen::Vector3d> places{
      {"0", {-1.9999010768112098, -0.6003708435362434, 2.999675786880224}},
      {"1", {-0.9996740615850317, -0.30010515356028683, 2.999772544918371}},
      {"2", {3.536418594352053e-07, -0.0002408440525809158, 2.9999286078688594}},
      {"3", {0.9998089542423432, 0.2998329543359534, 3.0002459470029033}},
      {"4", {2.0000417491090556, 0.6000800158710347, 3.0003818833223748}}};
  const std::map<std::string, double> turns_deg{{"0", 0.014241584997825385},
                                                {"1", 0.039039769623691725},
                                                {"2", 0.017955587850125094},
                                                {"3", 0.014446823508047862},
                                                {"4", 0.007519065156999886}};
  const std::map<std::string, double> rivals{
      {"0", 30.0 / 78}, {"1", 30.0 / 78}, {"2", 30.0 / 78}, {"3", 32.0 / 78}, {"4", 38.0 / 78}};
  ASSERT_EQ(tags.size(), places.size());
  for (const auto& [name, tag] : tags) {
    EXPECT_LT((tag.pose.translation() - places.at(name)).norm(), 1e-12) << name;
    EXPECT_NEAR(angle_between_deg(tag.pose, recording.tags.at(name)), turns_deg.at(name), 1e-9);
    EXPECT_EQ(tag.sightings, 78U);
    EXPECT_EQ(tag.share, 1.0);
    EXPECT_NEAR(tag.rival_share, rivals.at(name), 1e-12) << name;
  }
  const ModeScore modes =
      score_modes(best_sightings(recording.observations), recording.cameras, tags, reference);
  EXPECT_EQ(modes.sightings, 390U);
  EXPECT_EQ(modes.wrong, 128U);
  EXPECT_EQ(modes.frames, 39U);
  EXPECT_EQ(modes.wrong_frames, 39U);
  for (const auto& [name, tag] : modes.tags) {
    EXPECT_EQ(tag.sightings, 78U);
    EXPECT_EQ(tag.wrong, name == "1" ? 24U : 26U);
    EXPECT_EQ(tag.wrong_at_last, name == "2");
  }
}

TEST(FiducialsScore, CountsWrongModesBySightingFrameAndTag) {
  const TagRecording recording;
  ReferenceTags tags;
  for (const auto& [name, pose] : recording.tags) tags[name].pose = pose;
  const ReferencePath reference(recording.path);
  std::vector<TagSighting> sightings;
  for (const Observation& observation : recording.observations) {
    const bool wrong = observation.object == "3" && observation.stamp_s < 0.51;  // eleven frames
    sightings.push_back({observation.stamp_s, observation.camera, observation.object,
                         observation.components[wrong ? 1 : 0].pose});
  }
  const ModeScore score = score_modes(sightings, recording.cameras, tags, reference);
  EXPECT_EQ(score.sightings, 400U);
  EXPECT_EQ(score.frames, 40U);
  EXPECT_EQ(score.wrong, 22U);
  EXPECT_EQ(score.wrong_frames, 11U);
  EXPECT_EQ(score.tags.at("3").wrong, 22U);
  EXPECT_FALSE(score.tags.at("3").wrong_at_last);
  std::erase_if(sightings, [](const TagSighting& sighting) { return sighting.stamp_s > 0.51; });
  const ModeScore early = score_modes(sightings, recording.cameras, tags, reference);
  EXPECT_TRUE(early.tags.at("3").wrong_at_last);
  EXPECT_FALSE(early.tags.at("2").wrong_at_last);
}

}  // namespace
}  // namespace posemix
