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
  const TomlDocument document = document_of("[noise.mug]\nnull = {weight = 0.125}\n");
  const TomlTable mug = document.root().get_table("noise").get_table("mug");
  EXPECT_EQ(mug.get_table("clutter").get_double("weight"), 0.125);
  EXPECT_NO_THROW(document.finish());
  EXPECT_EQ(document.warnings(),
            Warnings{"s.toml:2: key 'noise.mug.null' is now 'noise.mug.clutter'; the old name will "
                     "be refused in 0.3"});
}

TEST(RemovedKeys, HaveNoEffectButAWarning) {
  TomlDocument document = document_of("[filter]\ngain = 1\nold = 0.25\n");
  document.apply_override("filter.older=2");
  const TomlTable filter = document.root().get_table("filter");
  EXPECT_EQ(filter.get_double("gain"), 1.0);
  filter.ignore_removed({"old", "older", "oldest"}, "nothing needs it");
  EXPECT_NO_THROW(document.finish());
  EXPECT_EQ(document.warnings(),
            (Warnings{"s.toml:3: key 'filter.old' has no effect any more: nothing needs it",
                      "--set filter.older=2: key 'filter.older' has no effect any more: nothing "
                      "needs it"}));
}

TEST(RemovedKeys, HaveNoEffectWithAllThatIsInThem) {
  const TomlDocument document = document_of(
      "[mug]\nbias = {sd_deg = 3, of = {range = 1}}\nold = [{a = 1}, {b = [{c = 2}]}]\n");
  document.root().get_table("mug").ignore_removed({"bias", "old"}, "nothing needs it");
  EXPECT_NO_THROW(document.finish());
  EXPECT_EQ(document.warnings(),
            (Warnings{"s.toml:2: key 'mug.bias' has no effect any more: nothing needs it",
                      "s.toml:3: key 'mug.old' has no effect any more: nothing needs it"}));
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
      "[noise.mug]\nclutter = {weight = 1}\n[noise.null]\nweight = 1\n[other]\nnull = 1\n");
  EXPECT_EQ(document.warnings(), Warnings());
  EXPECT_TRUE(document.root().get_table("noise").has("null"));
  EXPECT_TRUE(document.root().get_table("other").has("null"));
}

TEST(RenamedKeys, BothNamesAreAnError) {
  EXPECT_INVALID(
      document_of("[noise.mug]\nclutter = 1\nnull = 1\n"),
      "s.toml:3: key 'noise.mug.null' is the old name of 'noise.mug.clutter', which is at "
      "s.toml:2 already, expected one of them");
}

TEST(RenamedKeys, OverridesMayHaveTheOldName) {
  TomlDocument document = document_of("[noise.mug]\nclutter = {weight = 1}\n");
  document.apply_override("noise.mug.null.weight=0.5");
  const auto weight = [&](const char* name) {
    return document.root().get_table("noise").get_table(name).get_table("clutter").get_double(
        "weight");
  };
  EXPECT_EQ(weight("mug"), 0.5);
  EXPECT_EQ(document.warnings(),
            Warnings{"--set noise.mug.null.weight=0.5: key 'noise.mug.null.weight' is now "
                     "'noise.mug.clutter.weight'; the old name will be refused in 0.3"});
  document.apply_override("noise.cup={null = {weight = 0.25}}");
  EXPECT_EQ(weight("cup"), 0.25);
  EXPECT_EQ(document.warnings().size(), 2U);
}

}  // namespace
}  // namespace posemix
