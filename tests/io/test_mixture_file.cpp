// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/io/mixture_file.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "expect_invalid.hpp"
#include "mixture_draws.hpp"
#include "posemix/base/units.hpp"
#include "temporary_folder.hpp"

namespace posemix {
namespace {

using Json = nlohmann::ordered_json;
using testing::awkward_concentrated;
using testing::awkward_projected;
using testing::bits_of;

const FrameNames kFrames{"camera", "mug"};

/// One component in the library's convention, written by hand.
const std::string kConcentrated = R"({
  "schema": 1, "type": "posemix.mixture", "group": "SE3", "distribution": "concentrated", "side": "left",
  "order": "rotation_translation", "units": {"rotation": "rad", "translation": "m"},
  "frames": {"from": "camera", "to": "mug"},
  "components": [{"weight": 1, "mean": {"translation": [1, 2, 3], "quaternion_xyzw": [0, 0, 0.6, 0.8]},
    "covariance": [[0.04, 0, 0, 0, 0, 0.001], [0, 0.05, 0, 0, 0, 0], [0, 0, 0.06, 0, 0, 0],
                   [0, 0, 0, 0.01, 0, 0], [0, 0, 0, 0, 0.02, 0], [0.001, 0, 0, 0, 0, 0.03]]}]})";

const std::string kProjected = R"({
  "schema": 1, "type": "posemix.mixture", "group": "SE3", "distribution": "projected", "side": "right",
  "order": "rotation_translation", "units": {"rotation": "tan_half_angle", "translation": "m"},
  "frames": {"from": "camera", "to": "mug"},
  "components": [{"log_weight": 0, "tangent_point": {"quaternion_xyzw": [0, 0, 0.6, 0.8]},
    "tangent_mean": {"u": [0.1, 0, 0], "translation": [1, 2, 3]},
    "covariance": [[0.04, 0, 0, 0, 0, 0.001], [0, 0.05, 0, 0, 0, 0], [0, 0, 0.06, 0, 0, 0],
                   [0, 0, 0, 0.01, 0, 0], [0, 0, 0, 0, 0.02, 0], [0.001, 0, 0, 0, 0, 0.03]]}]})";

MixtureFile parse(const Json& json) { return parse_mixture(json.dump(), "m.json"); }

const ConcentratedGaussian<SE3d>& only_peak(const MixtureFile& file) {
  return std::get<ConcentratedPoses>(file.mixture)[0].density;
}

/// The text with one value put in place of another.
Json mixture_with(const std::string& pointer, const Json& value,
                  const std::string& text = kConcentrated) {
  Json json = Json::parse(text);
  json[Json::json_pointer(pointer)] = value;
  return json;
}

Json without(const std::string& parent, const std::string& key,
             const std::string& text = kConcentrated) {
  Json json = Json::parse(text);
  json[Json::json_pointer(parent)].erase(key);
  return json;
}

TEST(MixtureFile, ReadsWhatIsWrittenByHand) {
  const MixtureFile file = parse_mixture(kConcentrated, "m.json");
  EXPECT_EQ(file.frames, kFrames);
  const auto& peak = only_peak(file);
  EXPECT_EQ(peak.mean().translation(), Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(peak.mean().rotation().quaternion().coeffs(), Eigen::Vector4d(0, 0, 0.6, 0.8));
  EXPECT_EQ(peak.covariance()(0, 5), 0.001);
  EXPECT_EQ(peak.covariance()(3, 3), 0.01);
  const MixtureFile projected = parse_mixture(kProjected, "m.json");
  const auto& density = std::get<ProjectedPoses>(projected.mixture)[0].density;
  EXPECT_EQ(density.tangent_mean()[0], 0.1);
  EXPECT_EQ(density.tangent_mean()[5], 3.0);
}

TEST(MixtureFile, ReadsBackToTheLastBit) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const auto concentrated = awkward_concentrated(seed, 7);
    const auto projected = awkward_projected(seed, 7);
    const std::string a = format_mixture({kFrames, concentrated});
    const std::string b = format_mixture({kFrames, projected});
    const MixtureFile read_a = parse_mixture(a, "a.json");
    const MixtureFile read_b = parse_mixture(b, "b.json");
    EXPECT_EQ(bits_of(std::get<ConcentratedPoses>(read_a.mixture)), bits_of(concentrated));
    EXPECT_EQ(bits_of(std::get<ProjectedPoses>(read_b.mixture)), bits_of(projected));
    EXPECT_EQ(format_mixture(read_a), a);
    EXPECT_EQ(format_mixture(read_b), b);
  }
}

TEST(MixtureFile, WeightsOfZeroAndFarBelowUnderflow) {
  const ConcentratedGaussian<SE3d> peak(SE3d(), Matrix6d::Identity());
  const double minus_infinity = -std::numeric_limits<double>::infinity();
  const ConcentratedPoses mixture({{minus_infinity, peak}, {0.0, peak}, {-5000.0, peak}});
  const std::string text = format_mixture({kFrames, mixture});
  const auto read = std::get<ConcentratedPoses>(parse_mixture(text, "m.json").mixture);
  EXPECT_EQ(bits_of(read), bits_of(mixture));
  EXPECT_EQ(read[2].log_weight, -5000.0);
}

TEST(MixtureFile, PlainWeightsAreNormalised) {
  Json json = Json::parse(kConcentrated);
  json["components"].push_back(json["components"][0]);
  json["components"][1]["weight"] = 3;
  const auto mixture = std::get<ConcentratedPoses>(parse(json).mixture);
  EXPECT_NEAR(mixture.weight(0), 0.25, 1e-15);
}

TEST(MixtureFile, RightPerturbationsBecomeLeftOnes) {
  const auto peak = only_peak(parse(mixture_with("/side", "right")));
  const Matrix6d body = only_peak(parse_mixture(kConcentrated, "m.json")).covariance();
  const Matrix6d ad = peak.mean().adjoint();
  EXPECT_LE((peak.covariance() - ad * body * ad.transpose()).cwiseAbs().maxCoeff(), 1e-15);
}

TEST(MixtureFile, OrderAndUnits) {
  Json json = mixture_with("/order", "translation_rotation");
  json["units"] = {{"rotation", "deg"}, {"translation", "mm"}};
  const auto peak = only_peak(parse(json));
  EXPECT_NEAR(peak.mean().translation().z(), 3e-3, 1e-18);
  // The first three are lengths now: (0.04 mm^2, ...), the last three angles.
  EXPECT_NEAR(peak.covariance()(3, 3), 0.04e-6, 1e-20);
  EXPECT_NEAR(peak.covariance()(2, 2), 0.03 * kRadPerDeg * kRadPerDeg, 1e-18);
  EXPECT_NEAR(peak.covariance()(2, 3), 0.001 * 1e-3 * kRadPerDeg, 1e-18);
}

TEST(MixtureFile, EveryConventionSaysTheSame) {
  const auto mixture = awkward_concentrated(3, 4);
  const auto projected = awkward_projected(3, 4);
  for (const Side side : {Side::left, Side::right}) {
    for (const auto order :
         {TangentOrder::rotation_translation, TangentOrder::translation_rotation}) {
      for (const auto angle : {AngleUnit::rad, AngleUnit::deg}) {
        for (const auto length : {LengthUnit::m, LengthUnit::mm}) {
          const MixtureConvention convention{side, order, angle, length};
          const auto read = std::get<ConcentratedPoses>(
              parse_mixture(format_mixture({kFrames, mixture}, convention), "m.json").mixture);
          const auto read_projected = std::get<ProjectedPoses>(
              parse_mixture(format_mixture({kFrames, projected}, convention), "m.json").mixture);
          for (std::size_t i = 0; i < mixture.size(); ++i) {
            EXPECT_TRUE(
                read[i].density.covariance().isApprox(mixture[i].density.covariance(), 1e-13));
            EXPECT_TRUE(read[i].density.mean().is_approx(mixture[i].density.mean(), 1e-15));
            EXPECT_TRUE(read_projected[i].density.covariance().isApprox(
                projected[i].density.covariance(), 1e-13));
          }
        }
      }
    }
  }
}

TEST(MixtureFile, MissingAndUnknownKeysAreRefused) {
  for (const char* key : {"schema", "type", "group", "distribution", "side", "order", "units",
                          "frames", "components"}) {
    EXPECT_INVALID(parse(without("", key)),
                   std::string("m.json: got no key '") + key + "', expected one");
  }
  EXPECT_INVALID(parse(without("/units", "rotation")),
                 "m.json: units: got no key 'rotation', expected one");
  EXPECT_INVALID(parse(without("/frames", "to")), "m.json: frames: got no key 'to', expected one");
  EXPECT_INVALID(parse(without("/components/0", "weight")),
                 "m.json: components[0]: got no key 'log_weight', expected one of 'weight' and "
                 "'log_weight'");
  EXPECT_INVALID_WITH(parse(mixture_with("/stamp", 1)),
                      "m.json: got the unknown key \"stamp\", expected");
  EXPECT_INVALID_WITH(parse(mixture_with("/components/0/log_weight", 0)),
                      "both 'weight' and 'log_weight'");
  EXPECT_INVALID_WITH(parse(mixture_with("/components/0/tangent_mean", 0)),
                      "unknown key \"tangent_mean\"");
  EXPECT_INVALID_WITH(parse(mixture_with("/components/0/mean/x", 0)),
                      "m.json: components[0]: mean: got the unknown key \"x\"");
  std::string twice = kConcentrated;
  twice.insert(twice.find("\"side\""), "\"side\": \"right\", ");
  EXPECT_INVALID(parse_mixture(twice, "m.json"),
                 "m.json: got the key \"side\" twice in one object, expected once");
}

TEST(MixtureFile, TheOldNameOfTheDistributionIsReadWithAWarning) {
  for (const std::string& text : {kConcentrated, kProjected}) {
    Json json = without("", "distribution", text);
    json["law"] = Json::parse(text)["distribution"];
    const MixtureFile file = parse(json);
    EXPECT_EQ(file.mixture.index(), parse_mixture(text, "m.json").mixture.index());
    EXPECT_EQ(file.warnings,
              std::vector<std::string>{"m.json: key 'law' is now 'distribution'; the old name will "
                                       "be refused in 0.3"});
    EXPECT_EQ(format_mixture(file).find("\"law\""), std::string::npos);
  }
  EXPECT_TRUE(parse_mixture(kConcentrated, "m.json").warnings.empty());
  EXPECT_INVALID(parse(mixture_with("/law", "concentrated")),
                 "m.json: got both 'distribution' and 'law', its old name, expected "
                 "'distribution' alone");
}

TEST(MixtureFile, WrongWordsAreRefused) {
  EXPECT_INVALID(parse(mixture_with("/type", "posemix.posterior")),
                 "m.json: type: got \"posemix.posterior\", expected \"posemix.mixture\"");
  EXPECT_INVALID(parse(mixture_with("/schema", 2)),
                 "m.json: schema: got 2, expected 1: the file was written in another version of "
                 "the format");
  EXPECT_INVALID(parse(mixture_with("/group", "SO3")),
                 "m.json: group: got \"SO3\", expected \"SE3\"");
  EXPECT_INVALID(
      parse(mixture_with("/distribution", "Gaussian")),
      "m.json: distribution: got \"Gaussian\", expected \"concentrated\" or \"projected\"");
  EXPECT_INVALID(parse(mixture_with("/side", "body")),
                 "m.json: side: got \"body\", expected \"left\" or \"right\"");
  EXPECT_INVALID(parse(mixture_with("/units/translation", "cm")),
                 "m.json: units: translation: got \"cm\", expected \"m\" or \"mm\"");
  EXPECT_INVALID(parse(mixture_with("/side", "left", kProjected)),
                 "m.json: side: got \"left\", expected \"right\"");
  EXPECT_INVALID(parse(mixture_with("/units/rotation", "rad", kProjected)),
                 "m.json: units: rotation: got \"rad\", expected \"tan_half_angle\"");
  EXPECT_INVALID_WITH(parse(mixture_with("/frames/to", "a b")), "m.json: frames: to: got \"a b\"");
}

TEST(MixtureFile, NumbersThatAreNoneOrOutOfRange) {
  EXPECT_INVALID(parse(mixture_with("/components/0/weight", -1)),
                 "m.json: components[0]: weight: got -1, expected a number of at least zero");
  EXPECT_INVALID(parse(mixture_with("/components/0/weight", 0)),
                 "m.json: components: all weights are zero, expected at least one component "
                 "with a weight above zero");
  EXPECT_INVALID_WITH(parse(mixture_with("/components", Json::array())), "m.json: components: a");
  const double nan = std::numeric_limits<double>::quiet_NaN();  // written as null
  EXPECT_INVALID(parse(mixture_with("/components/0/weight", nan)),
                 "m.json: components[0]: weight: got null, expected a number");
  EXPECT_INVALID(parse(mixture_with("/components/0/covariance/2/2", nan)),
                 "m.json: components[0]: covariance[2][2]: got null, expected a number");
  EXPECT_INVALID_WITH(parse(mixture_with("/components/0/mean/translation/1", 1e9)),
                      "at most 1e+08 m");
  EXPECT_INVALID(parse(mixture_with("/components/0/mean/quaternion_xyzw", {0, 0, 1, 1})),
                 "m.json: components[0]: mean: quaternion_xyzw: got norm 1.41421356, expected "
                 "norm 1");
  EXPECT_INVALID(parse(mixture_with("/components/0/covariance/5", {1, 2, 3})),
                 "m.json: components[0]: covariance[5]: got 3 entries, expected 6");
}

TEST(MixtureFile, CovariancesThatAreNone) {
  EXPECT_INVALID(parse(mixture_with("/components/0/covariance/4/4", -0.02)),
                 "m.json: components[0]: covariance: the matrix is not positive definite, "
                 "expected a symmetric positive definite matrix");
  EXPECT_INVALID_WITH(parse(mixture_with("/components/0/covariance/0/5", 0.002)),
                      "is not symmetric");
  EXPECT_INVALID_WITH(parse(mixture_with("/components/0/covariance/4/4", -0.02, kProjected)),
                      "is not positive definite");
}

TEST(MixtureFile, TextsThatAreNoJson) {
  for (const std::size_t size : {0, 1, 100, 500}) {
    EXPECT_INVALID_WITH(parse_mixture(kConcentrated.substr(0, size), "m.json"),
                        "m.json: got a text that is not JSON");
  }
  EXPECT_INVALID_WITH(parse_mixture("[1, 2]", "m.json"), "m.json: got array, expected an object");
  std::string nan = kConcentrated;
  nan.replace(nan.find("0.04"), 4, "NaN");
  EXPECT_INVALID_WITH(parse_mixture(nan, "m.json"), "m.json: got a text that is not JSON");
}

/// The message about a text that is no JSON, without its beginning.
std::string fault_of_text(const std::string& text) {
  try {
    parse_mixture(text, "m.json");
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

TEST(MixtureFile, SaysInPlainWordsWhereATextIsNoJson) {
  const std::vector<std::pair<std::string, std::string>> cases{
      {"", "line 1, column 1: the text ends too early"},
      {"{\n", "the text ends too early"},
      {"salt", "line 1, column 1: got \"s\", expected a value or a key"},
      {"{'a': 1}", "line 1, column 2: got \"'\", expected a value or a key"},
      {"{\n \"a\": 1,\n \"b\" 2}", "line 3, column 6: got a number, expected ':'"},
      {"[1, 2,]", "line 1, column 7: got ']', expected a value"},
      {"[1]]", "line 1, column 4: got ']', expected the end of the text"},
      {"{1: 2}", "got a number, expected a string"},
      {"[\"b", "a string without a closing quote"},
      {"[\"\\x\"]", "a string with a wrong escape"},
      {"[\"\xff\"]", "a string that is not UTF-8"},
      {"[1.]", "a number that does not end as one"},
      {"[\x01]", "got the character U+0001"},
      {"[1e999]", "the number 1e999 is too large"}};
  for (const auto& [text, fault] : cases) {
    const std::string message = fault_of_text(text);
    EXPECT_NE(message.find("m.json: got a text that is not JSON ("), std::string::npos) << message;
    EXPECT_NE(message.find(fault), std::string::npos) << message;
    for (const char* internal : {"json.exception", "syntax error", "last read", "literal"})
      EXPECT_EQ(message.find(internal), std::string::npos) << message;
  }
}

TEST(MixtureFile, ReadsAFile) {
  const testing::TemporaryFolder folder;
  const auto path = folder.put("m.json", kProjected);
  EXPECT_EQ(read_mixture(path).frames, kFrames);
  EXPECT_INVALID_WITH(read_mixture(folder / "none.json"), "none.json: cannot be read");
}

TEST(MixtureFile, WhatCannotBeReadIsNotWritten) {
  Matrix6d indefinite = Matrix6d::Identity();
  indefinite(2, 2) = -1.0;
  const auto trusted = ConcentratedGaussian<SE3d>::trusted(SE3d(), indefinite);
  EXPECT_INVALID(format_mixture({kFrames, ConcentratedPoses({{0.0, trusted}})}),
                 "component 0 of the mixture: covariance is not positive definite");
  const ConcentratedPoses good({{0.0, ConcentratedGaussian<SE3d>(SE3d(), Matrix6d::Identity())}});
  EXPECT_INVALID_WITH(format_mixture({{"", "b"}, good}), "frame name: got \"\"");
  const SE3d far(SO3d(), {0.0, 2e8, 0.0});
  EXPECT_INVALID_WITH(
      format_mixture({kFrames, ConcentratedPoses({{0.0, ConcentratedGaussian<SE3d>(
                                                            far, Matrix6d::Identity())}})}),
      "a position with a coordinate that is not within 1e+08 m");
}

}  // namespace
}  // namespace posemix
