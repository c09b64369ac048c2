// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <fstream>

#include <gtest/gtest.h>

#include "expect_invalid.hpp"
#include "posemix/io/gzip.hpp"
#include "posemix/io/observation_jsonl.hpp"
#include "posemix/io/placeholder_covariance.hpp"
#include "temporary_folder.hpp"

namespace posemix {
namespace {

const std::string kPoseField = R"("pose": [0, 0, 1, 0, 0, 0, 1])";  // NOLINT(cert-err58-cpp)

std::vector<Observation> parse_lines(const std::string& text) {
  return parse_observation_lines(text, "o.jsonl");
}

/// A sighting of object 7 with components.
std::string line(const std::string& components, const std::string& begin = R"("id": "7")") {
  return R"({"stamp_s": 1, )" + begin + R"(, "components": [)" + components + "]}\n";
}

std::string component(const std::string& weight) {
  return R"({"weight": )" + weight + ", " + kPoseField + "}";
}

std::string component_with(const std::string& covariance) {
  return R"({"weight": 1, )" + kPoseField + R"(, "covariance": )" + covariance + "}";
}

/// The upper triangle of a diagonal matrix.
std::string diagonal(const std::string& first, const std::string& others) {
  std::string text;
  for (int i = 0; i < 6; ++i) {
    for (int j = i; j < 6; ++j)
      text += (text.empty() ? "[" : ", ") + (i != j ? "0" : i == 0 ? first : others);
  }
  return text + "]";
}

std::vector<Observation> observations_of_lines() {
  Observation tag;
  tag.object = "7";
  tag.camera = "left, upper";
  tag.stamp_s = 1541777802.116735208;
  tag.clutter = 0.1;
  Matrix6d covariance = Matrix6d::Identity() / 30000.0;
  covariance(0, 4) = covariance(4, 0) = 1e-5 / 3.0;
  tag.components = {{.weight = 2.0 / 3.0,
                     .pose = SE3d(SO3d::exp({0.1, 0.2, 0.3}), {1.0 / 3.0, 2, 3}),
                     .covariance = covariance},
                    {.weight = 1.0 / 3.0, .pose = SE3d(SO3d::exp({3.0, 0.2, 0.3}), {1, 2, 3.1})}};
  Observation mug;
  mug.class_id = "mug \"blue\"";
  mug.detector = "dope";
  mug.stamp_s = -0.5;
  mug.score = -3.5;
  mug.components = {{.pose = SE3d(SO3d::exp({1e-9, 0.0, 0.0}), {0, 0, 0.1})}};
  return {tag, mug};
}

TEST(ObservationLines, AreReadBackToTheLastBit) {
  const auto before = observations_of_lines();
  const auto after = parse_lines(format_observation_lines(before));
  ASSERT_EQ(after.size(), before.size());
  for (std::size_t i = 0; i < before.size(); ++i) {
    EXPECT_EQ(after[i].object, before[i].object);
    EXPECT_EQ(after[i].class_id, before[i].class_id);
    EXPECT_EQ(after[i].camera, before[i].camera);
    EXPECT_EQ(after[i].detector, before[i].detector);
    EXPECT_EQ(after[i].stamp_s, before[i].stamp_s);
    EXPECT_EQ(after[i].clutter, before[i].clutter);
    EXPECT_EQ(after[i].score, before[i].score);
    ASSERT_EQ(after[i].components.size(), before[i].components.size());
    for (std::size_t k = 0; k < before[i].components.size(); ++k) {
      const ObservationComponent& a = after[i].components[k];
      const ObservationComponent& b = before[i].components[k];
      EXPECT_EQ(a.weight, b.weight);
      EXPECT_EQ(a.pose.translation(), b.pose.translation());
      EXPECT_EQ(a.pose.rotation().quaternion().coeffs(), b.pose.rotation().quaternion().coeffs());
      EXPECT_EQ(a.covariance, b.covariance);
    }
  }
}

TEST(ObservationLines, WhatIsOptionalMayBeNullOrMissing) {
  const auto read = parse_lines(
      "# a comment\n\n" + line(component("1")) +
      R"({"stamp_s": 2, "class": "mug", "id": null, "camera": null, "score": null, "clutter": null, )"
      R"("sighting": 4, "components": [{"weight": 1, "pose": [0,0,1,0,0,0,1.001], "covariance": null}]})");
  ASSERT_EQ(read.size(), 2U);
  EXPECT_EQ(read[0].object, "7");
  EXPECT_EQ(read[1].class_id, "mug");
  EXPECT_FALSE(read[1].score.has_value());
  EXPECT_FALSE(read[1].components[0].covariance.has_value());
  EXPECT_EQ(read[1].components[0].pose.rotation().quaternion().w(), 1.0);
}

TEST(ObservationLines, AFileMayBeCompressed) {
  const testing::TemporaryFolder folder;
  const std::string text = format_observation_lines(observations_of_lines());
  std::ofstream(folder / "o.jsonl") << text;
  std::ofstream(folder / "o.jsonl.gz") << gzip(text);
  EXPECT_EQ(format_observation_lines(read_observation_lines(folder / "o.jsonl")), text);
  EXPECT_EQ(format_observation_lines(read_observation_lines(folder / "o.jsonl.gz")), text);
}

TEST(ObservationLines, PlaceholdersAreNoCovariance) {
  const std::string one = line(component("1"));
  for (const std::string& none : {diagonal("0", "0"), diagonal("1", "1"), diagonal("-1", "0.01")})
    EXPECT_FALSE(parse_lines(one + line(component_with(none)))[1].components[0].covariance) << none;
  EXPECT_TRUE(parse_lines(line(component_with(diagonal("0.01", "1"))))[0].components[0].covariance);
  EXPECT_TRUE(is_placeholder_covariance(Matrix6d::Zero()));
  EXPECT_TRUE(is_placeholder_covariance(Matrix6d::Identity()));
  EXPECT_FALSE(is_placeholder_covariance(0.5 * Matrix6d::Identity()));
}

TEST(ObservationLines, ErrorsNameTheLineAndTheField) {
  const std::string good = line(component("1"));
  EXPECT_INVALID_WITH(parse_lines(good + line(component("0.5") + ", " + component("0.25"))),
                      "o.jsonl:2: the weights of the components sum to 0.75, expected one");
  EXPECT_INVALID_WITH(parse_lines(line(component("1.5") + ", " + component("-0.5"))),
                      "o.jsonl:1: components[1]: weight: got -0.5, expected zero or more");
  EXPECT_INVALID_WITH(parse_lines(good + line(component("NaN"))),
                      "o.jsonl:2: got a text that is not JSON");
  EXPECT_INVALID_WITH(parse_lines(good + line(component("1e999"))), "o.jsonl:2: ");
  EXPECT_INVALID(parse_lines(line(component("\"1\""))),
                 "o.jsonl:1: components[0]: weight: got string, expected a number");
  EXPECT_INVALID_WITH(parse_lines(good + line("")), "o.jsonl:2: the observation has no components");
  EXPECT_INVALID_WITH(parse_lines(line(component_with(diagonal("-0.01", "0.01")))),
                      "o.jsonl:1: components[0]: covariance: got c00 = -0.01, expected a variance");
  EXPECT_INVALID_WITH(parse_lines(line(component_with("[1, 2]"))),
                      "o.jsonl:1: components[0]: covariance: got 2 entries, expected 21");
  EXPECT_INVALID_WITH(parse_lines(good + good.substr(0, good.size() / 2)),
                      "o.jsonl:2: got a text that is not JSON");
  EXPECT_INVALID_WITH(parse_lines(line(component("1"), R"("id": "7", "wieght": 1)")),
                      "o.jsonl:1: got the unknown key \"wieght\"");
  EXPECT_INVALID_WITH(parse_lines(line(component("1"), R"("id": "7", "id": "8")")),
                      "o.jsonl:1: got the key \"id\" twice");
  const std::string third = line(component("1"), R"("id": "7", "sighting": 3)");
  EXPECT_INVALID(parse_lines(third + third),
                 "o.jsonl:2: sighting: got sighting 3 again, expected one line for every sighting");
  EXPECT_INVALID_WITH(parse_lines(line(component("1"), R"("id": "7", "sighting": 0.5)")),
                      "o.jsonl:1: sighting: got 0.5, expected an integer from 0 to 2^53");
  EXPECT_INVALID(parse_lines(line(component("1"), R"("camera": "left")")),
                 "o.jsonl:1: got neither id nor class, expected one of the two");
  EXPECT_INVALID_WITH(
      parse_lines(line(component("1"), R"("id": "7", "clutter": 1)")),
      "o.jsonl:1: clutter: got 1, expected a probability above 0 and at most 1 - 1e-9");
  for (const char* sighting : {"-1", "1e300"}) {
    EXPECT_INVALID_WITH(
        parse_lines(line(component("1"), R"("id": "7", "sighting": )" + std::string(sighting))),
        "o.jsonl:1: sighting: got ");
  }
  EXPECT_INVALID_WITH(parse_lines(R"({"stamp_s": 1e13, "id": "7", "components": []})"),
                      "o.jsonl:1: stamp_s: got 10000000000000, expected seconds, at most 1e+12");
  EXPECT_INVALID_WITH(
      parse_lines(good + line(R"({"weight": 1, "pose": [0, 0, 1e9, 0, 0, 0, 1]})")),
      "o.jsonl:2: components[0]: pose[2]: got 1000000000, expected metres, at most 1e+08");
  EXPECT_INVALID_WITH(parse_lines(R"({"id": "7", "components": []})"),
                      "o.jsonl:1: got no key 'stamp_s', expected one");
  EXPECT_INVALID_WITH(
      parse_lines(line(R"({"weight": 1, "pose": [0, 0, 1, 0, 0, 0, 2]})")),
      "o.jsonl:1: components[0]: pose: got a quaternion of norm 2, expected qx qy qz qw");
  EXPECT_INVALID(parse_lines("\n"), "o.jsonl: got no observations, expected at least one");
}

TEST(ObservationLines, RefuseToWriteWhatCannotBeReadBack) {
  auto observations = observations_of_lines();
  observations[1].class_id.clear();
  EXPECT_INVALID(format_observation_lines(observations),
                 "observation 1 has neither an object nor a class, expected one of the two");
  observations = observations_of_lines();
  observations[0].components.clear();
  EXPECT_INVALID_WITH(format_observation_lines(observations), "has no components");
}

}  // namespace
}  // namespace posemix
