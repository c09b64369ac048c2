// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/config/symmetries.hpp"

#include <gtest/gtest.h>

#include "io/expect_invalid.hpp"
#include "posemix/base/units.hpp"
#include "posemix/config/sequence_file.hpp"
#include "small_recording.hpp"

namespace posemix {
namespace {

using testing::kSmallToml;
using testing::replaced;
using testing::SmallFolder;

SymmetryGroups parse(const std::string& text) { return parse_symmetry_file(text, "s.toml"); }

TEST(SymmetryFile, ReadsElementsAndAxes) {
  const SymmetryGroups groups = parse(R"(schema = 1
[symmetries.26]
discrete = [{rotation_deg = [0, 0, 180], translation_m = [-0.014, 0, 0]}]
[symmetries.4]
axes = [{direction = [0, 0, 1], point_m = [0.01, 0, 0]}]
[symmetries.7]
)");
  ASSERT_EQ(groups.size(), 3U);
  ASSERT_EQ(groups.at(26).elements().size(), 2U);
  const SE3d expected(SO3d::exp({0, 0, radians(180.0)}), {-0.014, 0, 0});
  EXPECT_TRUE(groups.at(26).elements()[1].is_approx(expected, 1e-15));
  ASSERT_EQ(groups.at(4).axes().size(), 1U);
  EXPECT_EQ(groups.at(4).axes()[0].point.x(), 0.01);
  EXPECT_TRUE(groups.at(7).is_trivial());
}

TEST(SymmetryFile, RefusesWithThePlace) {
  EXPECT_INVALID_WITH(parse("schema = 2\n[symmetries.4]\n"),
                      "s.toml:1: key 'schema' is 2, expected 1");
  EXPECT_INVALID_WITH(parse("schema = 1\n[symmetries.mug]\n"),
                      "key 'symmetries.mug' is no object id");
  EXPECT_INVALID_WITH(
      parse("schema = 1\n[symmetries.4]\ndiscrete = [{rotation_deg = [0, 90, 0]}]\n"),
      "s.toml:3: symmetries: the set is no group: element 0 ");
  EXPECT_INVALID_WITH(parse("schema = 1\n[symmetries.4]\naxis = []\n"), "'symmetries.4.axis'");
  EXPECT_INVALID_WITH(parse("schema = 1\n[symmetries.4]\naxes = [{point_m = [0, 0, 0]}]\n"),
                      "'symmetries.4.axes[0].direction'");
}

TEST(SymmetryFile, JsonIsModelsInfo) {
  const testing::TemporaryFolder folder;
  folder.put("models_info.json", R"({"3": {"diameter": 80, "symmetries_continuous":
      [{"axis": [0, 0, 1], "offset": [0, 0, 0]}]}})");
  EXPECT_EQ(read_symmetry_file(folder.path() / "models_info.json").at(3).axes().size(), 1U);
}

class SequenceSymmetries : public ::testing::Test {
 protected:
  SlamJob read(const std::string& symmetries) {
    const std::string line = "detections = {tum = \"mug.txt\"}\n";
    const std::string text =
        replaced(std::string(kSmallToml), line, line + "symmetries = " + symmetries + "\n");
    return read_slam_job(TomlDocument::parse(text, "s.toml"), {small_.folder.path()});
  }
  SmallFolder small_;
};

TEST_F(SequenceSymmetries, OfAnObject) {
  const SlamJob job = read("{discrete = [{rotation_deg = [0, 180, 0]}]}");
  EXPECT_EQ(job.models[0].symmetries.elements().size(), 2U);
  EXPECT_TRUE(job.models[1].symmetries.is_trivial());
  EXPECT_INVALID_WITH(read("{discrete = [{rotation_deg = [0, 18, 0]}]}"), "is no group");
}

TEST_F(SequenceSymmetries, FromModelsInfo) {
  small_.folder.put("models_info.json", R"({"14": {"diameter": 80, "symmetries_continuous":
      [{"axis": [0, 0, 1], "offset": [0, 0, 0]}]}})");
  const SlamJob job = read("{bop_models_info = \"models_info.json\", object = 14}");
  EXPECT_EQ(job.models[0].symmetries.axes().size(), 1U);
  EXPECT_INVALID_WITH(read("{bop_models_info = \"models_info.json\", object = 15}"),
                      "got no key '15'");
  EXPECT_INVALID_WITH(read("{bop_models_info = \"other.json\", object = 15}"), "other.json");
  EXPECT_INVALID_WITH(read("{bop_models_info = \"models_info.json\", object = 14, axes = []}"),
                      "stands beside 'bop_models_info'");
}

}  // namespace
}  // namespace posemix
