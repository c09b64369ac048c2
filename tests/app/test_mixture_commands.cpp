// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <regex>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "io/mixture_draws.hpp"
#include "mixture_folder.hpp"
#include "posemix/io/pose_samples.hpp"

/// The commands on mixture files, alone and in pipes.
namespace posemix {
namespace {

using nlohmann::json;
using testing::bits_of;
using testing::contains;
using testing::content_of;
using testing::ProgramResult;
using testing::two_peaks;
using testing::two_projected_peaks;

class MixtureCommands : public testing::MixtureFolder {};

TEST_F(MixtureCommands, HelpHasAnExample) {
  for (const std::string command : {"fit", "fuse", "compose", "reduce", "sample", "density",
                                    "divergence", "convert", "grasp"}) {
    EXPECT_TRUE(
        contains(output_of("posemix " + command + " --help"), "Example: posemix " + command));
  }
}

TEST_F(MixtureCommands, QuietLeavesNothingButTheResult) {
  for (const std::string command :
       {"fit samples.csv --components 2 --from camera --to mug", "fuse mug.json mug.json",
        "compose camera.json mug.json", "reduce mug.json --to 1", "sample mug.json -n 5",
        "density mug.json samples.csv", "divergence mug.json mug.json",
        "convert mug.json --distribution projected",
        "grasp mug.json --rotation-deg 5 --translation 0.01 --pose 0 0 0.8 0 0 0 1"}) {
    SCOPED_TRACE(command);
    output_of("posemix sample mug.json -n 50 --seed 9 --out samples.csv");
    const ProgramResult told = shell("posemix " + command);
    const ProgramResult quiet = shell("posemix " + command + " --quiet");
    EXPECT_EQ(quiet.exit_code, 0) << quiet.err;
    EXPECT_EQ(quiet.out, told.out);
    EXPECT_NE(quiet.out, "");
    EXPECT_EQ(quiet.err, "");
  }
}

TEST_F(MixtureCommands, ComposeChainsFrames) {
  for (const std::string distribution : {"", "-pg"}) {
    const MixtureFile chain =
        mixture_of("posemix compose camera" + distribution + ".json mug" + distribution + ".json");
    EXPECT_EQ(chain.frames, (FrameNames{"table", "mug"}));
    EXPECT_EQ(std::visit([](const auto& m) { return m.size(); }, chain.mixture), 4U);
    EXPECT_EQ(mixture_of("posemix compose --inverse mug" + distribution + ".json").frames,
              (FrameNames{"mug", "camera"}));
    EXPECT_EQ(mixture_of("posemix compose --between mug" + distribution + ".json mug" +
                         distribution + ".json")
                  .frames,
              (FrameNames{"mug", "mug"}));
  }
  const auto chain = mixture_of("posemix compose camera.json mug.json");
  const auto expected = compose(two_peaks(), two_peaks());
  EXPECT_EQ(bits_of(std::get<ConcentratedPoses>(chain.mixture)), bits_of(expected));
  expect_error("posemix compose mug.json mug.json", 3,
               "mug.json: got T_camera_mug, expected one from frame mug as mug.json is "
               "T_camera_mug");
  expect_error("posemix compose mug.json", 2, "got 1 mixture files, expected two or more");
  expect_error("posemix compose --inverse mug.json camera.json", 2, "--inverse: got 2 mixture");
  expect_error("posemix compose camera.json mug-pg.json", 3,
               "mug-pg.json: got distribution \"projected\", expected \"concentrated\"");
  expect_error("posemix compose camera.json mug.json --rule jacobian", 3,
               "got distribution \"concentrated\", expected \"projected\" with --rule");
}

TEST_F(MixtureCommands, FuseReportsTheEvidence) {
  const auto fused = fuse(two_peaks(), two_peaks(), FuseSettings{});
  const ProgramResult result = shell("posemix fuse mug.json mug.json --json");
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(json::parse(result.err)["log_evidence"], fused.log_overlap);
  EXPECT_EQ(bits_of(std::get<ConcentratedPoses>(parse_mixture(result.out, "out").mixture)),
            bits_of(fused.density));
  EXPECT_TRUE(contains(shell("posemix fuse mug.json mug.json").err, "  log_evidence:  "));
  EXPECT_EQ(mixture_of("posemix fuse mug-pg.json mug-pg.json --quiet").frames.to, "mug");
  expect_error("posemix fuse mug.json camera.json", 3,
               "camera.json: got T_table_camera, expected T_camera_mug as in mug.json");
  expect_error("posemix fuse - - < mug.json", 2, "'-' more than once");
}

TEST_F(MixtureCommands, EvidencesAddUp) {
  const auto evidence = [&](const std::string& line) -> double {
    return json::parse(shell(line).err)["log_evidence"];
  };
  const double all = evidence("posemix fuse mug.json mug.json mug.json --json");
  const double first = evidence("posemix fuse mug.json mug.json --json --out two.json");
  const double second = evidence("posemix fuse two.json mug.json --json --out three.json");
  EXPECT_NEAR(first + second, all, 1e-12);
}

TEST_F(MixtureCommands, ReduceReportsWhatItLoses) {
  for (const std::string distribution : {"", "-pg"}) {
    const ProgramResult result = shell("posemix compose camera" + distribution + ".json mug" +
                                       distribution + ".json | posemix reduce - --to 2 --json");
    EXPECT_EQ(result.exit_code, 0) << result.err;
    const json report = json::parse(result.err);
    EXPECT_EQ(report["components_before"], 4);
    EXPECT_EQ(report["merges"], 2);
    const double measured = report["measured_kl_nats"];
    const double error = report["measured_kl_standard_error"];
    const double bound = report["bounds"]["merged_kl_nats"];
    EXPECT_GT(measured, -1e-12);
    EXPECT_LE(measured, bound + 4.0 * error + 1e-12);
    const MixtureFile file = parse_mixture(result.out, "out");
    EXPECT_EQ(std::visit([](const auto& m) { return m.size(); }, file.mixture), 2U);
  }
  EXPECT_EQ(std::visit([](const auto& m) { return m.size(); },
                       mixture_of("posemix reduce mug.json --drop-below 0.5 --quiet").mixture),
            1U);
  expect_error("posemix reduce mug.json --to 0", 2, "--to");
  expect_error("posemix reduce mug.json --pair nearest", 2,
               "--pair: got nearest, expected largest_with_smallest|");
}

TEST_F(MixtureCommands, APipeOfThree) {
  const std::string text = output_of(
      "posemix compose camera.json mug.json | posemix reduce - --to 5 --quiet | "
      "posemix sample - -n 100 --seed 3");
  EXPECT_EQ(parse_pose_samples(text, "p", PoseFormat::csv).poses.size(), 100U);
}

TEST_F(MixtureCommands, SamplesAreThoseOfTheLibrary) {
  output_of("posemix sample mug.json -n 50 --seed 9 --out s.npy");
  const auto read =
      parse_pose_samples(content_of(folder_ / "s.npy"), "s.npy", PoseFormat::npy).poses;
  RandomStream stream(9);
  const ConcentratedPoses mixture = two_peaks();
  for (const SE3d& pose : read) EXPECT_EQ(pose.matrix(), mixture.sample(stream).matrix());
  EXPECT_EQ(output_of("posemix sample mug.json -n 5 --seed 2"),
            output_of("posemix sample mug.json -n 5 --seed 2 --exact"));
  EXPECT_NE(output_of("posemix sample mug-pg.json -n 5"),
            output_of("posemix sample mug-pg.json -n 5 --by-projection"));
  EXPECT_TRUE(output_of("posemix sample mug.json -n 1 --format tum").starts_with("0 "));
  expect_error("posemix sample mug.json -n 5 --by-projection", 3, "expected \"projected\" with");
  expect_error("posemix sample mug.json", 2, "--count is required");
}

TEST_F(MixtureCommands, DensityAtPoses) {
  for (const std::string distribution : {"", "-pg"}) {
    output_of("posemix sample mug" + distribution + ".json -n 20 --out points.csv");
    std::istringstream column(output_of("posemix density mug" + distribution + ".json points.csv"));
    const auto poses =
        parse_pose_samples(content_of(folder_ / "points.csv"), "p", PoseFormat::csv).poses;
    std::string line;
    std::getline(column, line);
    EXPECT_EQ(line, "log_density_per_rad3_m3");
    for (const SE3d& pose : poses) {
      std::getline(column, line);
      const double expected = distribution.empty() ? two_peaks().log_density(pose)
                                                   : two_projected_peaks().log_density(pose);
      EXPECT_NEAR(std::stod(line), expected, 1e-9);
    }
  }
  expect_error("posemix density mug.json mug.json", 3, "does not say the format");
}

TEST_F(MixtureCommands, FitFindsThePeaksAgain) {
  const ProgramResult result = shell(
      "posemix sample mug.json -n 3000 | posemix fit - --format csv --max-components 3 "
      "--from camera --to mug --json --out fit.json");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  const json report = json::parse(result.err);
  EXPECT_EQ(report["components"], 2);
  EXPECT_EQ(report["status"], "converged");
  EXPECT_EQ(report["bic_by_components"].size(), 3U);
  const json divergence = json::parse(output_of("posemix divergence mug.json fit.json --json"));
  // 55 parameters from 3000 samples cost about 55 / 6000 nats.
  EXPECT_LT(divergence["kl"]["value"], 0.03);
  EXPECT_GT(divergence["kl"]["value"], 0.0);
  expect_error("posemix fit fit.json --components 1 --from a --to b", 3, "fit.json: got a name");
  expect_error(
      "posemix sample mug.json -n 3 | posemix fit - --format csv --components 2 --from a "
      "--to b",
      3, "expected at least 14");
}

TEST_F(MixtureCommands, FitProjectedAndWeighted) {
  output_of("posemix sample mug-pg.json -n 2000 --out s.csv");
  const json report = json::parse(
      shell(
          "posemix fit s.csv --distribution projected --components 2 --from camera --to mug --json "
          "--out fit.json")
          .err);
  EXPECT_EQ(report["status"], "converged");
  const json found = json::parse(output_of("posemix divergence mug-pg.json fit.json --json"));
  EXPECT_LT(found["kl"]["value"], 0.05);
  // Rows of weight zero do not count.
  output_of("awk -F, 'NR==1 {print $0 \",w\"} NR>1 {print $0 \",\" (NR<=1001)}' s.csv > w.csv");
  output_of("head -n 1001 s.csv > half.csv");
  const std::string fit = " --components 2 --from camera --to mug --json --out out.json";
  const json weighted = json::parse(shell("posemix fit w.csv --weights w" + fit).err);
  const json half = json::parse(shell("posemix fit half.csv" + fit).err);
  EXPECT_NEAR(weighted["log_likelihood"], half["log_likelihood"], 1e-4);
}

TEST_F(MixtureCommands, ConvertBetweenConventionsAndDistributions) {
  const MixtureFile original{{"camera", "mug"}, two_peaks()};
  const MixtureConvention convention{Side::right, TangentOrder::translation_rotation,
                                     AngleUnit::deg, LengthUnit::mm};
  EXPECT_EQ(output_of("posemix convert mug.json --side right --order translation_rotation "
                      "--angle-unit deg --length-unit mm"),
            format_mixture(original, convention));
  EXPECT_EQ(output_of("posemix convert mug.json"), content_of(folder_ / "mug.json"));
  const ProgramResult result = shell(
      "posemix convert mug-pg.json --distribution concentrated --json --rule cubature "
      "--on-large-loss accept");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_GT(json::parse(result.err)["kl_lost_nats"], 0.0);
  EXPECT_TRUE(contains(result.out, "\"distribution\": \"concentrated\""));
  const ProgramResult old = shell("posemix convert mug.json --law projected --quiet");
  EXPECT_EQ(old.out, output_of("posemix convert mug.json --distribution projected --quiet"));
  EXPECT_TRUE(
      contains(old.err, "posemix: warning: convert: option '--law' is now '--distribution'"));
  EXPECT_FALSE(contains(output_of("posemix convert --help"), "--law"));
  expect_error("posemix convert mug.json --law projected --distribution projected", 2,
               "--law: is the old name of --distribution, expected one of them");
  const ProgramResult old_key =
      shell("sed s/distribution/law/ mug.json > old.json && posemix convert old.json");
  EXPECT_EQ(old_key.out, content_of(folder_ / "mug.json"));
  EXPECT_TRUE(contains(old_key.err, "posemix: warning: old.json: key 'law' is now 'distribution'"));
  expect_error("posemix convert mug-pg.json --side left", 3,
               "expected \"concentrated\" with --side");
}

TEST_F(MixtureCommands, GraspAtAPoseAndTheBest) {
  const json at =
      json::parse(output_of("posemix grasp mug.json --rotation-deg 10 --translation 0.05 "
                            "--pose 0 0 0.8 0 0 0 1 --json"));
  const json best = json::parse(
      output_of("posemix grasp mug.json --rotation-deg 10 10 10 --translation 0.05 --best --json"));
  EXPECT_GT(at["probability"], 0.0);
  EXPECT_LT(at["probability"], 0.7) << "the other peak is half a turn away";
  EXPECT_GE(best["probability"].get<double>(), at["probability"].get<double>() - 1e-3);
  EXPECT_EQ(best["probability_of_starts"].size(), 2U);
  expect_error("posemix grasp mug.json --rotation-deg 5 5 --translation 1 --best", 2,
               "--rotation-deg: got two numbers");
  expect_error("posemix grasp mug.json --rotation-deg 5 --translation 1 --pose nan 0 0 0 0 0 1", 2,
               "--pose: got nan, expected a finite number");
  expect_error("posemix grasp mug.json --rotation-deg 5 --translation 1 --pose '' 0 0 0 0 0 1", 2,
               "--pose: got '', expected a finite number");
  expect_error("posemix grasp mug.json --rotation-deg 5 --translation 1 --pose 1e160 0 0 0 0 0 1",
               2, "--pose: the grasp has a position of 1e+160 m, expected at most 1e+08 m");
  expect_error("posemix grasp mug.json --rotation-deg 5 --translation 1 --pose 0 0 0 0 0 0 2", 2,
               "--pose: got a quaternion of norm 2");
}

TEST_F(MixtureCommands, NumbersAreWhatIsTyped) {
  const auto drawn = [&](const std::string& options) {
    return output_of("posemix sample mug.json " + options);
  };
  EXPECT_EQ(drawn("-n 010 --seed 2"), drawn("-n 10 --seed 2"));
  EXPECT_EQ(drawn("-n 5 --seed 010"), drawn("-n 5 --seed 10"));
  const std::string largest = drawn("-n 5 --seed 18446744073709551615");
  EXPECT_NE(largest, drawn("-n 5 --seed 18446744073709551614"));
  EXPECT_EQ(largest, drawn("-n 5 --seed 18446744073709551615"));
}

TEST_F(MixtureCommands, ErrorsOfOptionsNameTheOption) {
  output_of("posemix sample mug.json -n 50 --out s.csv");
  const std::string fit = "posemix fit s.csv --components 1 ";
  expect_error(fit + "--from a --to b --min-sd 1 --max-sd .5", 2,
               "error: --max-sd: got 0.5, expected at least the 1 of --min-sd");
  expect_error(fit + "--from '' --to b", 2,
               "error: --from: got \"\", expected 1 to 100 printable ASCII characters");
  expect_error(fit + "--from a --to 'a b'", 2, "error: --to: got \"a b\", expected 1 to 100");
  const std::string grasp = "posemix grasp mug.json --best ";
  expect_error(grasp + "--rotation-deg 181 --translation 0.01", 2,
               "error: --rotation-deg: got 181, expected a number in (0, 180], in degrees");
  expect_error(grasp + "--rotation-deg 5 0 5 --translation 0.01", 2,
               "error: --rotation-deg: got 0, expected a number in (0, 180], in degrees");
  expect_error(grasp + "--rotation-deg 5 --translation -1", 2,
               "error: --translation: got -1, expected a positive number, in metres");
  output_of("posemix grasp mug.json --rotation-deg 180 --translation 0.01 --pose 0 0 0.8 0 0 0 1");
}

TEST_F(MixtureCommands, OptionsWithoutAnEffectAreRefused) {
  expect_error(
      "posemix grasp mug.json --rotation-deg 5 --translation 1 --pose 0 0 0.8 0 0 0 1 --starts 3",
      2, "--starts requires --best");
  for (const std::string option :
       {"--rule linear", "--max-kl 1e-9", "--on-large-loss refuse", "--seed 3"}) {
    expect_error("posemix convert mug.json " + option, 2,
                 option.substr(0, option.find(' ')) + ": requires --distribution");
  }
  const std::string converted = " projected --rule linear --max-kl 1 --seed 3 --quiet";
  EXPECT_EQ(shell("posemix convert mug.json --distribution" + converted).exit_code, 0);
  EXPECT_EQ(shell("posemix convert mug.json --law" + converted).exit_code, 0);
  for (const std::string option : {"--pair runnalls", "--merge midway", "--distance rotation"}) {
    expect_error("posemix reduce mug.json --drop 1 " + option, 2,
                 option.substr(0, option.find(' ')) + " requires --to");
  }
  expect_error("posemix reduce mug.json --to 1 --pair runnalls --distance rotation", 2,
               "--distance: is for --pair most_distant");
  output_of("posemix reduce mug.json --to 1 --pair most_distant --distance rotation --quiet");
}

TEST_F(MixtureCommands, DamagedFiles) {
  const std::string text = content_of(folder_ / "mug.json");
  folder_.put("cut.json", text.substr(0, text.size() / 2));
  folder_.put("empty.json", "");
  folder_.put("binary.json", std::string("\x7f"
                                         "ELF\0\xff",
                                         6));
  for (const std::string file : {"cut.json", "empty.json", "binary.json", "none.json"}) {
    expect_error("posemix reduce " + file + " --to 1 --out out.json", 3, file);
  }
  expect_error("head -c 300 mug.json | posemix sample - -n 3", 3, "standard input: got a text");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out.json"));
}

TEST_F(MixtureCommands, OutputThatCannotBeWritten) {
  expect_error("posemix sample mug.json -n 3 --out none/s.csv", 4, "none/s.csv: cannot be written");
  expect_error("posemix sample mug.json -n 3 > /dev/full", 4, "standard output: cannot be written");
  EXPECT_EQ(testing::names_in(folder_.path()).size(), 4U);
}

TEST_F(MixtureCommands, AReaderThatLeavesIsNoError) {
  const ProgramResult result =
      shell("{ posemix sample mug.json -n 20000; echo $? > code; } | head -n 1");
  EXPECT_EQ(result.out, "tx,ty,tz,qx,qy,qz,qw\n");
  EXPECT_EQ(result.err, "");
  EXPECT_EQ(content_of(folder_ / "code"), "141\n");
}

}  // namespace
}  // namespace posemix
