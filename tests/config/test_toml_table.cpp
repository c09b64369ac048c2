// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/config/toml_table.hpp"

#include <gtest/gtest.h>

#include "io/expect_invalid.hpp"
#include "io/temporary_folder.hpp"

namespace posemix {
namespace {

TomlTable root_of(std::string_view text) { return TomlDocument::parse(text, "s.toml").root(); }

enum class Rule { midway, larger };

constexpr const char* kDocument = R"(
title = "demo"
gate = 0.99
count = 3
robust = true
lever_arm_m = [0.02, 0, -1e-3]
labels = ["a", "b"]
day = 1979-05-27

[noise.mug]
weight = 1
covariance = [[1, 0.5], [0.5, 2]]
rule = "midway"

[[objects]]
id = "mug"

[[objects]]
id = "can"
)";

TEST(TomlTable, ReadsEveryType) {
  const TomlTable root = root_of(kDocument);
  EXPECT_EQ(root.get_string("title"), "demo");
  EXPECT_EQ(root.get_double("gate", kUnitInterval), 0.99);
  EXPECT_EQ(root.get_double("count", kPositive), 3.0);
  EXPECT_EQ(root.get_integer("count", kAtLeastOne), 3);
  EXPECT_TRUE(root.get_bool("robust"));
  EXPECT_EQ(root.get_vector("lever_arm_m", 3), Eigen::Vector3d(0.02, 0, -1e-3));
  EXPECT_EQ(root.get_strings("labels"), (std::vector<std::string>{"a", "b"}));
  const TomlTable mug = root.get_table("noise").get_table("mug");
  EXPECT_EQ(mug.path(), "noise.mug");
  EXPECT_EQ(mug.get_matrix("covariance", 2, 2), (Eigen::Matrix2d() << 1, 0.5, 0.5, 2).finished());
  const auto rule =
      mug.get_enum<Rule>("rule", {{"larger", Rule::larger}, {"midway", Rule::midway}});
  EXPECT_EQ(rule, Rule::midway);
  const std::vector<TomlTable> objects = root.get_tables("objects");
  ASSERT_EQ(objects.size(), 2U);
  EXPECT_EQ(objects[1].path(), "objects[1]");
  EXPECT_EQ(objects[1].get_string("id"), "can");
}

TEST(TomlTable, DefaultsWhereMissing) {
  const TomlTable root = root_of("present = 1");
  EXPECT_EQ(root.get_double_or("a", 2.5), 2.5);
  EXPECT_EQ(root.get_double_or("present", 2.5), 1.0);
  EXPECT_EQ(root.get_integer_or("a", 4), 4);
  EXPECT_EQ(root.get_integer_or("present", 4), 1);
  EXPECT_TRUE(root.get_bool_or("a", true));
  EXPECT_EQ(root.get_string_or("a", "x"), "x");
  EXPECT_EQ(root.get_enum_or("a", Rule::larger, {{"midway", Rule::midway}}), Rule::larger);
  EXPECT_EQ(root.get_vector_or("a", Eigen::Vector2d(1, 2)), Eigen::Vector2d(1, 2));
  EXPECT_EQ(root.get_strings_or("a", {"x"}), std::vector<std::string>{"x"});
  EXPECT_FALSE(root.find_table("a").has_value());
  EXPECT_TRUE(root.find_tables("a").empty());
  EXPECT_FALSE(root.has("a"));
  EXPECT_INVALID_WITH(root.get_bool_or("present", true),
                      "s.toml:1: key 'present' is 1, expected true or false");
}

TEST(TomlTable, KeysInTheOrderOfTheText) {
  EXPECT_EQ(root_of("b = 1\na = 2\n[z]\n[c]\n").keys(),
            (std::vector<std::string>{"b", "a", "z", "c"}));
}

TEST(TomlTable, ErrorsSayPlaceKeyAndExpectation) {
  const TomlTable root = root_of(kDocument);
  const TomlTable mug = root.get_table("noise").get_table("mug");
  EXPECT_INVALID(
      mug.get_double("rule", kUnitInterval),
      "s.toml:13: key 'noise.mug.rule' is the string \"midway\", expected a number in [0, 1]");
  EXPECT_INVALID(mug.get_double("weight", {.lowest = 1, .highest = 2, .without_lowest = true}),
                 "s.toml:11: key 'noise.mug.weight' is 1, expected a number in (1, 2]");
  EXPECT_INVALID(mug.get_double("mean"),
                 "s.toml:10: key 'noise.mug.mean' is missing, expected a finite number");
  EXPECT_INVALID(root.get_integer("gate"), "s.toml:3: key 'gate' is 0.99, expected an integer");
  EXPECT_INVALID(root.get_integer("count", {.lowest = 4}),
                 "s.toml:4: key 'count' is 3, expected an integer of at least 4");
  EXPECT_INVALID(root.get_integer("count", {.highest = 2}),
                 "s.toml:4: key 'count' is 3, expected an integer of at most 2");
  EXPECT_INVALID(root.get_integer("count", {.lowest = 4, .highest = 9}),
                 "s.toml:4: key 'count' is 3, expected an integer in [4, 9]");
  EXPECT_INVALID(root.get_string("count"), "s.toml:4: key 'count' is 3, expected a string");
  EXPECT_INVALID(root.get_string("day"),
                 "s.toml:8: key 'day' is a date or time, expected a string");
  EXPECT_INVALID(root.get_bool("gate"), "s.toml:3: key 'gate' is 0.99, expected true or false");
  EXPECT_INVALID(root.get_double("robust"),
                 "s.toml:5: key 'robust' is a boolean, expected a finite number");
  EXPECT_INVALID(root.get_table("labels"), "s.toml:7: key 'labels' is an array, expected a table");
  EXPECT_INVALID(root.get_tables("labels"),
                 "s.toml:7: key 'labels' is an array, expected an array of tables");
  EXPECT_INVALID(root.get_tables("noise"),
                 "s.toml:10: key 'noise' is a table, expected an array of tables");
  EXPECT_INVALID(root.get_strings("lever_arm_m"),
                 "s.toml:6: key 'lever_arm_m[0]' is 0.02, expected a string");
  EXPECT_INVALID(mug.get_enum<Rule>("rule", {{"larger", Rule::larger}, {"other", Rule::midway}}),
                 "s.toml:13: key 'noise.mug.rule' is the string \"midway\", expected one of "
                 "\"larger\", \"other\"");
  EXPECT_INVALID(root.get_tables("objects")[1].get_double("id"),
                 "s.toml:19: key 'objects[1].id' is the string \"can\", expected a finite number");
  EXPECT_INVALID(root.get_tables("objects")[1].fail("id", "is taken"),
                 "s.toml:19: key 'objects[1].id' is taken");
  EXPECT_EQ(root.location("gate"), "s.toml:3");
  EXPECT_EQ(mug.location("nothing"), "s.toml:10");
}

TEST(TomlTable, NumbersAreFinite) {
  const TomlTable root = root_of("a = nan\nb = -inf\nc = [1, inf]\nd = 0\n");
  EXPECT_INVALID(root.get_double("a"), "s.toml:1: key 'a' is nan, expected a finite number");
  EXPECT_INVALID(root.get_double("b", kNotNegative),
                 "s.toml:2: key 'b' is -inf, expected a number that is not negative");
  EXPECT_INVALID(root.get_vector("c"), "s.toml:3: key 'c[1]' is inf, expected a finite number");
  EXPECT_INVALID(root.get_double("d", kPositive),
                 "s.toml:4: key 'd' is 0, expected a positive number");
  EXPECT_INVALID(root.get_double("d", {.lowest = 2}),
                 "s.toml:4: key 'd' is 0, expected a number in [2, inf)");
  EXPECT_INVALID(root.get_double("d", {.highest = 0, .without_highest = true}),
                 "s.toml:4: key 'd' is 0, expected a number in (-inf, 0)");
}

TEST(TomlTable, ShapesOfArrays) {
  const TomlTable root = root_of("v = [1, 2]\nm = [[1, 2], [3]]\nw = [1, 'x']\n");
  EXPECT_INVALID(root.get_vector("v", 3),
                 "s.toml:1: key 'v' has 2 elements, expected an array of 3 numbers");
  EXPECT_INVALID(root.get_vector("v", 2, kUnitInterval),
                 "s.toml:1: key 'v[1]' is 2, expected a number in [0, 1]");
  EXPECT_INVALID(root.get_vector("w"),
                 "s.toml:3: key 'w[1]' is the string \"x\", expected a finite number");
  EXPECT_INVALID(root.get_matrix("v", 2, 1),
                 "s.toml:1: key 'v[0]' is 1, expected an array of 1 number");
  EXPECT_INVALID(root.get_matrix("m", 2, 2),
                 "s.toml:2: key 'm[1]' is an array, expected an array of 2 numbers");
  EXPECT_INVALID(root.get_matrix("m", 3, 2),
                 "s.toml:2: key 'm' is an array, expected an array of 3 rows of 2 numbers");
}

TEST(TomlTable, UnknownKeys) {
  const auto finish_after = [](std::string_view text, auto read) {
    const TomlDocument document = TomlDocument::parse(text, "s.toml");
    read(document.root());
    document.finish();
  };
  const auto read_noise = [](const TomlTable& root) {
    const TomlTable noise = root.get_table("noise");
    noise.get_double_or("sd_deg", 1);
    noise.get_double_or("sd_m", 1);
    noise.get_double_or("weight", 1);
  };
  EXPECT_NO_THROW(finish_after("[noise]\nweight = 1\n", read_noise));
  EXPECT_INVALID(finish_after("[noise]\nweight = 1\n\nwieght = 2\n", read_noise),
                 "s.toml:4: unknown key 'noise.wieght', did you mean 'weight'?");
  EXPECT_INVALID(finish_after("[noise]\nbias = 1\n", read_noise),
                 "s.toml:2: unknown key 'noise.bias', known here: sd_deg, sd_m, weight");
  EXPECT_INVALID(finish_after("other = 1\n[noise]\n", read_noise),
                 "s.toml:1: unknown key 'other', known here: noise");
  EXPECT_INVALID(finish_after("[[objects]]\nid = 'a'\n[[objects]]\nid = 'b'\nx = 1\n",
                              [](const TomlTable& root) {
                                for (const auto& object : root.get_tables("objects"))
                                  object.get_string("id");
                              }),
                 "s.toml:5: unknown key 'objects[1].x', known here: id");
}

TEST(TomlTable, OtherUnits) {
  const auto read = [](std::string_view text) {
    const TomlTable root = root_of(text);
    root.get_double_or("sd_deg", 1);
    root.get_double_or("sd_m", 1);
    root.get_double_or("weight", 1);
    root.finish();
  };
  EXPECT_INVALID(read("sd_rad = 1"), "s.toml:1: key 'sd_rad': expected 'sd_deg' (degrees)");
  EXPECT_INVALID(read("sd_mm = 1"), "s.toml:1: key 'sd_mm': expected 'sd_m' (metres)");
  EXPECT_INVALID(read("weight_percent = 1"),
                 "s.toml:1: key 'weight_percent': expected 'weight' (no unit)");
  const TomlTable root = root_of("\nlever_arm_mm = [1, 2, 3]");
  EXPECT_INVALID(root.get_vector("lever_arm_m", 3),
                 "s.toml:2: key 'lever_arm_mm': expected 'lever_arm_m' (metres)");
}

TEST(TomlTable, MissingKeyThatLooksMisspelt) {
  EXPECT_INVALID(
      root_of("a = 1\nodometri = 'x'\n").get_string("odometry"),
      "s.toml:2: key 'odometry' is missing, expected a string (there is a key 'odometri')");
}

TEST(TomlTable, OutlivesItsDocument) {
  std::optional<TomlTable> table;
  table = TomlDocument::parse("[a]\nb = 1\n", "s.toml").root().get_table("a");
  EXPECT_EQ(table->get_double("b"), 1);
}

}  // namespace
}  // namespace posemix
