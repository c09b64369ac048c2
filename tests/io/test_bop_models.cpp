// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/io/bop_models.hpp"

#include <gtest/gtest.h>

#include "expect_invalid.hpp"

namespace posemix {
namespace {

// In the layout of BOP's models_info.json: a half turn about z through (5, -2) mm, and a can.
const std::string kModels = R"({
  "5": {"diameter": 108.69, "min_x": -54, "min_y": -20.5, "min_z": -10, "size_x": 108,
        "size_y": 41, "size_z": 20,
        "symmetries_discrete": [[-1, 0, 0, 10, 0, -1, 0, -4, 0, 0, 1, 0, 0, 0, 0, 1]]},
  "14": {"diameter": 50,
         "symmetries_discrete": [[1, 0, 0, 0, 0, -1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1]],
         "symmetries_continuous": [{"axis": [0, 0, 2], "offset": [0, 0, 7]}]},
  "20": {"diameter": 33.5, "some_other_key": "any"}
})";

std::string models_with(const std::string& from, const std::string& to) {
  std::string text = kModels;
  return text.replace(text.find(from), from.size(), to);
}

BopModels parse_models(const std::string& text) { return parse_bop_models(text, "m.json"); }

TEST(BopModels, ReadsMillimetres) {
  const BopModels models = parse_models(kModels);
  ASSERT_EQ(models.size(), 3U);
  const BopModel& five = models.at(5);
  EXPECT_DOUBLE_EQ(five.diameter_m, 0.10869);
  ASSERT_TRUE(five.box.has_value());
  EXPECT_LT((five.box->corners()[0] - Eigen::Vector3d(-0.054, -0.0205, -0.01)).norm(), 1e-15);
  EXPECT_LT((five.box->corners()[7] - Eigen::Vector3d(0.054, 0.0205, 0.01)).norm(), 1e-15);
  ASSERT_EQ(five.symmetries.elements().size(), 2U);
  // The points of the axis stay, others go to the other side.
  const SE3d& half = five.symmetries.elements()[1];
  EXPECT_LT(
      (half * Eigen::Vector3d(0.005, -0.002, 0.3) - Eigen::Vector3d(0.005, -0.002, 0.3)).norm(),
      1e-15);
  EXPECT_LT((half * Eigen::Vector3d(0.015, -0.002, 0) - Eigen::Vector3d(-0.005, -0.002, 0)).norm(),
            1e-15);
}

TEST(BopModels, CombinesDiscreteAndContinuous) {
  const BopModels models = parse_models(kModels);
  const BopModel& can = models.at(14);
  EXPECT_EQ(can.symmetries.elements().size(), 2U);
  ASSERT_EQ(can.symmetries.axes().size(), 1U);
  EXPECT_LT((can.symmetries.axes()[0].direction - Eigen::Vector3d::UnitZ()).norm(), 1e-15);
  EXPECT_FALSE(can.box.has_value());
  EXPECT_TRUE(models.at(20).symmetries.is_trivial());
}

TEST(BopModels, RefusesWithThePlace) {
  EXPECT_INVALID_WITH(parse_models("{"), "m.json: got a text that is not JSON");
  EXPECT_INVALID(parse_models("{}"), "m.json: got no object, expected at least one");
  EXPECT_INVALID(parse_models(models_with("\"20\"", "\"cup\"")),
                 "m.json: got the key \"cup\", expected an object id");
  EXPECT_INVALID(parse_models(models_with("\"diameter\": 50,", "")),
                 "m.json: 14: got no key 'diameter', expected one");
  EXPECT_INVALID(parse_models(models_with("108.69", "-1")),
                 "m.json: 5: diameter: got -1, expected a positive number");
  EXPECT_INVALID(parse_models(models_with("\"size_y\": 41", "\"size_q\": 41")),
                 "m.json: 5: got no key 'size_y', expected one");
  EXPECT_INVALID(parse_models(models_with("41", "-41")),
                 "m.json: 5: size_y: got a negative number, expected a number of at least 0");
  EXPECT_INVALID(parse_models(models_with(", 0, 0, 0, 1]]},\n  \"14\"", ", 0, 0, 1]]},\n  \"14\"")),
                 "m.json: 5: symmetries_discrete[0]: got 15 entries, expected 16");
  EXPECT_INVALID_WITH(parse_models(models_with("[[-1, 0, 0, 10", "[[-2, 0, 0, 10")),
                      "m.json: 5: symmetries_discrete[0]: ");
  EXPECT_INVALID(parse_models(models_with("\"axis\": [0, 0, 2]", "\"axis\": [0, 0]")),
                 "m.json: 14: symmetries_continuous[0]: axis: got 2 entries, expected 3");
  EXPECT_INVALID_WITH(parse_models(models_with("\"axis\": [0, 0, 2]", "\"axis\": [0, 0, 0]")),
                      "m.json: 14: symmetries: axis 0");
  // The last would be taken in silence, in the place of the others.
  EXPECT_INVALID(parse_models(models_with("\"20\"", "\"5\"")),
                 "m.json: got the key \"5\" twice in one object, expected once");
  EXPECT_INVALID(parse_models(models_with("\"20\"", "\"05\"")),
                 "m.json: got object 5 again, expected every object once");
  // A quarter turn alone is no group.
  EXPECT_INVALID_WITH(parse_models(models_with("[[-1, 0, 0, 10, 0, -1", "[[0, -1, 0, 0, 1, 0")),
                      "m.json: 5: symmetries: the set is no group: element 0 ");
}

TEST(BopModels, ReadsOneOfThemWhateverTheOthers) {
  const std::string damaged = models_with("\"diameter\": 50,", "");
  EXPECT_DOUBLE_EQ(parse_bop_model(damaged, "m.json", 20).diameter_m, 0.0335);
  EXPECT_INVALID(parse_bop_model(damaged, "m.json", 21), "m.json: got no key '21', expected one");
}

}  // namespace
}  // namespace posemix
