// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/results/provenance.hpp"

#include <cstdlib>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "io/expect_invalid.hpp"
#include "small_results.hpp"

namespace posemix {
namespace {

using nlohmann::json;

TEST(Provenance, CommandsAreQuotedForAShell) {
  const std::vector<std::string> words{"posemix",    "slam", "a b.toml", "--set",
                                       "x='y' $(z)", "",     "k=v,w:1.5"};
  EXPECT_EQ(quoted_command(words),
            "posemix slam 'a b.toml' --set 'x='\\''y'\\'' $(z)' '' k=v,w:1.5");
}

TEST(Provenance, TheTimeCanBeSet) {
  ::setenv("SOURCE_DATE_EPOCH", "1763918442", 1);
  EXPECT_EQ(utc_now(), "2025-11-23T17:20:42Z");
  ::setenv("SOURCE_DATE_EPOCH", "253402300799", 1);
  EXPECT_EQ(utc_now(), "9999-12-31T23:59:59Z");
  for (const char* none : {"soon", "-1", "253402300800", "9223372036854775807"}) {
    ::setenv("SOURCE_DATE_EPOCH", none, 1);
    const std::string now = utc_now();
    EXPECT_EQ(now.size(), 20U) << none;
    EXPECT_GT(now, "2026-01-01T00:00:00Z") << none;
    EXPECT_LT(now, "9000") << none;
  }
  ::unsetenv("SOURCE_DATE_EPOCH");
}

TEST(Provenance, InputsHaveDigests) {
  const testing::TemporaryFolder folder;
  const auto file = folder.put("a.toml", "abc");
  const std::vector<std::filesystem::path> paths{file, folder.path(), file};
  const auto inputs = provenance_inputs(paths);
  ASSERT_EQ(inputs.size(), 2U);
  EXPECT_EQ(inputs[0].path, file);
  EXPECT_EQ(inputs[0].sha256, "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(inputs[1].sha256, "");
}

TEST(Provenance, IsAKeyOfMetrics) {
  const testing::SmallResults results;
  EXPECT_FALSE(json::parse(results.files.at("metrics.json")).contains("provenance"));
  Provenance provenance{.command = {"posemix", "slam"}, .seed = 7};
  provenance.settings = R"({"overrides": ["a=1"]})";
  provenance.inputs = {{"a.toml", "12"}, {"folder", ""}};
  provenance.finished = "2026-11-23T17:20:42Z";
  EXPECT_EQ(provenance.instructions, vector_instructions());
  provenance.instructions = "avx2 without FMA";
  const auto files =
      format_results(*results.job, *results.slam, results.metrics, {.provenance = provenance});
  for (const auto& [name, text] : files) {
    if (name != "metrics.json") {
      EXPECT_EQ(text, results.files.at(name)) << name;
      continue;
    }
    json metrics = json::parse(text);
    const std::string version = metrics["provenance"]["version"];
    EXPECT_TRUE(version.starts_with("0.")) << version;
    EXPECT_EQ(metrics["provenance"], json({{"program", "posemix"},
                                           {"version", version},
                                           {"instructions", "avx2 without FMA"},
                                           {"command", "posemix slam"},
                                           {"seed", 7},
                                           {"settings", {{"overrides", {"a=1"}}}},
                                           {"finished", "2026-11-23T17:20:42Z"},
                                           {"inputs",
                                            {{{"path", "a.toml"}, {"sha256", "12"}},
                                             {{"path", "folder"}, {"sha256", nullptr}}}}}));
    metrics.erase("provenance");
    EXPECT_EQ(metrics, json::parse(results.files.at("metrics.json")));
  }
}

TEST(Provenance, IsAKeyOfStudies) {
  const std::vector<std::string> files{"study.json", "a.csv"};
  const std::string text = study_with_provenance("{\n \"schema\": 1,\n \"rows\": []\n}\n",
                                                 {.command = {"posemix"}, .seed = {}}, files);
  EXPECT_TRUE(text.starts_with("{\n \"schema\": 1,\n \"rows\": [],\n \"files\": [\n")) << text;
  const json study = json::parse(text);
  EXPECT_EQ(study["files"], json(files));
  EXPECT_EQ(study["provenance"]["command"], "posemix");
  EXPECT_FALSE(study["provenance"].contains("seed"));
  EXPECT_EQ(study["provenance"]["instructions"], vector_instructions());
  Provenance unknown{.command = {"posemix"}, .seed = {}};
  unknown.instructions.clear();
  EXPECT_TRUE(json::parse(study_with_provenance("{}", unknown, files))["provenance"]["instructions"]
                  .is_null());
  EXPECT_INVALID_WITH(study_with_provenance("[]", {.command = {}, .seed = {}}, files),
                      "study.json: got");
}

}  // namespace
}  // namespace posemix
