// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>

#include "io/expect_invalid.hpp"
#include "posemix/config/toml_table.hpp"

/// Keys of the release before are read under their new names, with a warning.
namespace posemix {
namespace {

using Warnings = std::vector<std::string>;

TomlDocument document_of(std::string_view text) { return TomlDocument::parse(text, "s.toml"); }

TEST(RenamedKeys, AreReadWithAWarningThatNamesThePlaceAndTheNewName) {
  const TomlDocument document = document_of(
      "[filter]\ncamera_share = 0.25\ncommon_error_share = 0.5\ndependent_answers = 2\n"
      "[noise.mug]\nnull = {weight = 0.125}\n");
  const TomlTable filter = document.root().get_table("filter");
  EXPECT_EQ(filter.get_double("odometry_camera_fraction"), 0.25);
  EXPECT_EQ(filter.get_double("bias_variance_fraction"), 0.5);
  EXPECT_EQ(filter.get_double("mode_correlation_factor"), 2.0);
  const TomlTable mug = document.root().get_table("noise").get_table("mug");
  EXPECT_EQ(mug.get_table("clutter").get_double("weight"), 0.125);
  EXPECT_NO_THROW(document.finish());
  ASSERT_EQ(document.warnings().size(), 4U);
  EXPECT_EQ(document.warnings()[0],
            "s.toml:2: key 'filter.camera_share' is now 'filter.odometry_camera_fraction'; the old "
            "name will be refused in 0.3");
  EXPECT_EQ(document.warnings()[3],
            "s.toml:6: key 'noise.mug.null' is now 'noise.mug.clutter'; the old name will be "
            "refused in 0.3");
}

TEST(RenamedKeys, AtTheTopOfADocumentOnlyThoseOfItsReader) {
  TomlDocument document = document_of("null = true\nnull_least = 0.25\n");
  EXPECT_EQ(document.warnings(), Warnings());
  EXPECT_TRUE(document.root().has("null"));
  document.rename_key("null", "clutter");
  EXPECT_TRUE(document.root().get_bool("clutter"));
  EXPECT_EQ(document.root().get_double("null_least"), 0.25);
  EXPECT_EQ(document.warnings(), Warnings{"s.toml:1: key 'null' is now 'clutter'; the old name "
                                          "will be refused in 0.3"});
  document.apply_override("null=false");
  EXPECT_FALSE(document.root().get_bool("clutter"));
  EXPECT_EQ(document.warnings().size(), 2U);
  EXPECT_INVALID(document_of("null = 1\nclutter = 2\n").rename_key("null", "clutter"),
                 "s.toml:1: key 'null' is the old name of 'clutter', which is at s.toml:2 already, "
                 "expected one of them");
}

TEST(RenamedKeys, AVariableOfASequenceFileMayHaveAnyName) {
  TomlDocument document = document_of("null = \"0001\"\npath = \"${null}.txt\"\n");
  EXPECT_EQ(document.root().get_string("path"), "0001.txt");
  document.apply_override("null=0002");
  EXPECT_EQ(document.root().get_string("path"), "0002.txt");
  EXPECT_EQ(document.warnings(), Warnings());
}

TEST(RenamedKeys, NewNamesAndNamesOfUsersHaveNoWarning) {
  const TomlDocument document = document_of(
      "[filter]\nodometry_camera_fraction = 0.25\n[noise.null]\nweight = 1\n[other]\nnull = 1\n");
  EXPECT_EQ(document.warnings(), Warnings());
  EXPECT_TRUE(document.root().get_table("noise").has("null"));
  EXPECT_TRUE(document.root().get_table("other").has("null"));
}

TEST(RenamedKeys, BothNamesAreAnError) {
  EXPECT_INVALID(
      document_of("[filter]\nodometry_camera_fraction = 1\ncamera_share = 1\n"),
      "s.toml:3: key 'filter.camera_share' is the old name of 'filter.odometry_camera_fraction', "
      "which is at s.toml:2 already, expected one of them");
}

TEST(RenamedKeys, OverridesMayHaveTheOldName) {
  TomlDocument document = document_of("[filter]\nodometry_camera_fraction = 1\n");
  document.apply_override("filter.camera_share=0.5");
  EXPECT_EQ(document.root().get_table("filter").get_double("odometry_camera_fraction"), 0.5);
  EXPECT_EQ(document.warnings(),
            Warnings{"--set filter.camera_share=0.5: key 'filter.camera_share' is now "
                     "'filter.odometry_camera_fraction'; the old name will be refused in 0.3"});
  document.apply_override("noise.mug.null.weight=0.5");
  document.apply_override("filter={dependent_answers = 4}");
  const TomlTable root = document.root();
  EXPECT_EQ(root.get_table("noise").get_table("mug").get_table("clutter").get_double("weight"),
            0.5);
  EXPECT_EQ(root.get_table("filter").get_double("mode_correlation_factor"), 4.0);
  EXPECT_EQ(document.warnings().size(), 3U);
}

}  // namespace
}  // namespace posemix
