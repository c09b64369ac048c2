// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
//
// What calls with bad arguments were refused for first (test_arguments.cpp), by their messages: a
// read beyond memory would go unnoticed without a sanitizer.
#include <gtest/gtest.h>

#include "posemix/testing/expect.hpp"
#include "recordings.hpp"

namespace posemix::arguments {
namespace {

using posemix::testing::thrown_message;

TEST(Refusals, IndicesThatNothingHas) {
  const auto mixture = fine<Mixture<ConcentratedGaussian<SE3d>>>();
  EXPECT_EQ(thrown_message([&] { mixture[2]; }), "there is no component 2; there are 2");
  EXPECT_EQ(thrown_message([&] { mixture.weight(2); }), "there is no component 2; there are 2");
  PoseStackd stack(2);
  EXPECT_EQ(thrown_message([&] { stack[2]; }), "there is no pose 2; there are 2");
  EXPECT_EQ(thrown_message([&] { std::as_const(stack)[2]; }), "there is no pose 2; there are 2");
  const TrackedObjects objects = good<TrackedObjects>();
  EXPECT_EQ(thrown_message([&] { objects[2]; }), "there is no object 2; there are 2");
  const MovingObjects moving = MovingObjects({}, {"gripper"});
  EXPECT_EQ(thrown_message([&] { moving.may_hold(1); }), "there is no frame 1; there are 1");
  MovingObjects moved = moving;
  EXPECT_EQ(thrown_message([&] { moved.update(0, good<Observation>(), good<KnownCamera>()); }),
            "object 0 does not move, it has no track of its own");
  EXPECT_EQ(thrown_message([&] { moved.forget(0); }),
            "object 0 does not move, it has no track of its own");
  const SimulatedObject simulated = good<SimulatedSequence>().objects[0];
  EXPECT_TRUE(simulated.is_present(77));  // it always is, and stands still
  SimulatedObject appears = simulated;
  appears.present = {false, true};
  EXPECT_EQ(thrown_message([&] { appears.is_present(2); }), "there is no frame 2; there are 2");
  appears.world_path = {simulated.world_truth};
  EXPECT_EQ(thrown_message([&] { appears.world_at(1); }), "there is no frame 1; there are 1");
  const Sequence sequence = good<Sequence>();
  EXPECT_EQ(thrown_message([&] { true_relative_pose(sequence, 1, 0); }),
            "there is no object 1; there are 1");
  EXPECT_EQ(thrown_message([&] { true_world_pose(sequence, 0, 3); }),
            "there is no frame 3; there are 3");
}

TEST(Refusals, IndicesOfTracks) {
  InstanceTracks tracks = good<InstanceTracks>();
  const std::string message = "there is no object 2; there are 2";
  EXPECT_EQ(thrown_message([&] { tracks.forget(2); }), message);
  EXPECT_EQ(thrown_message([&] { tracks.detected(2, {}); }), message);
  EXPECT_EQ(thrown_message([&] { tracks.detections(2); }), message);
  EXPECT_EQ(thrown_message([&] { tracks.last_frame(2); }), message);
  EXPECT_EQ(thrown_message([&] { tracks.counts(2); }), message);
  EXPECT_EQ(thrown_message([&] { tracks.existence(2); }), message);
  EXPECT_EQ(thrown_message([&] { tracks.is_confirmed(2); }), message);
  EXPECT_EQ(thrown_message([&] { tracks.gives_way(2); }), message);
  EXPECT_EQ(thrown_message([&] { tracks.is_deleted(2); }), message);
  EXPECT_EQ(thrown_message([&] { tracks.health(2, 1.0); }), message);
  EXPECT_EQ(thrown_message([&] { tracks.should_register(2); }), message);
  EXPECT_EQ(thrown_message([&] { tracks.end(std::vector<TrackedPlace>(1)); }),
            "1 places for 2 objects");
  tracks.begin(0.1);
  tracks.detected(0, {.camera = "left", .detector = "dope"});
  EXPECT_EQ(thrown_message([&] { tracks.end(std::vector<TrackedPlace>(2)); }),
            "an object was detected in an image of camera 'left' by detector 'dope', which did not "
            "look");
}

TEST(Refusals, AHypothesisWithoutThePose) {
  const Hypothesis prior = fine<Hypothesis>();
  const Detection detection{2, fine<SE3d>(), fine<Detection>().noise};
  const auto noise = fine<std::vector<const NoiseComponent*>>();
  const auto detections = std::span(&detection, 1);
  const std::string message = "there is no pose 2; there are 2";
  EXPECT_EQ(thrown_message([&] { update(prior, detections, noise); }), message);
  EXPECT_EQ(thrown_message([&] { iterated_update(prior, detections, noise); }), message);
  EXPECT_EQ(thrown_message([&] { innovation(prior.mean(), detection, *noise[0]); }), message);
}

TEST(Refusals, SizesThatDoNotFit) {
  const CameraModel camera{.distortion = DistortionModel::radtan};
  const std::string coefficients =
      "got 0 coefficients of the distortion, expected 4 or 5 (k1 k2 p1 p2 k3) for radtan";
  EXPECT_EQ(thrown_message([&] { project(camera, {0.0, 0.0, 1.0}); }), coefficients);
  EXPECT_EQ(thrown_message([&] { ray(camera, {0.0, 0.0}); }), coefficients);
  const LogisticModel model{Eigen::VectorXd::Ones(2), 0.0};
  EXPECT_EQ(thrown_message([&] { model.probability(Eigen::VectorXd::Ones(3)); }),
            "3 features for a model of 2");
  const PoseConsensus consensus{fine<std::vector<SE3d>>(), Eigen::VectorXd::Ones(2)};
  EXPECT_EQ(thrown_message([&] { consensus.resampled(2); }),
            "a consensus of 3 draws with 2 weights");
  const ObservedPart part{Eigen::VectorXd::Ones(3), Eigen::MatrixXd::Identity(2, 2)};
  EXPECT_EQ(thrown_message([&] { part.whitened(); }),
            "the covariance of an error of 3 entries is 2 x 2");
  EmSettings em;
  em.unit = Eigen::VectorXd::Ones(5);
  EXPECT_EQ(thrown_message([&] { bounded_covariance(Matrix6d::Identity(), em); }),
            "EM: size of unit is 5, expected the degrees of freedom");
  const std::vector<Assignment> uneven{{{0, 1}, 0.0}, {{0}, 0.0}};
  EXPECT_EQ(thrown_message([&] { association_probabilities(uneven, 2); }),
            "assignments are not of as many rows, expected the same");
}

TEST(Refusals, RunsAndRecordingsThatDoNotBelongTogether) {
  const SlamJob job = good<SlamJob>();
  const SlamRun run = good<SlamRun>();
  const Metrics metrics = good<Metrics>();
  SlamRun bare = run;
  bare.frames[1].register_again.clear();
  EXPECT_EQ(thrown_message([&] { format_trace(job, bare); }),
            "the run has 0 entries of register_again, expected 1");
  EXPECT_EQ(thrown_message([&] { format_picture(job, run, {}); }),
            "there are metrics of 0 objects, expected 1");
  SlamJob two = job;
  two.models = fine<std::vector<ObjectModel>>();
  EXPECT_EQ(thrown_message([&] { format_results(two, run, metrics); }),
            "there are 2 models of 1 objects");
  Sequence cut = job.sequence;
  cut.objects[0].detections.pop_back();
  EXPECT_EQ(thrown_message([&] { observations_of(cut); }),
            "object 'cup' has 2 detection entries for 3 frames");
  SimulatedSequence simulated = good<SimulatedSequence>();
  simulated.odometry.pop_back();
  EXPECT_EQ(thrown_message([&] { simulated.sequence(); }),
            "simulated recording: odometry has 1 entries for 2 stamps");
  FrameEstimate estimate = run.frames[0];
  estimate.relative.clear();
  EXPECT_EQ(thrown_message([&] { estimate.object("cup"); }), "there is no object 0; there are 0");
}

TEST(Refusals, CountsAndSteps) {
  const auto density = fine<ConcentratedGaussian<SE3d>>();
  RandomStream stream(1);
  EXPECT_EQ(thrown_message([&] { samples(density, std::size_t{1} << 60U, stream); }),
            "count is 1152921504606846976, expected at most 1000000000000");
  EXPECT_EQ(thrown_message([&] {
              quantile({1.0, 2.0}, kNaN);
            }),
            "p is nan, expected a number in [0, 1]");
  const RotationDensity peak = good<RotationDensity>();
  EXPECT_EQ(thrown_message([&] { paper_grid_divergence(peak, peak, 1e-310); }),
            "step is 1e-310, expected a number in [0.001, 3.141592653589793]");
  EXPECT_TRUE(cross_validate(fine<std::vector<NoiseTrack>>(), {.folds = 0}, stream).empty());
  EXPECT_EQ(thrown_message([&] {
              format_comparison({"", "a"});
            }),
            "'' is no path: Invalid argument");
}

}  // namespace
}  // namespace posemix::arguments
