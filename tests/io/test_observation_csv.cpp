// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <fstream>

#include <gtest/gtest.h>

#include "expect_invalid.hpp"
#include "posemix/io/gzip.hpp"
#include "posemix/io/observation_csv.hpp"
#include "posemix/io/text.hpp"
#include "temporary_folder.hpp"

namespace posemix {
namespace {

constexpr const char* kHeader =
    "stamp_s,camera,detector,id,class,sighting,weight,tx_m,ty_m,tz_m,qx,qy,qz,qw,c00,c01,c02,c03,"
    "c04,c05,c11,c12,c13,c14,c15,c22,c23,c24,c25,c33,c34,c35,c44,c45,c55";
const std::string kNoCovariance(20, ',');  // NOLINT(cert-err58-cpp)

/// A row up to the pose, a pose, and no covariance.
std::string row(const std::string& begin) {
  return begin + ",0,0,1,0,0,0,1," + kNoCovariance + "\n";
}

std::vector<Observation> parse_rows(const std::string& rows) {
  return parse_observations(std::string(kHeader) + "\n" + rows, "o.csv");
}

std::vector<Observation> observations_of_table() {
  Observation tag;
  tag.object = "7";
  tag.camera = "left";
  tag.stamp_s = 1541777802.116735208;
  Matrix6d covariance = Matrix6d::Identity() * 1e-4;
  covariance(0, 4) = covariance(4, 0) = 3e-5;
  tag.components = {{.weight = 0.75,
                     .pose = SE3d(SO3d::exp({0.1, 0.2, 0.3}), {1, 2, 3}),
                     .covariance = covariance},
                    {.weight = 0.25, .pose = SE3d(SO3d::exp({3.0, 0.2, 0.3}), {1, 2, 3.1})}};
  Observation mug;
  mug.class_id = "mug";
  mug.detector = "dope";
  mug.stamp_s = -0.5;
  mug.components = {{.pose = SE3d()}};
  return {tag, mug};
}

TEST(ObservationCsv, ReadsWhatItWrites) {
  const auto before = observations_of_table();
  const std::string text = format_observations(before);
  EXPECT_EQ(text.substr(0, text.find('\n')), kHeader);
  const auto after = parse_observations(text, "o.csv");
  ASSERT_EQ(after.size(), 2U);
  EXPECT_EQ(after[0].object, "7");
  EXPECT_EQ(after[0].class_id, "");
  EXPECT_EQ(after[0].camera, "left");
  EXPECT_EQ(after[0].stamp_s, before[0].stamp_s);
  ASSERT_EQ(after[0].components.size(), 2U);
  EXPECT_EQ(after[0].components[1].weight, 0.25);
  EXPECT_TRUE(after[0].components[0].pose.is_approx(before[0].components[0].pose, 1e-11));
  EXPECT_LT((*after[0].components[0].covariance - *before[0].components[0].covariance).norm(),
            1e-15);
  EXPECT_FALSE(after[0].components[1].covariance.has_value());
  EXPECT_EQ(after[1].class_id, "mug");
  EXPECT_EQ(after[1].detector, "dope");
  EXPECT_EQ(format_observations(after), text);
}

TEST(ObservationCsv, ClutterAndScoreAreColumnsWhereThereAreSome) {
  auto observations = observations_of_table();
  observations[0].clutter = 0.125;
  observations[1].score = -3.5;
  const std::string text = format_observations(observations);
  EXPECT_TRUE(text.starts_with(std::string(kHeader) + ",clutter,score\n"));
  const auto after = parse_observations(text, "o.csv");
  EXPECT_EQ(after[0].clutter, 0.125);
  EXPECT_FALSE(after[0].score.has_value());
  EXPECT_FALSE(after[1].clutter.has_value());
  EXPECT_EQ(after[1].score, -3.5);
}

TEST(ObservationCsv, AFileMayBeCompressed) {
  const testing::TemporaryFolder folder;
  const std::string text = format_observations(observations_of_table());
  std::ofstream(folder / "o.csv") << text;
  std::ofstream(folder / "o.csv.gz") << gzip(text);
  EXPECT_EQ(format_observations(read_observations(folder / "o.csv")), text);
  EXPECT_EQ(format_observations(read_observations(folder / "o.csv.gz")), text);
}

TEST(ObservationCsv, ErrorsNameTheLineOfTheSighting) {
  EXPECT_INVALID(parse_rows(row("1,,,7,,0,0.5") + row("1,,,7,,0,0.25")),
                 "o.csv:2: in sighting 0, which begins here: the weights of the components sum to "
                 "0.75, expected one");
  EXPECT_INVALID_WITH(parse_rows(row("1,,,7,,0,1") + row("1,,,7,,1,1.5") + row("1,,,7,,1,-0.5")),
                      "o.csv:4: got weight = \"-0.5\", expected zero or more");
  EXPECT_INVALID_WITH(parse_rows(row("1,,,7,,0,nan")), "o.csv:2: ");
  EXPECT_INVALID(
      parse_rows(row("1,,,7,,0,1") + row("1,,,8,,1,1") + row("1,,,7,,0,1")),
      "o.csv:4: got sighting 0 again, expected the rows of a sighting one after the other");
  EXPECT_INVALID_WITH(parse_rows(row("1,,,7,,0,0.5") + row("2,,,7,,0,0.5")),
                      "o.csv:3: got other values for sighting 0");
  EXPECT_INVALID(parse_rows(row("1,,,,,0,1")),
                 "o.csv:2: got neither id nor class, expected one of the two");
  EXPECT_INVALID(parse_rows(row("1,,,7,mug,0,1")),
                 "o.csv:2: got both id and class, expected one of the two");
  EXPECT_INVALID(parse_rows(""), "o.csv: got no rows, expected at least one");
  EXPECT_INVALID_WITH(parse_rows("1,,,7,,0,1,0,0,1,0,0,0,2," + kNoCovariance + "\n"),
                      "o.csv:2: got a quaternion of norm 2");
  EXPECT_INVALID_WITH(parse_rows("1,,,7,,0,1,0,0,1,0,0,0,1,1" + kNoCovariance + "\n"),
                      "o.csv:2: got 20 empty fields of a covariance, expected none or all 21");
  const std::string indefinite = "1,0,0,0,0,0,1,0,0,0,0,1,0,0,0,1,0,0,-1,0,1";
  EXPECT_INVALID_WITH(parse_rows("1,,,7,,0,1,0,0,1,0,0,0,1," + indefinite + "\n"),
                      "o.csv:2: got c44 = -1, expected a variance in [1e-18, 1e+16]");
  EXPECT_INVALID_WITH(parse_observations("stamp_s,camera\n", "o.csv"), "got no column detector");
}

/// The number of a row that is wrong, its column and what is expected.
TEST(ObservationCsv, ErrorsOfNumbersNameRowAndColumn) {
  const std::string good = row("1,,,7,,0,1") + "\n# a comment\n";
  const auto with = [&](const std::string& begin, const std::string& pose,
                        const std::string& covariance = kNoCovariance) {
    return good + begin + "," + pose + "," + covariance + "\n";
  };
  const std::string pose = "0,0,1,0,0,0,1";
  const std::string variances = "1e-4,0,0,0,0,0,1e-4,0,0,0,0,1e-4,0,0,0,1e-4,0,0,1e-4,0,";
  const std::vector<std::pair<std::string, std::string>> cases{
      {with("1e13,,,7,,1,1", pose), "stamp_s = \"1e13\", expected seconds, at most 1e+12"},
      {with("1e999,,,7,,1,1", pose), "stamp_s = \"1e999\", expected a finite number"},
      {with(",,,7,,1,1", pose), "stamp_s = \"\", expected a finite number"},
      {with("2,,,7,,-1,1", pose), "sighting = \"-1\", expected an integer that is not negative"},
      {with("2,,,7,,1.5,1", pose), "sighting = \"1.5\", expected an integer"},
      {with("2,,,7,,99999999999999999999,1", pose), "sighting = \"99999999999999999999\""},
      {with("2,,,7,,1,inf", pose), "weight = \"inf\", expected a finite number"},
      {with("2,,,7,,1,1", "0,-8.2e10,1,0,0,0,1"), "ty_m = \"-8.2e10\", expected metres"},
      {with("2,,,7,,1,1", "0,0,1,0,0,0,0"), "a quaternion of norm 0, expected"},
      {with("2,,,7,,1,1", pose, variances + "nan"), "c55 = \"nan\", expected a finite number"},
      {with("2,,,7,,1,1", pose, variances + "1e-30"), "c55 = 1e-30, expected a variance"},
      {with("2,,,7,,1,1", pose, "1e-4,2e-4" + variances.substr(6) + "1e-4"),
       "a covariance c00 ... c55 that is not positive definite, expected one that is"},
  };
  for (const auto& damaged : cases)
    EXPECT_INVALID_WITH(parse_rows(damaged.first), "o.csv:5: got " + damaged.second);
  const std::string clutter = std::string(kHeader) + ",clutter\n";
  for (const char* value : {"0", "1", "-0.5", "1.5", "0.999999999999"}) {
    EXPECT_INVALID_WITH(
        parse_observations(
            clutter + "1,,,7,,0,1," + pose + "," + kNoCovariance + "," + value + "\n", "o.csv"),
        std::string("o.csv:2: got clutter = \"") + value + "\", expected a probability above 0");
  }
}

TEST(ObservationCsv, ErrorsOfSplitSightingsNameTheRowThatComesLater) {
  EXPECT_INVALID(parse_rows(row("1,,,7,,0,0.5") + row("1,,,8,,1,1") + row("1,,,7,,0,0.5")),
                 "o.csv:4: got sighting 0 again, expected the rows of a sighting one after the "
                 "other");
}

TEST(ObservationCsv, EndsOfLinesAndOrderMarksAreNoContent) {
  const std::string plain = std::string(kHeader) + "\n" + row("1,,,7,,0,1") + row("2,,,8,,1,1");
  std::string crlf = "\xEF\xBB\xBF";
  for (const char c : plain) crlf += c == '\n' ? std::string("\r\n") : std::string(1, c);
  EXPECT_EQ(format_observations(parse_observations(crlf, "o.csv")),
            format_observations(parse_observations(plain, "o.csv")));
  EXPECT_INVALID(parse_observations("", "o.csv"),
                 "o.csv: got no line, expected the names of the columns");
  EXPECT_INVALID_WITH(parse_observations(std::string(kHeader) + ",weight\n", "o.csv"),
                      "o.csv:1: got column \"weight\" again, expected every column once");
  EXPECT_INVALID_WITH(parse_observations(std::string(kHeader) + ",Clutter\n", "o.csv"),
                      "o.csv:1: got column \"Clutter\", expected \"clutter\"");
}

TEST(ObservationCsv, PlaceholdersAreNoCovariance) {
  for (const char* none :
       {"0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0", "1,0,0,0,0,0,1,0,0,0,0,1,0,0,0,1,0,0,1,0,1",
        "-1,0,0,0,0,0,1,0,0,0,0,1,0,0,0,1,0,0,1,0,1"}) {
    const auto read = parse_rows("1,,,7,,0,1,0,0,1,0,0,0,1," + std::string(none) + "\n");
    EXPECT_FALSE(read[0].components[0].covariance.has_value()) << none;
  }
}

TEST(ObservationCsv, TheColumnsOfCovariancesMayBeMissing) {
  const std::string header(kHeader);
  const std::string begin = header.substr(0, header.find(",c00"));
  const std::string rows = "1,,,7,,0,0.5,0,0,1,0,0,0,1\n1,,,7,,0,0.5,0,0,1,0,0,1,0\n";
  const auto read = parse_observations(begin + "\n" + rows, "o.csv");
  ASSERT_EQ(read[0].components.size(), 2U);
  EXPECT_FALSE(read[0].components[0].covariance.has_value());
  EXPECT_INVALID_WITH(parse_observations(begin + ",c00\n", "o.csv"), "got no column c01");
}

TEST(ObservationCsv, RefusesToWriteWhatCannotBeReadBack) {
  auto observations = observations_of_table();
  observations[0].camera = "left, upper";
  EXPECT_INVALID(
      format_observations(observations),
      "the camera of an observation is \"left, upper\", expected one without commas, line "
      "breaks and blanks at its ends");
  observations = observations_of_table();
  observations[0].components.clear();
  EXPECT_INVALID_WITH(format_observations(observations), "has no components");
  observations = observations_of_table();
  observations[1].class_id.clear();
  EXPECT_INVALID(
      format_observations(observations),
      "an observation at stamp -0.5 s has neither id nor class, expected one of the two");
}

TEST(Gzip, GivesBackTheBytesOfItsFiles) {
  const testing::TemporaryFolder folder;
  std::string bytes(1'000'000, 'a');
  for (std::size_t i = 0; i < bytes.size(); i += 7) bytes[i] = static_cast<char>(i % 251);
  // Several members, one after the other, are one file.
  std::ofstream(folder / "two.gz", std::ios::binary) << gzip(bytes) << gzip("end");
  EXPECT_EQ(read_file_or_gzip(folder / "two.gz"), bytes + "end");
  std::ofstream(folder / "plain", std::ios::binary) << "as it is";
  EXPECT_EQ(read_file_or_gzip(folder / "plain"), "as it is");
  std::ofstream(folder / "cut.gz", std::ios::binary) << gzip(bytes).substr(0, 500);
  EXPECT_INVALID_WITH(read_file_or_gzip(folder / "cut.gz"), "got a damaged gzip file");
  std::ofstream(folder / "bad.gz", std::ios::binary) << "\x1f\x8b\x08 no more";
  EXPECT_INVALID_WITH(read_file_or_gzip(folder / "bad.gz"), "got a damaged gzip file");
}

}  // namespace
}  // namespace posemix
