// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/relocalise.hpp"

#include <limits>
#include <numbers>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "posemix/slam/state.hpp"
#include "posemix/testing/expect.hpp"
#include "relocalise_scene.hpp"

namespace posemix {
namespace {

using namespace testing::relocalise;  // NOLINT(google-build-using-namespace)
using testing::isotropic;
using testing::nees_of;
using testing::pose;
using testing::thrown_message;

TEST(Relocalise, ThePoseIsAsStated) {
  double nees = 0.0;
  double relocated = 0.0;
  constexpr int kRuns = 120;
  for (std::uint64_t seed = 0; seed < kRuns; ++seed) {
    const MultiObjectSlam before = old_map(seed);
    const MultiObjectSlam now = run(seed + 100, kNewOld, kTable, {"mug", "box", "can", "tin"});
    const Relocalisation result = relocalise(before, now);
    ASSERT_EQ(result.outcome, RelocaliseOutcome::found) << "seed " << seed;
    EXPECT_EQ(result.shared, 4U);
    EXPECT_GE(result.agreed.size(), 3U);
    EXPECT_GT(result.probability, 0.95);
    // Both worlds are where their cameras are taken to be, which is an error of both.
    nees += nees_of(kNewOld, *result.new_old) / 6.0;
    // The jar, which the new run never saw, before the mug that it did see.
    for (const RelocatedObject& object : result.objects) {
      if (object.object != "jar") continue;
      EXPECT_FALSE(object.is_agreed);
      EXPECT_GT(object.probability, 0.5);
      relocated += nees_of(kNewOld * kTable.at("jar"), object.world) / 6.0;
    }
  }
  // Chi-square over the runs of six degrees of freedom: a standard deviation of 0.05.
  RecordProperty("nees", fmt::format("{:.3f} {:.3f}", nees / kRuns, relocated / kRuns));
  EXPECT_GT(nees / kRuns, 0.8);
  EXPECT_LT(nees / kRuns, 1.25);
  EXPECT_GT(relocated / kRuns, 0.8);
  EXPECT_LT(relocated / kRuns, 1.25);
}

TEST(Relocalise, AnObjectThatWasMovedIsLeftOut) {
  Places moved = kTable;
  moved["box"] = SE3d(SO3d(), {0.15, -0.1, 0.05}) * kTable.at("box");
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const MultiObjectSlam before = old_map(seed);
    const MultiObjectSlam now = run(seed + 100, kNewOld, moved, {"mug", "box", "tin", "jar"});
    const Relocalisation result = relocalise(before, now);
    ASSERT_EQ(result.outcome, RelocaliseOutcome::found);
    ASSERT_EQ(result.disagreeing.size(), 1U);
    EXPECT_EQ(result.disagreeing[0], "box");
    EXPECT_LT(nees_of(kNewOld, *result.new_old), 22.5);  // 0.999 of its distribution
    for (const RelocatedObject& object : result.objects) EXPECT_NE(object.object, "box");
  }
}

TEST(Relocalise, AnObjectThatMayBeOneThatWasMovedIsLeftOut) {
  // The cup of the old map has another name in the new run, where it is elsewhere.
  const auto cup = [](const char* id) {
    return ObjectModel{.id = id, .noise = testing::gaussian_noise(2.0, 0.01), .class_id = "cup"};
  };
  std::vector<ObjectModel> all = models();
  all.push_back(cup("cup"));
  all.push_back(cup("cup-1"));
  Places places = kTable;
  places["cup"] = pose(0.2, 0.0, 0.0, 0.2, 0.2, 1.0);
  places["cup-1"] = pose(0.2, 0.0, 0.0, 0.9, -0.6, 1.0);
  const MultiObjectSlam before = run(1, SE3d(), places, {"mug", "box", "tin", "cup"}, all);
  const Relocalisation result =
      relocalise(before, run(2, kNewOld, places, {"mug", "box", "tin", "cup-1"}, all));
  ASSERT_EQ(result.outcome, RelocaliseOutcome::found);
  EXPECT_EQ(result.disagreeing, std::vector<std::string>{"cup-1"});
  for (const RelocatedObject& object : result.objects) EXPECT_NE(object.object, "cup");
}

TEST(Relocalise, AFlipInOneOfTheMapsIsFound) {
  // The new run was flipped more often than not: its leading hypothesis of the mug is the wrong
  // one, and the others tell.
  const MultiObjectSlam before = old_map(3);
  const MultiObjectSlam now = run(103, kNewOld, kTable, {"mug", "box", "jar"}, models(), 0.8);
  const Relocalisation result = relocalise(before, now);
  ASSERT_EQ(result.outcome, RelocaliseOutcome::found);
  EXPECT_LT(nees_of(kNewOld, *result.new_old), 22.5);
}

TEST(Relocalise, TooFewObjectsAreRefused) {
  const MultiObjectSlam before = old_map(1);
  const Relocalisation none = relocalise(before, run(2, kNewOld, kTable, {"box"}));
  EXPECT_EQ(none.outcome, RelocaliseOutcome::too_few_shared);
  EXPECT_EQ(none.shared, 1U);
  EXPECT_FALSE(none.new_old);
  EXPECT_EQ(thrown_message([&] { models_with_priors(before, none); }),
            "the relocalisation is too_few_shared, expected found");
  // Both were put elsewhere.
  Places moved = kTable;
  moved["box"] = pose(0.0, 0.0, 2.0, 0.4, 0.4, 0.7);
  const Relocalisation apart = relocalise(before, run(2, kNewOld, moved, {"box", "jar"}));
  EXPECT_EQ(apart.outcome, RelocaliseOutcome::too_few_agree);
  EXPECT_EQ(apart.shared, 2U);
  EXPECT_FALSE(apart.new_old);
  EXPECT_TRUE(apart.objects.empty());
  EXPECT_THROW(relocalise(before, before, {.least_probability = 2.0}), InvalidInput);
}

TEST(Relocalise, ObjectsThatLeaveATurnFreeAreUndetermined) {
  // Two cans on one axis.
  Places cans{{"can-1", pose(0.0, 0.0, 0.2, 0.0, 0.0, 0.8)},
              {"can-2", pose(0.0, 0.0, 0.9, 0.0, 0.0, 1.1)}};
  std::vector<ObjectModel> all;
  for (const auto& [id, place] : cans)
    all.push_back({.id = id,
                   .noise = testing::gaussian_noise(2.0, 0.01),
                   .symmetries = SymmetryGroup::turns({0.0, 0.0, 1.0}, 0)});
  const auto of = [&](std::uint64_t seed, const SE3d& world) {
    return run(seed, world, cans, {"can-1", "can-2"}, all);
  };
  EXPECT_EQ(relocalise(of(1, SE3d()), of(2, kNewOld)).outcome, RelocaliseOutcome::undetermined);
}

TEST(Relocalise, TwoWaysToPairAClassAreAmbiguous) {
  // Two nuts that look the same after half a turn, opposite each other: which is which?
  Places nuts{{"nut-1", pose(0.0, 0.0, 0.0, 0.2, 0.0, 1.0)},
              {"nut-2", pose(0.0, 0.0, 0.0, -0.2, 0.0, 1.0)},
              {"box", pose(0.1, 1.0, 0.2, 0.25, 0.2, 1.0)}};
  std::vector<ObjectModel> all;
  for (const char* id : {"nut-1", "nut-2"})
    all.push_back({.id = id,
                   .noise = testing::gaussian_noise(2.0, 0.01),
                   .symmetries = SymmetryGroup::turns({0.0, 0.0, 1.0}, 2),
                   .class_id = "nut"});
  all.push_back({.id = "box", .noise = testing::gaussian_noise(2.0, 0.01)});
  const MultiObjectSlam before = run(1, SE3d(), nuts, {"nut-1", "nut-2", "box"}, all);
  const Relocalisation both = relocalise(before, run(2, kNewOld, nuts, {"nut-1", "nut-2"}, all));
  EXPECT_EQ(both.outcome, RelocaliseOutcome::ambiguous);
  EXPECT_NEAR(both.probability, 0.5, 0.3);
  EXPECT_FALSE(both.new_old);
  // The box tells, also where the new run has the nuts under each other's names.
  const Places swapped{{"nut-1", nuts["nut-2"]}, {"nut-2", nuts["nut-1"]}, {"box", nuts["box"]}};
  const Relocalisation told =
      relocalise(before, run(2, kNewOld, swapped, {"nut-1", "nut-2", "box"}, all));
  ASSERT_EQ(told.outcome, RelocaliseOutcome::found);
  EXPECT_LT(nees_of(kNewOld, *told.new_old), 22.5);
  for (const AgreedObject& one : told.agreed)
    EXPECT_EQ(one.old_object == one.new_object, one.old_object == "box");
}

TEST(Relocalise, OneMoreOfAClassIsNoneOfTheOldMap) {
  const auto nut = [](const char* id) {
    return ObjectModel{.id = id, .noise = testing::gaussian_noise(2.0, 0.01), .class_id = "nut"};
  };
  std::vector<ObjectModel> all{nut("nut-1"), nut("nut-2"), nut("nut-3")};
  all.push_back({.id = "box", .noise = testing::gaussian_noise(2.0, 0.01)});
  const Places nuts{{"nut-1", pose(0.2, 0.0, 0.0, 0.2, 0.0, 1.0)},
                    {"nut-2", pose(0.0, 0.3, 0.7, -0.2, 0.0, 1.0)},
                    {"nut-3", pose(0.0, 0.0, 2.0, 0.0, 0.2, 0.9)},
                    {"box", pose(0.1, 1.0, 0.2, 0.25, 0.2, 1.0)}};
  const MultiObjectSlam before = run(1, SE3d(), nuts, {"nut-1", "nut-2", "box"}, all);
  // What was nut-1 is nut-3 now, and under its name stands a nut that was not there.
  Places now = nuts;
  now["nut-3"] = nuts.at("nut-1");
  now["nut-1"] = nuts.at("nut-3");
  const Relocalisation found =
      relocalise(before, run(2, kNewOld, now, {"nut-1", "nut-2", "nut-3", "box"}, all));
  ASSERT_EQ(found.outcome, RelocaliseOutcome::found);
  EXPECT_EQ(found.shared, 4U);
  EXPECT_LT(nees_of(kNewOld, *found.new_old), 22.5);
  EXPECT_EQ(found.disagreeing, std::vector<std::string>{"nut-1"});
  ASSERT_EQ(found.agreed.size(), 3U);
  for (const AgreedObject& one : found.agreed)
    EXPECT_EQ(one.new_object, one.old_object == "nut-1" ? "nut-3" : one.old_object);
}

}  // namespace
}  // namespace posemix
