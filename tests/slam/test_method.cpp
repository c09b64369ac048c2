// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>

#include <set>

#include "filter/scenario.hpp"
#include "posemix/slam/job.hpp"
#include "posemix/testing/expect.hpp"

namespace posemix {
namespace {

using testing::heavy_tailed_noise;
using testing::isotropic;
using testing::pose;
using testing::thrown_message;

const GaussianSumSettings& gaussian_sum(const SlamMethod& method) {
  return std::get<GaussianSumSettings>(method.tracker);
}

TEST(SlamMethods, AreFoundByTheirNames) {
  std::set<std::string> names;
  for (const SlamMethod& method : slam_methods()) {
    EXPECT_TRUE(names.insert(method.name).second) << method.name;
    EXPECT_FALSE(method.description.empty());
    EXPECT_EQ(&find_slam_method(method.name), &method);
  }
  EXPECT_EQ(names,
            (std::set<std::string>{"multi_object", "smoothed", "fixed_lag", "gm-iekf",
                                   "tangent_of_larger", "midway", "midway_iterated", "published",
                                   "riekf", "riekf_gated", "riekf_cauchy", "max_mixture", "rbpf"}));
  EXPECT_EQ(thrown_message([] {
              find_slam_method("ekf");
            }).find("method 'ekf', expected one of: multi_object, smoothed"),
            0U);
}

TEST(SlamMethods, TitlesNameTheChosenSettings) {
  const auto title = [](const char* name) { return find_slam_method(name).title(); };
  EXPECT_EQ(title("multi_object"), "multi-object");
  EXPECT_EQ(title("smoothed"), "multi-object, smoothed");
  EXPECT_EQ(title("fixed_lag"), "multi-object, smoothed by 20 frames");
  EXPECT_EQ(title("gm-iekf"), "gm-iekf (midway, iterated)");
  EXPECT_EQ(title("tangent_of_larger"), "tangent_of_larger");
  EXPECT_EQ(title("midway_iterated"), "midway_iterated");
  EXPECT_EQ(title("riekf"), "riekf");
  EXPECT_EQ(title("riekf_gated"), "riekf (gate 0.999)");
  EXPECT_EQ(title("riekf_cauchy"), "riekf (Cauchy, c = 2.862)");
  EXPECT_EQ(title("max_mixture"), "max-mixture");
  EXPECT_EQ(title("rbpf"), "rbpf (300 particles)");
  SlamMethod changed = find_slam_method("midway");
  std::get<GaussianSumSettings>(changed.tracker).reduction.merge.rule = MergeRule::moment_matched;
  EXPECT_EQ(changed.title(), "midway (moment matched)");
  const SlamMethod own{.name = "own", .description = "", .tracker = GaussianSumSettings{}};
  EXPECT_EQ(own.title(), "own (midway, iterated)");
  std::set<std::string> titles;
  for (const SlamMethod& method : slam_methods())
    EXPECT_TRUE(titles.insert(method.title()).second) << method.title();
}

TEST(SlamMethods, ThePapersFilterIsThatOfAlgorithm1) {
  const GaussianSumSettings& paper = gaussian_sum(find_slam_method("midway"));
  EXPECT_EQ(paper.noise_use, NoiseUse::joint);
  EXPECT_EQ(paper.update, UpdateRule::linearized);
  EXPECT_EQ(paper.summary, Summary::merge_two_largest);
  EXPECT_EQ(paper.reduction.max_components, 12U);
  EXPECT_EQ(paper.reduction.pair, PairRule::largest_with_smallest);
  EXPECT_EQ(paper.reduction.merge.rule, MergeRule::midway);
  EXPECT_EQ(gaussian_sum(find_slam_method("midway_iterated")).update, UpdateRule::iterated);
  // The authors' program, as docs/studies.md has it.
  const GaussianSumSettings& published = gaussian_sum(find_slam_method("published"));
  EXPECT_EQ(published.reduction.merge_from, 16U);
  EXPECT_EQ(published.reduction.merge.jacobian, TransportJacobian::bernoulli);
  EXPECT_EQ(published.reduction.max_components, 12U);
  EXPECT_EQ(published.reduction.prune_below, 5e-6);
}

TEST(SlamMethods, RestoreKeepsABaselineWhatItIs) {
  SlamMethod method = find_slam_method("max_mixture");
  GaussianSumSettings changed = gaussian_sum(method);
  changed.reduction.max_components = 9;
  changed.noise_use = NoiseUse::joint;
  changed.gate_probability = 0.5;
  method.restore(changed);
  EXPECT_EQ(changed.reduction.max_components, 1U);
  EXPECT_EQ(changed.noise_use, NoiseUse::most_likely);
  EXPECT_EQ(changed.gate_probability, 0.5);
}

TEST(SlamMethods, OneThatLooksAheadIsLiveOnlyAsASmoother) {
  const PoseDensity camera(SE3d(), isotropic(0.1, 1e-3));
  const std::vector<ObjectModel> models{{"mug", heavy_tailed_noise()}};
  EXPECT_EQ(thrown_message([&] { return find_slam_method("smoothed").live(camera, models); }),
            "method 'smoothed' looks ahead, which ObjectSlam does not; expected a "
            "FixedLagSmoother");
  EXPECT_EQ(thrown_message([&] { return find_slam_method("riekf").smoother(camera, models); }),
            "method 'riekf' does not look ahead, as a FixedLagSmoother does; expected an "
            "ObjectSlam");
  const FrameInput input{.detections = {pose(0.3, 0.2, 0.1, 0.0, 0.1, 0.8)}};
  ObjectSlam live = find_slam_method("riekf").live(camera, models);
  EXPECT_EQ(live.objects()[0].noise.components().size(), 1U);
  EXPECT_EQ(live.step(input).report.statuses[0], DetectionStatus::started);
  FixedLagSmoother smoother = find_slam_method("fixed_lag").smoother(camera, models);
  EXPECT_FALSE(smoother.step(input).has_value());
  EXPECT_EQ(smoother.finish().size(), 1U);
}

TEST(SlamMethods, AJobRunsByTheMethodThatItUses) {
  Sequence sequence;
  sequence.stamps = {0.0, 0.1, 0.2};
  const SE3d seen = pose(0.3, 0.2, 0.1, 0.0, 0.1, 0.8);
  sequence.objects = {{"mug", {seen, seen, seen}, {}, {}}};
  SlamJob job{.name = "three frames",
              .method = {},
              .sequence = sequence,
              .camera_prior = PoseDensity(SE3d(), isotropic(0.1, 1e-3)),
              .models = {{"mug", heavy_tailed_noise()}},
              .settings = {}};
  job.use(find_slam_method("riekf"));
  EXPECT_EQ(job.method, "riekf");
  EXPECT_EQ(job.models[0].noise.components().size(), 1U);
  EXPECT_EQ(run(job).posterior.size(), 1U);
  job.use(find_slam_method("smoothed"));
  const SlamRun smoothed = run(job);
  const SlamRun direct =
      run_smoothed(job.sequence, job.camera_prior, job.models, job.settings, *job.smoothing);
  EXPECT_EQ(smoothed.frames[0].camera.covariance(), direct.frames[0].camera.covariance());
  job.use(find_slam_method("rbpf"));
  EXPECT_FALSE(job.smoothing.has_value());
  EXPECT_EQ(run(job).posterior.size(), 32U);
}

}  // namespace
}  // namespace posemix
