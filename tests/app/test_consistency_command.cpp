// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "mixture_folder.hpp"
#include "posemix/base/random.hpp"
#include "posemix/io/text.hpp"
#include "posemix/io/tum.hpp"
#include "posemix/io/tum_covariance.hpp"
#include "posemix/lie/pose_covariance.hpp"

/// `posemix consistency`.
namespace posemix {
namespace {

using testing::contains;
using testing::ProgramResult;
using Json = nlohmann::json;

class ConsistencyCommand : public testing::MixtureFolder {
 protected:
  /// Writes truth.tum and estimate.tum, whose errors are as the covariances say.
  ConsistencyCommand() {
    RandomStream stream(3);
    const Matrix6d body = pose_covariance({0.02, 0.01, 0.03}, {0.01, 0.02, 0.01});
    std::vector<StampedPose> truth;
    std::vector<StampedDensity> estimates;
    for (int k = 0; k < 200; ++k) {
      const SE3d pose(SO3d::exp(Eigen::Vector3d(0, 0, 0.02 * k)),
                      Eigen::Vector3d(std::cos(0.02 * k), std::sin(0.02 * k), 0.01 * k));
      const SE3d estimate =
          pose * ConcentratedGaussian<SE3d>(SE3d(), body).sample(stream).inverse();
      truth.push_back({0.1 * k, pose});
      estimates.push_back({0.1 * k, {estimate, estimate.adjoint_congruence(body)}});
    }
    folder_.put("truth.tum", format_tum(truth));
    folder_.put("estimate.tum", format_tum_covariance(estimates));
  }

  Json json_of(const std::string& arguments) const {
    const ProgramResult result = shell("posemix consistency " + arguments + " --json -");
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return Json::parse(result.out);
  }
  ProgramResult failure(const std::string& arguments) const {
    const ProgramResult result = shell("posemix consistency " + arguments);
    EXPECT_EQ(result.exit_code, 3) << result.out << result.err;
    EXPECT_EQ(result.out, "");
    return result;
  }
};

TEST_F(ConsistencyCommand, SaysThatConsistentPosesAre) {
  const ProgramResult result = shell("posemix consistency estimate.tum --truth truth.tum");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(contains(result.out, "pose: 200 frames, 0 to 19.9 s")) << result.out;
  EXPECT_TRUE(contains(result.out, "  consistent: ")) << result.out;
  const Json json = json_of("estimate.tum --truth truth.tum");
  EXPECT_EQ(json["type"], "posemix.consistency");
  const Json& pose = json["poses"][0];
  EXPECT_EQ(pose["verdict"], "consistent");
  EXPECT_NEAR(pose["pose"]["anees"].get<double>(), 1.0, 0.15);
  EXPECT_EQ(pose["series"]["nees"].size(), 200U);
  EXPECT_EQ(pose["axes"].size(), 6U);
}

TEST_F(ConsistencyCommand, WritesFilesAndAReportOfThem) {
  const ProgramResult result = shell(
      "posemix consistency estimate.tum --truth truth.tum --quiet --out out --svg nees.svg && ls "
      "out");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.out, "consistency.csv\nconsistency.json\nconsistency.md\nconsistency.svg\n");
  EXPECT_EQ(testing::content_of(folder_ / "nees.svg"),
            testing::content_of(folder_ / "out/consistency.svg"));
  const ProgramResult table = shell("head -2 out/consistency.csv");
  EXPECT_TRUE(contains(table.out,
                       "pose,stamp_s,nees_per_dof,rotation_nees_per_dof,position_nees_per_dof\n"
                       "pose,0,"));
  const ProgramResult page = shell("posemix report out --quiet && grep -c '' out/report.html");
  if (contains(page.err, "without the report page")) GTEST_SKIP() << page.err;
  EXPECT_EQ(page.exit_code, 0) << page.err;
  EXPECT_EQ(
      shell("posemix consistency estimate.tum --truth truth.tum --quiet --report page.html && "
            "grep -q '\"kind\":\"consistency\"' page.html")
          .exit_code,
      0);
}

TEST_F(ConsistencyCommand, ConventionsAreThoseThatAreNamed) {
  // Swapped halves of the covariance say something else.
  const std::string arguments = "estimate.tum --truth truth.tum ";
  const double plain = json_of(arguments)["poses"][0]["pose"]["anees"];
  const double ros = json_of(arguments + "--convention ros")["poses"][0]["pose"]["anees"];
  const double same =
      json_of(arguments + "--side fixed --order translation_rotation")["poses"][0]["pose"]["anees"];
  EXPECT_GT(ros, 1.3 * plain);
  EXPECT_EQ(ros, same);
  EXPECT_EQ(shell("posemix consistency " + arguments + "--convention ros --side left").exit_code,
            2);
}

TEST_F(ConsistencyCommand, SymmetriesTakeTheirDirectionsOut) {
  folder_.put("symmetries.toml", "schema = 1\n[symmetries.7]\naxes = [{direction = [0, 0, 1]}]\n");
  const Json json =
      json_of("estimate.tum --truth truth.tum --symmetries symmetries.toml --object 7");
  EXPECT_EQ(json["poses"][0]["pose"]["dof"], 5);
  EXPECT_EQ(json["poses"][0]["axes"].size(), 5U);
  EXPECT_TRUE(contains(
      failure("estimate.tum --truth truth.tum --symmetries symmetries.toml --object 8").err,
      "symmetries.toml: has no object 8"));
  EXPECT_EQ(shell("posemix consistency estimate.tum --truth truth.tum --object 7").exit_code, 2);
}

TEST_F(ConsistencyCommand, ReadsTheFolderOfARun) {
  ASSERT_EQ(shell("posemix simulate '" POSEMIX_SOURCE_DIR
                  "/configs/demo.toml' --seed 1 --out sequence --quiet && posemix "
                  "slam sequence/sequence.toml --out run --quiet")
                .exit_code,
            0);
  const Json metrics = Json::parse(testing::content_of(folder_ / "run/metrics.json"));
  const Json json = json_of("run");
  ASSERT_GE(json["poses"].size(), 3U);
  EXPECT_EQ(json["poses"][0]["name"], "camera");
  // The trace has nine digits.
  EXPECT_NEAR(json["poses"][0]["pose"]["anees"].get<double>(),
              metrics["camera_consistency"]["anees"].get<double>(), 1e-4);
  const Json one = json_of("run --track objects/mug/relative");
  ASSERT_EQ(one["poses"].size(), 1U);
  EXPECT_NEAR(one["poses"][0]["pose"]["anees"].get<double>(),
              metrics["consistency"]["relative_anees"]["mug"].get<double>(), 1e-4);
  // The truth of the sequence file is the same, to the digits of the trace.
  const Json named = json_of("run --truth sequence/sequence.toml --track camera");
  EXPECT_NEAR(named["poses"][0]["pose"]["anees"].get<double>(),
              json["poses"][0]["pose"]["anees"].get<double>(), 1e-6);
  EXPECT_TRUE(
      contains(failure("run --track cup").err, "--track: got \"cup\", expected one of camera"));
  EXPECT_TRUE(contains(failure("run --truth truth.tum").err, "expected --track with one of"));
}

TEST_F(ConsistencyCommand, MetricsReduceByDeclaredSymmetries) {
  const std::string can = "'objects.soup-can.symmetries={axes=[{direction=[0,0,1]}]}'";
  ASSERT_EQ(shell("posemix simulate '" POSEMIX_SOURCE_DIR
                  "/configs/demo.toml' --seed 3 --out sequence --quiet && posemix slam "
                  "sequence/sequence.toml --quiet --out run --set " +
                  can)
                .exit_code,
            0);
  const Json metrics = Json::parse(testing::content_of(folder_ / "run/metrics.json"));
  const Json& object = metrics["objects"]["soup-can"];
  EXPECT_LT(object["relative_rotation_rmse_deg"].get<double>(), 6.0);
  EXPECT_LT(object["rotation_rmse_deg"].get<double>(), 6.0);
  EXPECT_LT(object["detection_relative_rotation_rmse_deg"].get<double>(), 8.0);
  EXPECT_EQ(object["right_mode_share"], 1.0);
  const Json run = json_of("run --track objects/soup-can/relative");
  EXPECT_EQ(run["poses"][0]["pose"]["dof"], 5);
  EXPECT_NEAR(run["poses"][0]["pose"]["anees"].get<double>(),
              metrics["consistency"]["relative_anees"]["soup-can"].get<double>(), 1e-3);
}

TEST_F(ConsistencyCommand, WrongInputIsNamed) {
  EXPECT_TRUE(contains(failure("truth.tum --truth truth.tum").err,
                       "truth.tum:1: got 8 columns, expected 29"));
  EXPECT_TRUE(contains(failure("estimate.tum").err, "got no estimates with ground truth"));
  EXPECT_TRUE(contains(failure("estimate.tum --truth nothing.tum").err, "nothing.tum"));
  ASSERT_EQ(shell("sed 's/^/9/' truth.tum > late.tum; head -1 estimate.tum > one.tum; mkdir empty; "
                  "sed '3s/\\([^ ]* \\)\\{9\\}/0 1 2 3 0 0 0 1 -/' estimate.tum > bad.tum")
                .exit_code,
            0);
  EXPECT_TRUE(contains(failure("one.tum --truth truth.tum").err, "1 pairs of estimate and truth"));
  EXPECT_TRUE(contains(failure("empty --truth truth.tum").err, "a folder without trace.json"));
  const ProgramResult late = failure("estimate.tum --truth late.tum");
  EXPECT_TRUE(contains(late.err, "late.tum: pose: ")) << late.err;
  EXPECT_TRUE(contains(failure("bad.tum --truth truth.tum").err, "bad.tum:3: got"));
  EXPECT_EQ(shell("posemix consistency estimate.tum --truth truth.tum --align by_eye").exit_code,
            2);
  EXPECT_EQ(shell("posemix consistency - --truth - < estimate.tum").exit_code, 2);
  EXPECT_EQ(
      shell("posemix consistency estimate.tum --truth truth.tum --svg no/such/nees.svg").exit_code,
      4);
}

TEST_F(ConsistencyCommand, TheDifferenceOfStampsIsAFiniteNumber) {
  const std::string command =
      "posemix consistency estimate.tum --truth truth.tum --max-difference ";
  EXPECT_EQ(shell(command + "0").exit_code, 0);
  for (const std::string wrong : {"nan", "inf", "-1", "soon"}) {
    const ProgramResult result = shell(command + wrong);
    EXPECT_EQ(result.exit_code, 2) << wrong;
    EXPECT_TRUE(contains(
        result.err, "--max-difference: got " + wrong + ", expected a number that is not negative"))
        << result.err;
    EXPECT_LT(result.err.size(), 200U);
  }
}

TEST_F(ConsistencyCommand, OneResultOnTheStandardOutput) {
  const std::string command = "posemix consistency estimate.tum --truth truth.tum --json - --svg ";
  expect_error(command + "-", 2, "--svg: got - beside --json -, expected the name of a file");
  EXPECT_TRUE(Json::accept(output_of(command + "nees.svg")));
  expect_error("posemix consistency estimate.tum --truth truth.tum --json a --svg a", 2,
               "--svg: is the file of --json, expected another one");
  // The same file by another name, by a link, and as a part of the folder.
  const std::string compare = "posemix consistency estimate.tum --truth truth.tum ";
  expect_error(compare + "--json ./a --svg \"$PWD/a\"", 2, "--svg: is the file of --json");
  expect_error(
      "touch a.html && ln -s a.html b.html && " + compare + "--json a.html --report b.html", 2,
      "--report: is the file of --json");
  expect_error("mkdir out && " + compare + "--svg out/../out/consistency.svg --out out", 2,
               "--svg: out/../out/consistency.svg is a result in the folder of --out");
  expect_error(compare + "--json out --out out", 2, "--json: is the folder of --out");
  expect_error(compare + "--json out/report.html --out out", 2,
               "--json: out/report.html is a result in the folder of --out");
  EXPECT_EQ(shell(compare + "--report out/report.html --out out").exit_code, 0);
  EXPECT_EQ(shell(compare + "--json /dev/null --svg /dev/null").exit_code, 0);
  EXPECT_EQ(shell(compare + "--json out/mine.json --out out").exit_code, 0);
}

TEST_F(ConsistencyCommand, OptionsWithoutAnEffectAreRefused) {
  const std::string command = "posemix consistency ";
  expect_error(command + "estimate.tum --truth truth.tum --data .", 2,
               "--data: is for --truth with a sequence file");
  expect_error(command + "run --data .", 2, "--data: is for --truth with a sequence file");
  for (const std::string option :
       {"--side right", "--order rotation_translation", "--convention ros"}) {
    for (const std::string run : {". ", "run/trace.json "})
      expect_error(command + run + option, 2,
                   option.substr(0, option.find(' ')) + ": is for TUM files");
  }
}

TEST_F(ConsistencyCommand, ATrackOfOnePoseIsRefused) {
  EXPECT_TRUE(contains(failure("estimate.tum --truth truth.tum --track camera").err,
                       "--track: got \"camera\", but estimate.tum and its truth are of one pose"));
  EXPECT_TRUE(
      contains(failure("estimate.tum --truth sequence.toml --track camera --track objects/mug").err,
               "--track: got 2 names for the one pose of estimate.tum, expected one"));
}

TEST_F(ConsistencyCommand, ReadsTheStandardInput) {
  const ProgramResult result =
      shell("posemix consistency - --truth truth.tum --align se3 < estimate.tum");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(contains(result.out, "standard input against truth.tum")) << result.out;
  EXPECT_TRUE(contains(result.out, "Aligned by the rigid motion")) << result.out;
}

}  // namespace
}  // namespace posemix
