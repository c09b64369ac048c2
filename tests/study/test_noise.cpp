// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "study/noise/study.hpp"

#include <cmath>
#include <regex>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "io/temporary_folder.hpp"
#include "posemix/base/error.hpp"
#include "posemix/base/random.hpp"
#include "posemix/base/units.hpp"
#include "posemix/config/detector_noise.hpp"
#include "posemix/detector/noise_statistics.hpp"
#include "posemix/io/tum.hpp"
#include "posemix/mixture/em.hpp"
#include "posemix/testing/data.hpp"
#include "posemix/testing/expect.hpp"

namespace posemix {
namespace {

using testing::relative_difference;
using testing::thrown_message;

SE3d random_pose(RandomStream& stream) {
  Eigen::VectorXd xi(6);
  stream.fill_normal(xi);
  return SE3d::exp(Vector6d(xi));
}

/// Detections Y = T Exp(n) with a sharp component (weight 0.6; 2 deg, 5 mm) and one with 15 deg
/// about z, in the axes of the frame.
ResidualSet simulated(NoiseFrame frame, std::size_t frames, std::uint64_t seed) {
  RandomStream stream(seed);
  ResidualSet set{
      .detector = "simulated", .object = "cup " + std::to_string(seed), .recording = "1"};
  for (std::size_t i = 0; i < frames; ++i) {
    const SE3d truth = random_pose(stream);
    Eigen::VectorXd n(6);
    stream.fill_normal(n);
    n.head<3>() *= radians(2.0);
    n.tail<3>() *= 5e-3;
    if (stream.uniform() < 0.4) n[2] *= 7.5;
    if (frame == NoiseFrame::camera) {
      n = SE3d(truth.rotation().inverse(), Eigen::Vector3d::Zero()).adjoint() * n;
    }
    const bool seen = i % 10 != 3;
    set.truth.push_back(truth);
    set.detected.push_back(seen ? std::optional(truth * SE3d::exp(Vector6d(n))) : std::nullopt);
  }
  return set;
}

std::string file_of(const StudyReport& report, const std::string& name) {
  for (const StudyFile& f : report.files) {
    if (f.name == name) return f.content;
  }
  return {};
}

StudyReport run_noise(const Study& study) {
  std::vector<std::string> results;
  for (std::size_t i = 0; i < study.items; ++i) results.push_back(study.run_item(i));
  return study.report(results);
}

/// Without the keys that say how errors hang together.
std::string plain_model(const std::string& toml) {
  return std::regex_replace(toml, std::regex("(^|\n)(dependent_frames|bias) = [^\n]*"), "");
}

DetectorNoise read_back(const std::string& toml, const std::string& name) {
  const TomlDocument document = TomlDocument::parse(plain_model(toml), "noise.toml");
  DetectorNoise noise = read_detector_noise(document.root().get_table("noise").get_table(name));
  document.finish();
  return noise;
}

TEST(NoiseStudy, RecoversASimulatedMixture) {
  for (const NoiseFrame frame : {NoiseFrame::object, NoiseFrame::camera}) {
    const NoiseStudySettings settings{
        .fit = {
            .max_components = 3, .restarts = 2, .frame = frame, .clutter = false, .modes = false}};
    const Study study = make_noise_study({.residuals = {simulated(frame, 4000, 1)}}, settings);
    ASSERT_EQ(study.items, 1U);
    const StudyReport report = run_noise(study);
    const DetectorNoise noise =
        read_back(file_of(report, "noise_simulated_cup_1.toml"), "simulated_cup_1");
    ASSERT_EQ(noise.components().size(), 2U);
    const NoiseComponent& sharp = noise.components()[0];
    const NoiseComponent& wide = noise.components()[1];
    EXPECT_EQ(sharp.frame, frame);
    EXPECT_NEAR(sharp.weight, 0.6, 0.05);
    for (Eigen::Index i = 0; i < 6; ++i) {
      const double sd = i < 3 ? radians(2.0) : 5e-3;
      EXPECT_NEAR(std::sqrt(sharp.covariance(i, i)) / sd, 1.0, 0.08);
      EXPECT_NEAR(std::sqrt(wide.covariance(i, i)) / (i == 2 ? 7.5 * sd : sd), 1.0, 0.1);
    }
    const auto rows = nlohmann::json::parse(file_of(report, "study.json"))["rows"];
    ASSERT_EQ(rows.size(), 6U);
    EXPECT_EQ(rows[2]["axis"], "rotation_z");
    EXPECT_EQ(rows[2]["count"], 3600);
    // sd^2 = 0.6 2^2 + 0.4 15^2; kurtosis = 3 (0.6 2^4 + 0.4 15^4) / sd^4
    EXPECT_NEAR(rows[2]["sd"], std::sqrt(92.4), 0.4);
    EXPECT_NEAR(rows[2]["kurtosis"], 3.0 * 20259.6 / (92.4 * 92.4), 0.7);
    EXPECT_NEAR(rows[0]["kurtosis"], 3.0, 0.4);
    EXPECT_NEAR(rows[2]["lag1_autocorrelation"], 0.0, 0.06);
    EXPECT_LT(file_of(report, "noise_simulated_cup_1.svg").find("<svg"), 200U);
  }
}

NoiseStudySettings one_component() {
  return {
      .fit = {.max_components = 1, .frame = NoiseFrame::object, .clutter = false, .modes = false}};
}

TEST(NoiseStudy, HasOneItemPerObjectAndOneForAll) {
  const ResidualSet a = simulated(NoiseFrame::object, 60, 1);
  const ResidualSet b = simulated(NoiseFrame::object, 80, 2);
  const Study study = make_noise_study({.residuals = {a, b, a}}, one_component());
  ASSERT_EQ(study.items, 3U);
  std::vector<std::string> objects;
  std::vector<int> counts;
  for (std::size_t i = 0; i < study.items; ++i) {
    const auto item = nlohmann::json::parse(study.run_item(i));
    objects.push_back(item["object"]);
    counts.push_back(item["axes"][0]["count"]);
  }
  EXPECT_EQ(objects, (std::vector<std::string>{"cup 1", "cup 2", "all"}));
  EXPECT_EQ(counts, (std::vector<int>{108, 72, 180}));
  EXPECT_NE(study.settings, make_noise_study({.residuals = {a, b}}, one_component()).settings);
}

/// A recording on disk, studied from its TUM files and from its sequence file, and the model
/// that comes out put back into the sequence file.
TEST(NoiseStudy, ReadsFilesAndGivesAModelThatSlamReads) {
  const testing::TemporaryFolder folder;
  const ResidualSet set = simulated(NoiseFrame::object, 400, 3);
  std::vector<StampedPose> detections, truth;
  for (std::size_t i = 0; i < 400; ++i) {
    detections.push_back({0.1 * static_cast<double>(i), set.detected[i]});
    truth.push_back({0.1 * static_cast<double>(i), set.truth[i]});
  }
  const auto detected = folder.put("d.txt", format_tum(detections, TumMisses::write_zeros));
  const auto true_file = folder.put("t.txt", format_tum(truth));
  const std::string sequence =
      "schema = 1\n[[objects]]\nid = \"cup\"\nnoise = \"fitted\"\n"
      "detections = {tum = \"d.txt\"}\nground_truth = {relative_tum = \"t.txt\"}\n";
  const auto file_of_sequence = folder.put(
      "s.toml",
      sequence + "[noise.fitted]\ncomponents = [{rotation_sd_deg = 3, translation_sd_m = 1}]\n");

  const auto pair =
      read_noise_data({.detections = detected.string(), .ground_truth = true_file.string()},
                      std::nullopt)
          .residuals;
  const auto by_sequence =
      read_noise_data({.sequences = {file_of_sequence.string()}}, std::nullopt).residuals;
  ASSERT_EQ(pair.size(), 1U);
  ASSERT_EQ(by_sequence.size(), 1U);
  EXPECT_EQ(by_sequence[0].object, "cup");
  for (const ResidualSet* read : {&pair[0], &by_sequence[0]}) {
    ASSERT_EQ(read->detected.size(), 400U);
    for (std::size_t i = 0; i < 400; ++i) {
      ASSERT_EQ(read->detected[i].has_value(), set.detected[i].has_value());
      if (!set.detected[i]) continue;
      ASSERT_TRUE(read->detected[i]->is_approx(*set.detected[i], 1e-9));
      ASSERT_TRUE(read->truth[i]->is_approx(*set.truth[i], 1e-9));
    }
  }

  const Study study =
      make_noise_study({.residuals = by_sequence}, {.fit = {.max_components = 2,
                                                            .restarts = 1,
                                                            .frame = NoiseFrame::object,
                                                            .clutter = false,
                                                            .modes = false}});
  const std::string toml = plain_model(file_of(run_noise(study), "noise_detector_cup.toml"));
  TomlDocument document = TomlDocument::parse(sequence + toml, (folder / "fitted.toml").string());
  document.apply_override("objects.cup.noise=detector_cup");
  const SlamJob job = read_slam_job(document, {folder.path()});
  ASSERT_EQ(job.models.size(), 1U);
  EXPECT_EQ(job.models[0].noise.components().size(), 2U);
  EXPECT_NEAR(job.models[0].noise.components()[0].weight, 0.6, 0.15);
}

TEST(NoiseStudy, FindsModesWithFreeMeans) {
  RandomStream stream(5);
  ResidualSet set{.detector = "d", .object = "o", .recording = "1"};
  const Vector6d mode = radians(1.0) * 90.0 * Vector6d::Unit(1);
  for (int i = 0; i < 3000; ++i) {
    const SE3d truth = random_pose(stream);
    Eigen::VectorXd n(6);
    stream.fill_normal(n);
    const SE3d offset = i % 4 == 0 ? SE3d::exp(mode) : SE3d();
    set.truth.push_back(truth);
    set.detected.push_back(truth * offset * SE3d::exp(Vector6d(0.02 * n)));
  }
  const Study study = make_noise_study({.residuals = {set}}, {.fit = {.max_components = 2,
                                                                      .restarts = 2,
                                                                      .frame = NoiseFrame::object,
                                                                      .full_covariance = true,
                                                                      .free_means = true,
                                                                      .clutter = false,
                                                                      .modes = false}});
  const DetectorNoise noise = read_back(file_of(run_noise(study), "noise_d_o.toml"), "d_o");
  ASSERT_EQ(noise.components().size(), 2U);
  // Clutter is always possible.
  EXPECT_NEAR(noise.clutter().weight, 1e-3, 1e-9);
  EXPECT_NEAR(noise.components()[1].weight, 0.25 * (1.0 - 1e-3), 1e-6);
  EXPECT_LT((noise.components()[1].offset.log() - mode).norm(), 5e-3);
  EXPECT_LT(
      relative_difference(noise.components()[1].covariance, Matrix6d(4e-4 * Matrix6d::Identity())),
      0.2);
}

TEST(NoiseStudy, RefusesBadInput) {
  EXPECT_EQ(thrown_message([] { make_noise_study({}, {}); }),
            "study noise: there are no detections with a truth");
  const ResidualSet set = simulated(NoiseFrame::camera, 30, 1);
  EXPECT_EQ(thrown_message([&] {
              make_noise_study({.residuals = {set}}, {.fit = {.frame = NoiseFrame::camera,
                                                              .free_means = true,
                                                              .clutter = false,
                                                              .modes = false}});
            }),
            "study noise: free means in the camera frame cannot be written as a noise model, "
            "expected means = \"zero\" or frame = \"object\"");
  EXPECT_NE(thrown_message([&] {
              make_noise_study({.residuals = {set}}, {.fit = {.clutter = false}});
            }).find("modes without clutter"),
            std::string::npos);
  ResidualSet few = set;
  for (std::size_t i = 5; i < 30; ++i) few.detected[i] = std::nullopt;
  const Study study = make_noise_study({.residuals = {few}}, {});
  EXPECT_EQ(thrown_message([&] { study.run_item(0); }),
            "study noise: 4 detections of cup 1 with a truth, expected 20");
  const TomlDocument document = TomlDocument::parse("means = \"some\"", "n.toml");
  EXPECT_NE(thrown_message([&] { read_noise_settings(document.root()); }).find("n.toml:1"),
            std::string::npos);
}

/// Figures of the data folder's README for the mug of 0022, against the proxy.
TEST(NoiseStudy, MugOfSequence0022) {
  POSEMIX_REQUIRE_DATA();
  std::vector<ResidualSet> sets = find_noise_data(*testing::data_dir()).residuals;
  std::erase_if(sets, [](const ResidualSet& set) {
    return set.detector != "cosypose" || set.object != "14" || set.recording != "0022";
  });
  if (sets.empty()) GTEST_SKIP() << "no detections of 0022";
  ASSERT_EQ(sets.size(), 1U);
  EXPECT_TRUE(sets[0].proxy);
  std::vector<ResidualTrack> track(1);
  std::vector<Rnd<1>> samples;
  for (std::size_t i = 0; i < sets[0].truth.size(); ++i) {
    if (!sets[0].detected[i]) continue;
    const Vector6d n =
        detection_residual(*sets[0].truth[i], *sets[0].detected[i], NoiseFrame::object);
    track[0].push_back(degrees(n[2]));
    samples.emplace_back(Rnd<1>::Tangent::Constant(degrees(n[2])));
  }
  const AxisStatistics s = axis_statistics(track);
  EXPECT_EQ(s.count, 1152U);
  EXPECT_GT(s.kurtosis, 4.0);
  EXPECT_NEAR(s.rms, 7.67, 0.02);
  EXPECT_NEAR(autocorrelation(track).lag1, 0.84, 0.01);
  RandomStream stream(1);
  const auto fit = fit_mixture<ConcentratedGaussian<Rnd<1>>>(
      samples, {}, {.components = 2, .restarts = 4}, stream);
  const std::size_t sharp =
      fit.mixture[0].density.covariance()(0, 0) < fit.mixture[1].density.covariance()(0, 0) ? 0 : 1;
  EXPECT_NEAR(fit.mixture.weight(sharp), 0.38, 0.03);
  EXPECT_NEAR(std::sqrt(fit.mixture[sharp].density.covariance()(0, 0)), 0.9, 0.1);
  EXPECT_NEAR(std::sqrt(fit.mixture[1 - sharp].density.covariance()(0, 0)), 9.6, 0.3);
}

}  // namespace
}  // namespace posemix
