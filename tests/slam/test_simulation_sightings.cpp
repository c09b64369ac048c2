// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "simulation_samples.hpp"

/// What simulated cameras see: the view, classes, false detections.
namespace posemix {
namespace {

using namespace testing;  // NOLINT(google-build-using-namespace)

bool is_in_image(const Vector3d& point, const SimulationView& view) {
  const double x = view.focal_length_px * point.x() / point.z();
  const double y = view.focal_length_px * point.y() / point.z();
  return point.z() >= view.least_range_m && point.z() <= view.largest_range_m &&
         std::abs(x) <= static_cast<double>(view.width_px) / 2 &&
         std::abs(y) <= static_cast<double>(view.height_px) / 2;
}

SimulationObject cup(const std::string& id) {
  SimulationObject object = object_with({{1.0, small_sd()}}, id);
  object.class_id = "cup";
  return object;
}

TEST(SimulationSightings, ObjectsOutsideOfTheImageAreNotDetected) {
  SimulationConfig config = config_with({object_with({{1.0, small_sd()}})}, 600);
  config.objects[0].position_m = Vector3d(0.2, 0.2, 0.0);
  const SimulatedSequence all = simulate(config, 1);
  config.path.view = SimulationView{.focal_length_px = 800, .largest_range_m = 1.05};
  const SimulatedSequence seen = simulate(config, 1);
  std::size_t count = 0;
  for (std::size_t k = 0; k < 600; ++k) {
    const auto& object = seen.objects[0];
    const bool inside =
        is_in_image(object.relative_truth[k].pose().translation(), *config.path.view);
    ASSERT_EQ(object.detections[k].has_value(), inside) << k;
    // What is seen is what was seen without an image.
    if (inside) {
      EXPECT_EQ(object.detections[k]->billionths, all.objects[0].detections[k]->billionths);
      ++count;
    }
  }
  EXPECT_GT(count, 100U);
  EXPECT_LT(count, 500U);
}

TEST(SimulationSightings, ObjectsComeAndGoAtTheirTimes) {
  SimulationObject object = object_with({{1.0, small_sd()}});
  object.appears_s = 1.0;
  object.removed_s = 3.0;
  const SimulatedSequence simulated = simulate(config_with({object}, 50), 1);
  const ObjectRecording recording = simulated.sequence().objects[0];
  for (std::size_t k = 0; k < 50; ++k) {
    const bool there = k >= 10 && k < 30;
    EXPECT_EQ(recording.detections[k].has_value(), there) << k;
    EXPECT_EQ(recording.world_truth[k].has_value(), there) << k;
    EXPECT_EQ(recording.relative_truth[k].has_value(), there) << k;
  }
}

TEST(SimulationSightings, DetectionsOfAClassDoNotTellTheObject) {
  SimulationConfig config =
      config_with({cup("a"), cup("b"), object_with({{1.0, small_sd()}})}, 400);
  config.objects[1].position_m = Vector3d(-0.2, 0.1, 0.05);
  config.objects[1].misses.fraction = 0.5;
  const SimulatedSequence simulated = simulate(config, 2);
  const Sequence sequence = simulated.sequence();
  std::size_t first = 0;
  std::size_t both = 0;
  for (std::size_t k = 0; k < 400; ++k) {
    std::vector<std::size_t> sources;
    for (std::size_t i = 0; i < simulated.sightings[k].size(); ++i) {
      const SimulatedSighting& sighting = simulated.sightings[k][i];
      const Observation& observation = sequence.observations[k][i];
      EXPECT_EQ(observation.object, sighting.object);
      EXPECT_EQ(observation.class_id, sighting.class_id);
      EXPECT_EQ(observation.stamp_s, sequence.stamps[k]);
      ASSERT_TRUE(sighting.source.has_value());
      const SimulatedObject& source = simulated.objects[*sighting.source];
      EXPECT_EQ(source.detections[k]->billionths, sighting.pose.billionths);
      EXPECT_EQ(sighting.class_id, *sighting.source == 2 ? "" : "cup");
      EXPECT_EQ(sighting.object, *sighting.source == 2 ? "mug" : "");
      if (*sighting.source != 2) sources.push_back(*sighting.source);
    }
    if (sources.size() == 2) {
      ++both;
      first += sources[0] == 0 ? 1 : 0;
    }
    EXPECT_FALSE(sequence.objects[0].detections[k].has_value());
    EXPECT_TRUE(sequence.objects[2].detections[k].has_value());
  }
  EXPECT_TRUE(sequence.objects[0].world_truth.empty());
  EXPECT_EQ(sequence.objects[2].world_truth.size(), 400U);
  // The camera goes around both: each comes first in half of the images.
  EXPECT_NEAR(static_cast<double>(first) / static_cast<double>(both), 0.5, 0.2);
}

TEST(SimulationSightings, FalseDetectionsHaveTheirRateAndAreAnywhereInTheView) {
  SimulationConfig config = config_with({cup("a")}, 10'000);
  config.path.view = SimulationView{.least_range_m = 0.5, .largest_range_m = 1.5};
  config.clutter = {{.class_id = "cup", .rate_per_image = 0.4}};
  const SimulatedSequence simulated = simulate(config, 3);
  double count = 0.0;
  double none = 0.0;
  Vector3d pixels = Vector3d::Zero();
  double cubes = 0.0;
  Eigen::Vector4d squares = Eigen::Vector4d::Zero();
  for (const auto& frame : simulated.sightings) {
    double here = 0.0;
    for (const SimulatedSighting& sighting : frame) {
      if (sighting.source) continue;
      ++here;
      EXPECT_EQ(sighting.class_id, "cup");
      const SE3d pose = sighting.pose.pose();
      const Vector3d point = pose.translation();
      EXPECT_TRUE(is_in_image(point, *config.path.view));
      pixels += point / point.z();
      cubes += (std::pow(point.z(), 3) - 0.125) / (3.375 - 0.125);
      squares += pose.rotation().quaternion().coeffs().cwiseAbs2();
    }
    count += here;
    none += here == 0.0 ? 1.0 : 0.0;
  }
  EXPECT_NEAR(count, 4000.0, kBound * std::sqrt(4000.0));
  const double p = std::exp(-0.4);
  EXPECT_NEAR(none, 1e4 * p, kBound * std::sqrt(1e4 * p * (1 - p)));
  // Uniform over pixels and the cube of the range, and over all rotations.
  EXPECT_NEAR(pixels.x() / count, 0.0, kBound * (640.0 / 600.0) / std::sqrt(12.0 * count));
  EXPECT_NEAR(pixels.y() / count, 0.0, kBound * (480.0 / 600.0) / std::sqrt(12.0 * count));
  EXPECT_NEAR(cubes / count, 0.5, kBound / std::sqrt(12.0 * count));
  for (const double square : squares)
    EXPECT_NEAR(square / count, 0.25, kBound * std::sqrt(1.0 / 16.0 / count));
}

TEST(SimulationSightings, RecurringPlacesHaveRunsOfTheirOwn) {
  SimulationConfig config = config_with({cup("a")}, 20'000);
  config.clutter = {{.class_id = "cup",
                     .places = {{{0.2, 0.2, 0.05}, {0, 0, 1}}, {{-0.2, 0.2, 0.05}, {0, 0, 0}}},
                     .runs = {0.2, 1.0},
                     .sd = small_sd()}};
  const SimulatedSequence simulated = simulate(config, 4);
  std::array<double, 2> on{};
  std::array<double, 2> runs{};
  std::array<bool, 2> before{};
  SampleMoments moments(6);
  for (std::size_t k = 0; k < simulated.sightings.size(); ++k) {
    std::array<bool, 2> now{};
    for (const SimulatedSighting& sighting : simulated.sightings[k]) {
      if (sighting.source) continue;
      const SE3d world = simulated.camera_truth[k].pose() * sighting.pose.pose();
      const std::size_t place = world.translation().x() > 0.0 ? 0 : 1;
      now[place] = true;
      if (place == 1)
        moments.add((SE3d(SO3d(), Vector3d(-0.2, 0.2, 0.05)).inverse() * world).log());
    }
    for (std::size_t i = 0; i < 2; ++i) {
      on[i] += now[i] ? 1.0 : 0.0;
      runs[i] += now[i] && !before[i] ? 1.0 : 0.0;
    }
    before = now;
  }
  for (std::size_t i = 0; i < 2; ++i) {
    // Ten frames to a run on average, so that 20,000 frames hold about 400.
    EXPECT_NEAR(on[i] / 20'000.0, 0.2, kBound * 0.4 * std::sqrt(20.0 / 20'000.0));
    EXPECT_NEAR(on[i] / runs[i], 10.0, kBound * 10.0 / std::sqrt(runs[i]));
  }
  EXPECT_LT(moments.worst_score(Vector6d::Zero(), covariance_of(small_sd())), kBound);
}

TEST(SimulationSightings, ClutterChangesNoDetectionOfAnObject) {
  SimulationConfig config = config_with({cup("a"), cup("b")}, 50);
  config.path.view = SimulationView{};
  const SimulatedSequence without = simulate(config, 5);
  config.clutter = {{.class_id = "cup", .rate_per_image = 2.0}};
  const SimulatedSequence with = simulate(config, 5);
  for (std::size_t i = 0; i < 2; ++i) {
    for (std::size_t k = 0; k < 50; ++k) {
      const auto& a = without.objects[i].detections[k];
      const auto& b = with.objects[i].detections[k];
      ASSERT_EQ(a.has_value(), b.has_value());
      if (!a) continue;
      EXPECT_EQ(a->billionths, b->billionths);
    }
  }
  EXPECT_EQ(simulate(config, 5).sightings[7].size(), with.sightings[7].size());
}

TEST(SimulationSightings, ClutterNeedsAnImageAndAnObject) {
  const auto message = [](const SimulationClutter& clutter) -> std::string {
    try {
      SimulationConfig config = config_with({cup("a"), object_with({{1.0, small_sd()}})}, 5);
      config.clutter = {clutter};
      simulate(config, 1);
    } catch (const InvalidInput& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(message({.class_id = "cup", .rate_per_image = 1.0}).find("no view"), std::string::npos);
  EXPECT_NE(message({.class_id = "mug", .places = {{}}}).find("no object has that class"),
            std::string::npos);
  EXPECT_NE(message({.object = "a", .places = {{}}}).find("no detections name that object"),
            std::string::npos);
  EXPECT_NE(message({.places = {{}}}).find("expected a class or an object"), std::string::npos);
  EXPECT_NE(message({.class_id = "cup"}).find("neither a rate nor a place"), std::string::npos);
  EXPECT_EQ(message({.object = "mug", .places = {{}}}), "");
}

TEST(SimulationSightings, ObjectsOfAClassMustBeAlike) {
  SimulationConfig config = config_with({cup("a"), cup("b")}, 5);
  config.objects[1].flips.runs.fraction = 0.1;
  EXPECT_THROW(simulate(config, 1), InvalidInput);
}

}  // namespace
}  // namespace posemix
