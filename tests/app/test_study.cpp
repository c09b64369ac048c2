// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <set>
#include <thread>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "run_program.hpp"

/// The command `posemix study`.
namespace posemix {
namespace {

namespace fs = std::filesystem;

using testing::contains;
using testing::content_of;
using testing::names_in;
using testing::ProgramResult;
using testing::run_posemix;
using testing::RunningProgram;
using testing::TemporaryFolder;

class StudyCommand : public ::testing::Test {
 protected:
  fs::path out(const std::string& name = "out") const { return folder_ / name; }

  /// A small Monte-Carlo study.
  std::vector<std::string> monte_carlo(const fs::path& to) const {
    return {"study", "monte-carlo",        "--set",  "runs=6",
            "--set", "path.detections=40", "--set",  "noise_exponents=[1, 4]",
            "--out", to.string(),          "--quiet"};
  }

  /// study.json without what tells of the command alone.
  static nlohmann::json study_of(const fs::path& folder) {
    auto study = nlohmann::json::parse(content_of(folder / "study.json"));
    for (const char* key : {"command", "finished"}) {
      EXPECT_TRUE(study.at("provenance").contains(key)) << key;
      study["provenance"].erase(key);
    }
    return study;
  }

  /// Every file but those with times.
  static void expect_same_files(const fs::path& a, const fs::path& b) {
    ASSERT_EQ(names_in(a), names_in(b));
    for (const std::string& name : names_in(a)) {
      if (name.starts_with("timing")) continue;
      if (name == "study.json") {
        EXPECT_EQ(study_of(a), study_of(b));
        continue;
      }
      EXPECT_EQ(content_of(a / name), content_of(b / name)) << name;
    }
  }

  TemporaryFolder folder_;
};

TEST_F(StudyCommand, HelpHasAnExampleForEveryStudy) {
  for (const std::string study : {"divergence", "monte-carlo", "ycbv", "noise"}) {
    const ProgramResult help = run_posemix({"study", study, "--help"});
    EXPECT_EQ(help.exit_code, 0) << help.err;
    EXPECT_TRUE(contains(help.out, "Example: posemix study " + study)) << help.out;
  }
}

TEST_F(StudyCommand, DivergenceWritesTheSchema) {
  const ProgramResult result =
      run_posemix({"study", "divergence", "--set", "phi_deg=[30]", "--out", out().string()});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(contains(result.out, "tangent_of_larger_anchor_2")) << result.out;
  const auto json = nlohmann::json::parse(content_of(out() / "study.json"));
  EXPECT_EQ(json.at("schema"), 1);
  EXPECT_EQ(json.at("study"), "divergence");
  EXPECT_NEAR(json.at("rows").at(0).at("kl").get<double>(), 0.87336600, 1e-8);
  EXPECT_TRUE(json.at("description").get<std::string>().ends_with("?"));
  ASSERT_EQ(json.at("notes").size(), 1U);
  EXPECT_TRUE(contains(result.out, json.at("notes").at(0))) << "the page says what is printed";
  EXPECT_EQ(json.at("columns").at("kl").at("standard_error"), "kl_error");
  EXPECT_FALSE(fs::exists(out("out.journal"))) << "nothing is left of a study that is done";
}

TEST_F(StudyCommand, PrintsAScreenUnlessAskedForAllRows) {
  const auto printed = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"study", "divergence", "--out", out().string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_posemix(arguments).out;
  };
  const auto lines = [](const std::string& text) {
    return std::count(text.begin(), text.end(), '\n');
  };
  const std::string screen = printed({});
  EXPECT_LE(lines(screen), 40) << screen;
  EXPECT_TRUE(contains(screen, " rows more\n")) << screen;
  EXPECT_TRUE(contains(screen, "--all-rows")) << screen;
  const auto rows = nlohmann::json::parse(content_of(out() / "study.json")).at("rows").size();
  ASSERT_GT(rows, 40U);
  const std::string all = printed({"--all-rows"});
  EXPECT_GT(lines(all), static_cast<std::ptrdiff_t>(rows));
  EXPECT_FALSE(contains(all, "rows more")) << all;
}

TEST_F(StudyCommand, GivesTheSameForAnyNumberOfThreads) {
  for (const std::string threads : {"1", "3"}) {
    auto arguments = monte_carlo(out(threads));
    arguments.insert(arguments.end(), {"--threads", threads});
    const ProgramResult result = run_posemix(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.out + result.err, "");
  }
  expect_same_files(out("1"), out("3"));
}

TEST_F(StudyCommand, SaysWhereItsResultsComeFrom) {
  const fs::path settings = folder_.put("a setting.toml", "phi_deg = [30]\n");
  ::setenv("SOURCE_DATE_EPOCH", "0", 1);
  const ProgramResult result =
      run_posemix({"study", "divergence", settings.string(), "--json", "--out", out().string()});
  ::unsetenv("SOURCE_DATE_EPOCH");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  const std::string text = content_of(out() / "study.json");
  EXPECT_EQ(result.out, text);
  const auto study = nlohmann::json::parse(text);
  const auto& provenance = study.at("provenance");
  EXPECT_EQ(provenance.at("finished"), "1970-01-01T00:00:00Z");
  EXPECT_EQ(provenance.at("command"),
            "posemix study divergence '" + settings.string() + "' --json --out " + out().string());
  EXPECT_EQ(provenance.at("settings").at("phi_deg"), nlohmann::json({30.0}));
  EXPECT_EQ(provenance.at("inputs").at(0).at("path"), settings.string());
  EXPECT_EQ(provenance.at("inputs").at(0).at("sha256").get<std::string>().size(), 64U);
  const auto names = names_in(out());
  EXPECT_EQ(std::set<std::string>(names.begin(), names.end()),
            study.at("files").get<std::set<std::string>>());
}

TEST_F(StudyCommand, AnotherStudyRemovesTheFilesOfTheFirst) {
  ASSERT_EQ(run_posemix({"study", "divergence", "--set", "phi_deg=[30]", "--out", out().string(),
                         "--quiet"})
                .exit_code,
            0);
  const std::size_t files = names_in(out()).size();
  folder_.put("out/notes.md", "mine");
  auto arguments = monte_carlo(out());
  arguments.pop_back();
  const ProgramResult result = run_posemix(arguments);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(contains(result.out, "Replaced: the results of an earlier study, " +
                                       std::to_string(files) + " files\n"))
      << result.out;
  EXPECT_FALSE(fs::exists(out() / "divergence.csv"));
  EXPECT_EQ(content_of(out() / "notes.md"), "mine");
}

TEST_F(StudyCommand, ReadsSettingsFromAFile) {
  const fs::path settings =
      folder_.put("settings.toml",
                  "runs = 2\nmethods = [\"iterated\"]\nnoise_exponents = [0]\n"
                  "path = {detections = 5}\n");
  const ProgramResult result =
      run_posemix({"study", "monte-carlo", settings.string(), "--json", "--out", out().string()});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(nlohmann::json::parse(result.out).at("rows").at(0).at("runs"), 2);
}

TEST_F(StudyCommand, NamesWhatIsWrong) {
  const auto refused = [&](std::vector<std::string> arguments, const std::string& part) {
    arguments.insert(arguments.begin(), "study");
    arguments.insert(arguments.end(), {"--out", out().string()});
    const ProgramResult result = run_posemix(arguments);
    EXPECT_EQ(result.exit_code, 3) << result.err;
    EXPECT_TRUE(contains(result.err, part)) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_TRUE(names_in(folder_.path()).empty()) << "nothing is left behind";
  };
  refused({"monte-carlo", "--set", "rums=3"}, "rums");
  refused({"monte-carlo", "--set", "methods=[\"kalman\"]"}, "there is no method 'kalman'");
  refused({"monte-carlo", "--set", "methods=[]"}, "--set methods=[]: key 'methods' is empty");
  refused({"monte-carlo", "--set", "methods=[\"midway\",\"midway\"]"},
          "key 'methods' has 'midway' again");
  refused({"divergence", "--set", "weights=[1, -1]"}, "weights");
  refused({"divergence", "missing.toml"}, "missing.toml");
  refused({"divergence", "--set", "paper_grid_step_deg=1e-6"}, "paper_grid_step_deg");
  refused({"ycbv", "--data", out("nowhere").string()}, "nowhere");
  refused({"noise", "--data", out("nowhere").string()}, "nowhere");
}

TEST_F(StudyCommand, WithoutADataFolderTheErrorTellsHowToGetOne) {
  const std::string cache = out("cache").string();
  for (const char* study : {"ycbv", "noise", "tless", "grasp"}) {
    testing::RunningProgram program({"/usr/bin/env", "-u", "POSEMIX_DATA",
                                     "XDG_CACHE_HOME=" + cache, POSEMIX_PROGRAM, "study", study,
                                     "--out", out().string()});
    const ProgramResult result = program.wait();
    EXPECT_EQ(result.exit_code, 3) << result.err;
    for (const std::string& part :
         {cache + "/posemix: is not a folder", std::string("--data"), std::string("POSEMIX_DATA"),
          std::string("`posemix data fetch`")})
      EXPECT_TRUE(contains(result.err, part)) << result.err;
  }
}

TEST_F(StudyCommand, TheNoiseStudyReadsItsOldKeys) {
  const ProgramResult result = run_posemix({"study", "noise", "--set", "null=true", "--data",
                                            out("nowhere").string(), "--out", out().string()});
  EXPECT_TRUE(contains(result.err, "key 'null' is now 'clutter'")) << result.err;
  const ProgramResult other =
      run_posemix({"study", "divergence", "--set", "null=true", "--out", out().string()});
  EXPECT_TRUE(contains(other.err, "unknown key 'null'")) << other.err;
}

TEST_F(StudyCommand, NoiseOfASequenceWhoseFilesLieBesideIt) {
  const fs::path config = fs::path(POSEMIX_SOURCE_DIR) / "configs" / "demo.toml";
  ASSERT_EQ(run_posemix({"simulate", config.string(), "--set", "camera.frames=250", "--out",
                         out("recording").string(), "--quiet"})
                .exit_code,
            0);
  const std::string sequence = (out("recording") / "sequence.toml").string();
  const ProgramResult result =
      run_posemix({"study", "noise", "--set", "sequences=[\"" + sequence + "\"]", "--set",
                   "max_components=1", "--out", out().string()});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(fs::exists(out() / "noise_detector_mug.toml")) << result.out;
}

TEST_F(StudyCommand, WrongUsageNamesTheHelp) {
  const ProgramResult result = run_posemix({"study", "divergence"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_TRUE(contains(result.err, "`posemix study divergence --help`")) << result.err;
}

TEST_F(StudyCommand, ContinuesAfterAnInterruptAsIfThereWasNone) {
  auto arguments = monte_carlo(out("resumed"));
  arguments[3] = "runs=60";
  std::vector<std::string> command{POSEMIX_PROGRAM};
  command.insert(command.end(), arguments.begin(), arguments.end());
  RunningProgram program(command);
  const fs::path journal = out("resumed.journal");
  while (!program.has_ended() && (!fs::exists(journal) || fs::file_size(journal) < 4000)) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  program.send(SIGINT);
  EXPECT_EQ(program.wait().exit_code, 130);
  ASSERT_TRUE(fs::exists(journal));
  EXPECT_FALSE(fs::exists(out("resumed")));

  const ProgramResult again = run_posemix(arguments);
  EXPECT_EQ(again.exit_code, 3);
  EXPECT_TRUE(contains(again.err, "--resume")) << again.err;

  arguments.emplace_back("--resume");
  EXPECT_EQ(run_posemix(arguments).exit_code, 0);
  EXPECT_FALSE(fs::exists(journal));
  arguments.pop_back();
  arguments[9] = out("at once").string();
  EXPECT_EQ(run_posemix(arguments).exit_code, 0);
  expect_same_files(out("resumed"), out("at once"));
}

#ifdef POSEMIX_MPIRUN
class StudyRanks : public StudyCommand, public ::testing::WithParamInterface<int> {
 protected:
  static void SetUpTestSuite() {
    setenv("OMPI_ALLOW_RUN_AS_ROOT", "1", 1);
    setenv("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1", 1);
    setenv("OMPI_MCA_rmaps_base_oversubscribe", "1", 1);
  }

  static ProgramResult run(const std::vector<std::string>& arguments) {
    std::vector<std::string> command{POSEMIX_MPIRUN, "-n", std::to_string(GetParam()),
                                     POSEMIX_PROGRAM};
    command.insert(command.end(), arguments.begin(), arguments.end());
    return RunningProgram(command).wait();
  }
};

TEST_P(StudyRanks, GiveWhatOneProcessGives) {
  EXPECT_EQ(run_posemix(monte_carlo(out("one"))).exit_code, 0);
  const ProgramResult result = run(monte_carlo(out("many")));
  EXPECT_EQ(result.exit_code, 0) << result.err;
  expect_same_files(out("one"), out("many"));
}

TEST_P(StudyRanks, SayOnceWhatIsWrong) {
  auto arguments = monte_carlo(out());
  arguments.insert(arguments.end(), {"--set", "rums=3"});
  const ProgramResult result = run(arguments);
  EXPECT_NE(result.exit_code, 0);
  const std::size_t first = result.err.find("posemix: error: ");
  ASSERT_NE(first, std::string::npos) << result.err;
  EXPECT_EQ(result.err.find("posemix: error: ", first + 1), std::string::npos) << result.err;
}

INSTANTIATE_TEST_SUITE_P(Two, StudyRanks, ::testing::Values(2));
INSTANTIATE_TEST_SUITE_P(Four, StudyRanks, ::testing::Values(4));
#endif

}  // namespace
}  // namespace posemix
