// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Recordings of any kind as recordings with observations, and rows of result files as mixtures.
#include <fmt/format.h>

#include "io/expect_invalid.hpp"
#include "posemix/config/observation_sequence.hpp"
#include "posemix/io/observation_csv.hpp"
#include "posemix/io/observation_jsonl.hpp"
#include "posemix/slam/job.hpp"
#include "small_sequence.hpp"

namespace posemix {
namespace {

using testing::kSmallFrames;
using testing::kSmallToml;
using testing::replaced;
using testing::SmallFolder;

constexpr std::string_view kGmIekf =
    "[filter]\nmethod = \"gm-iekf\"\nmax_components = 4\ngate_probability = 0.9999\nupdate = "
    "\"linearized\"\n";

class ObservationSequence : public testing::SmallSequence {
 protected:
  /// The document as one with observations, in a folder of its own.
  SlamJob converted(const std::string& text, bool csv) {
    const TomlDocument document = TomlDocument::parse(text, "s.toml");
    const std::vector<std::filesystem::path> folders{small_.folder.path()};
    const SlamJob job = read_slam_job(document, folders);
    const auto observations = observations_of(job.sequence);
    const testing::TemporaryFolder made;
    made.put("o", csv ? format_observations(observations) : format_observation_lines(observations));
    std::string stamps;
    for (const double stamp : job.sequence.stamps) stamps += fmt::format("{}\n", stamp);
    made.put("stamps.txt", stamps);
    text_ =
        format_observation_sequence(document, folders, {csv ? "csv" : "jsonl", "o", "stamps.txt"});
    return read_slam_job(TomlDocument::parse(text_, "sequence.toml"), {made.path()});
  }

  /// The largest difference of camera and objects between two runs.
  static double difference(const SlamJob& a, const SlamJob& b) {
    const SlamRun x = run(a);
    const SlamRun y = run(b);
    EXPECT_EQ(x.frames.size(), y.frames.size());
    double largest = 0.0;
    const auto add = [&](const PoseDensity& p, const PoseDensity& q) {
      largest = std::max({largest, (p.mean().matrix() - q.mean().matrix()).cwiseAbs().maxCoeff(),
                          (p.covariance() - q.covariance()).cwiseAbs().maxCoeff()});
    };
    for (std::size_t k = 0; k < x.frames.size(); ++k) {
      add(x.frames[k].camera, y.frames[k].camera);
      for (std::size_t i = 0; i < x.frames[k].objects.size(); ++i) {
        EXPECT_EQ(x.frames[k].objects[i].has_value(), y.frames[k].objects[i].has_value());
        if (x.frames[k].objects[i] && y.frames[k].objects[i])
          add(*x.frames[k].objects[i], *y.frames[k].objects[i]);
      }
    }
    return largest;
  }

  void expect_same(const std::string& text) {
    const SlamJob job = read(text);
    const SlamJob exact = converted(text, false);
    require_same_frames(job.sequence, exact.sequence);
    EXPECT_EQ(difference(job, exact), 0.0) << text_;
    EXPECT_LT(difference(job, converted(text, true)), 1e-9) << text_;
  }

  std::string text_;
};

TEST_F(ObservationSequence, GivesTheSameEstimatesToTheLastBit) {
  expect_same(replaced(std::string(kSmallToml), kGmIekf, ""));
  EXPECT_EQ(text_.find("detections"), std::string::npos);
  EXPECT_EQ(text_.find("${"), std::string::npos);
  // Of other methods too, which see the best components.
  expect_same(std::string(kSmallToml));
}

TEST_F(ObservationSequence, KeepsFramesInWhichNothingIsSeen) {
  // Without odometry the frames are those of the camera's ground truth, of which every second one
  // has no detection.
  std::string text = replaced(std::string(kSmallToml), kGmIekf, "");
  text = replaced(text, "odometry = \"odometry.txt\"\n", "");
  text.erase(text.find("[[objects]]\nid = \"mug\""),
             text.find("[[objects]]\nid = \"can\"") - text.find("[[objects]]\nid = \"mug\""));
  expect_same(text);
  // Frames that are numbers alone.
  text = replaced(text, "ground_truth = \"truth/${sequence}.txt\"\n", "");
  text = replaced(text, "pose = \"ground_truth\"\n", "");
  text = replaced(text, ", scene = 2", ", scene = 2, min_score = 0.1, first_frame = 1");
  const SlamJob job = read(text);
  const SlamJob exact = converted(text, false);
  EXPECT_EQ(exact.sequence.stamps, job.sequence.stamps);
  EXPECT_EQ(difference(job, exact), 0.0);
}

TEST_F(ObservationSequence, KeepsGapsOfTheOdometry) {
  std::vector<StampedPose> odometry = read_tum(small_.folder / "odometry.txt");
  odometry[5].pose.reset();
  small_.folder.put("odometry.txt", format_tum(odometry, TumMisses::write_zeros));
  expect_same(replaced(std::string(kSmallToml), kGmIekf, ""));
}

TEST_F(ObservationSequence, TakesCandidatesOfAClass) {
  std::string text = replaced(std::string(kSmallToml), kGmIekf, "");
  text.erase(text.find("[[objects]]\nid = \"can\""));
  for (const char* id : {"can_1", "can_2"})
    text += fmt::format("[[objects]]\nid = \"{}\"\nclass = \"can\"\nnoise = \"detector\"\n", id);
  text += "[[candidates]]\nclass = \"can\"\nbop = \"can.csv\"\nscene = 2\nobject = 5\n";
  expect_same(text);
  EXPECT_EQ(text_.find("candidates"), std::string::npos);
}

TEST_F(ObservationSequence, StampsAreForObservationsAlone) {
  small_.folder.put("stamps.txt", "0\n1\n");
  EXPECT_INVALID_WITH(read_changed("[camera]\n", "[camera]\nstamps = \"stamps.txt\"\n"),
                      "is for recordings with [[observations]]");
}

/// Result rows with two poses per image at one place and one at another.
class BopMixtures : public ObservationSequence {
 protected:
  BopMixtures() {
    std::string rows;
    for (std::size_t k = 0; k < kSmallFrames; ++k) {
      const SE3d& pose = small_.recording.detections[2][k];
      const SE3d flipped = pose * SE3d(SO3d::exp({0.0, 0.0, 3.0}), {0.0, 0.0, 0.001});
      rows += SmallFolder::bop_row(k + 1, 0.2, flipped);
      rows += SmallFolder::bop_row(k + 1, 0.6, pose);
      rows += SmallFolder::bop_row(k + 1, 0.1, pose * SE3d(SO3d(), {0.3, 0.0, 0.0}));
    }
    small_.folder.put("can.csv", rows);
    text_with_best_ = replaced(std::string(kSmallToml), kGmIekf, "");
  }

  std::string with_rows(const std::string& rows) const {
    return replaced(text_with_best_, "object = 5}", "object = 5, rows = \"" + rows + "\"}");
  }

  std::string text_with_best_;
};

TEST_F(BopMixtures, RowsAtOnePlaceAreComponents) {
  const SlamJob job = read(with_rows("mixtures"));
  ASSERT_EQ(job.sequence.observations.size(), kSmallFrames);
  const auto& seen = job.sequence.observations[0];
  ASSERT_EQ(seen.size(), 3U);
  EXPECT_EQ(seen[0].object, "mug");
  EXPECT_EQ(seen[2].object, "can");
  EXPECT_EQ(seen[2].class_id, "");
  ASSERT_EQ(seen[2].components.size(), 2U);
  EXPECT_NEAR(seen[2].components[0].weight, 0.75, 1e-12);
  EXPECT_TRUE(seen[2].components[0].pose.is_approx(*job.sequence.objects[2].detections[0], 1e-15));
  EXPECT_EQ(job.sequence.observations[3][0].object, "box");
  EXPECT_EQ(seen[2].stamp_s, job.sequence.stamps[0]);
  const SlamRun result = run(job);
  EXPECT_GE(result.hypotheses[2].size(), 2U);
  // Of other objects nothing changes: their detections are the same.
  expect_same(with_rows("mixtures"));
}

TEST_F(BopMixtures, TheBestRowIsTheDefault) {
  const SlamJob job = read(text_with_best_);
  EXPECT_TRUE(job.sequence.observations.empty());
  EXPECT_EQ(difference(job, read(with_rows("best"))), 0.0);
  EXPECT_INVALID_WITH(read(with_rows("rows")), "rows");
  EXPECT_INVALID_WITH(
      read(replaced(text_with_best_, "object = 5}", "object = 5, same_place_m = 0.1}")),
      "same_place_m");
}

TEST_F(BopMixtures, OtherPlacesAreOtherInstances) {
  std::string text = text_with_best_;
  text.erase(text.find("[[objects]]\nid = \"can\""));
  for (const char* id : {"can_1", "can_2"})
    text += fmt::format("[[objects]]\nid = \"{}\"\nclass = \"can\"\nnoise = \"detector\"\n", id);
  text += "[[candidates]]\nclass = \"can\"\nbop = \"can.csv\"\nscene = 2\nobject = 5\n";
  EXPECT_EQ(read(text).sequence.candidates[0].size(), 3U);
  EXPECT_EQ(read(text + "rows = \"best\"\n").sequence.candidates[0].size(), 1U);
  const SlamJob job = read(text + "rows = \"mixtures\"\n");
  const auto& seen = job.sequence.observations[0];
  ASSERT_EQ(seen.size(), 4U);
  EXPECT_EQ(seen[2].class_id, "can");
  EXPECT_EQ(seen[2].components.size(), 2U);
  EXPECT_EQ(seen[3].components.size(), 1U);
  EXPECT_EQ(seen[2].score, 0.6);
  EXPECT_EQ(
      read(text + "rows = \"mixtures\"\nsame_place_m = 0.0001\n").sequence.observations[0].size(),
      5U);
  const SlamRun result = run(job);
  EXPECT_TRUE(result.frames.back().objects[2].has_value());
  EXPECT_TRUE(result.frames.back().objects[3].has_value());
  expect_same(text + "rows = \"mixtures\"\n");
}

}  // namespace
}  // namespace posemix
