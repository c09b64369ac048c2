// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "posemix/grasp/success_probability.hpp"
#include "posemix/io/mixture_file.hpp"
#include "posemix/reduction/loss.hpp"
#include "study/salt_box/study.hpp"

// Oracle: numpy prototype on the detections before they were rounded to six digits; the rounding
// moves log evidences by up to 0.001 (ChangesLittleWithTheRounding).
namespace posemix {
namespace {

using Eigen::Vector3d;

const SaltBoxStage& stage(const std::vector<SaltBoxStage>& stages, const std::string& name) {
  const auto found =
      std::find_if(stages.begin(), stages.end(), [&](const auto& s) { return s.name == name; });
  EXPECT_NE(found, stages.end()) << name;
  return *found;
}

const std::vector<SaltBoxStage>& example() {
  static const std::vector<SaltBoxStage> stages = run_salt_box(default_salt_box());
  return stages;
}

TEST(SaltBox, AgreesWithTheOracle) {
  const auto& stages = example();
  const SaltBoxStage& two = stage(stages, "fused_l");
  EXPECT_EQ(two.mixture.size(), 49u);
  EXPECT_NEAR(*two.log_evidence, 17.0370, 1e-3);
  std::vector<double> weights;
  for (std::size_t i = 0; i < 49; ++i) weights.push_back(two.mixture.weight(i));
  std::sort(weights.rbegin(), weights.rend());
  const double top[] = {0.203325, 0.116529, 0.098636, 0.092663, 0.086103};
  for (std::size_t i = 0; i < 5; ++i) EXPECT_NEAR(weights[i], top[i], 3e-5);
  double smallest = 0.0;
  for (std::size_t i = 39; i < 49; ++i) smallest += weights[i];
  EXPECT_NEAR(smallest, 6.368e-5, 2e-7);
  EXPECT_EQ(stage(stages, "dropped_l").mixture.size(), 39u);
  EXPECT_EQ(stage(stages, "merged_l").mixture.size(), 10u);
  EXPECT_EQ(stage(stages, "fused_mountain").mixture.size(), 70u);
  EXPECT_NEAR(*stage(stages, "fused_mountain").log_evidence, 19.3303, 1e-3);
}

void expect_spread(const PoseMpg& mixture, const Vector3d& rotation_deg,
                   const Vector3d& translation_mm) {
  const PoseSpread spread = spread_of(mixture);
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(degrees(spread.rotation[i]), rotation_deg[i], 0.015) << i;
    EXPECT_NEAR(1e3 * spread.translation[i], translation_mm[i], 0.06) << i;
  }
}

TEST(SaltBox, HasTheSpreadsOfTheOracle) {
  const auto& stages = example();
  expect_spread(stage(stages, "object_B").mixture, {7.52, 7.52, 3.02}, {4.1, 4.4, 5.4});
  expect_spread(stage(stages, "fused_l").mixture, {5.63, 4.33, 1.41}, {2.1, 3.5, 4.0});
}

/// Angle [deg] and distance [mm] between the mean and the truth.
void expect_error(const PoseMpg& mixture, double rotation_deg, double translation_mm) {
  const SE3d error = salt_box_truth().inverse() * spread_of(mixture).mean;
  EXPECT_NEAR(degrees(error.rotation().angle()), rotation_deg, 0.06);
  EXPECT_NEAR(1e3 * error.translation().norm(), translation_mm, 0.06);
}

TEST(SaltBox, HasTheErrorsOfTheOracle) {
  const auto& stages = example();
  expect_error(stage(stages, "object_B").mixture, 6.4, 3.3);
  expect_error(stage(stages, "object_l").mixture, 12.6, 9.9);
  expect_error(stage(stages, "object_mountain").mixture, 11.2, 10.0);
  expect_error(stage(stages, "fused_l").mixture, 5.1, 2.2);
}

TEST(SaltBox, WithoutReductionTheEvidenceIsTheOracles) {
  const SaltBoxSettings settings = default_salt_box();
  const auto two = fuse(object_mixture(settings, settings.features[0]),
                        object_mixture(settings, settings.features[1]));
  const auto three = fuse(two.density, object_mixture(settings, settings.features[2]));
  EXPECT_EQ(three.density.size(), 343u);
  EXPECT_NEAR(three.log_overlap + gnomonic::kLogHaarPerHalfSphere, 19.350870173, 1e-3);
  expect_spread(three.density, {2.02, 3.45, 0.88}, {1.8, 1.3, 1.7});
  expect_error(three.density, 4.4, 2.7);
}

TEST(SaltBox, ChangesLittleWithTheRounding) {
  double largest = 0.0;
  RandomStream stream(1);
  for (int trial = 0; trial < 20; ++trial) {
    SaltBoxSettings settings = default_salt_box();
    for (SaltBoxFeature& feature : settings.features) {
      const auto rounding = [&] { return 1e-6 * (stream.uniform() - 0.5); };
      Eigen::Vector4d q = feature.detected.rotation().quaternion().coeffs();
      for (double& entry : q) entry += rounding();
      const Vector3d t =
          feature.detected.translation() + Vector3d(rounding(), rounding(), rounding());
      feature.detected = SE3d(SO3d::from_quaternion(Eigen::Quaterniond(q)), t);
    }
    const auto two = fuse(object_mixture(settings, settings.features[0]),
                          object_mixture(settings, settings.features[1]));
    largest = std::max(largest, std::abs(two.log_overlap + gnomonic::kLogHaarPerHalfSphere -
                                         *stage(example(), "fused_l").log_evidence));
  }
  EXPECT_GT(largest, 2e-4);
  EXPECT_LT(largest, 2e-3);
}

TEST(SaltBox, ReductionsLoseWhatTheOracleSays) {
  const PoseMpg& two = stage(example(), "fused_l").mixture;
  const auto loss = [&](PairRule pair, std::size_t keep) {
    const auto reduced = reduce(two, {.prune_below = 0.0,
                                      .drop_smallest = 10,
                                      .max_components = keep,
                                      .pair = pair,
                                      .bound_loss = true});
    RandomStream stream(2);
    const auto measured = measured_loss(two, reduced.mixture, stream);
    EXPECT_LT(measured.value, reduced.report.bounded_loss->merged_kl + 1e-3);
    return measured.value;
  };
  EXPECT_NEAR(loss(PairRule::symmetric_kl, 10), 0.0042, 5e-4);
  EXPECT_NEAR(loss(PairRule::weighted_symmetric_kl, 10), 0.0023, 4e-4);
  EXPECT_NEAR(loss(PairRule::runnalls, 10), 0.0027, 4e-4);
  EXPECT_NEAR(loss(PairRule::symmetric_kl, 1), 0.092, 0.003);
  const auto heaviest =
      reduce(two, {.prune_below = 0.0, .keep_heaviest = 10, .max_components = 10});
  RandomStream stream(4);
  EXPECT_NEAR(measured_loss(two, heaviest.mixture, stream).value, 0.028, 0.0015);
}

TEST(SaltBox, GraspAgreesWithTheOracle) {
  SaltBoxSettings settings = default_salt_box();
  settings.composition = CompositionRule::cubature;
  settings.pair = PairRule::weighted_symmetric_kl;
  const PoseMpg posterior = run_salt_box(settings).back().mixture;
  ASSERT_EQ(posterior.size(), 10u);
  const ToleranceBox box{Vector3d::Constant(radians(5.0)), Vector3d::Constant(0.005)};
  RandomStream stream(3);
  const BestGrasp best = best_grasp(posterior, box, stream);
  const SE3d merged_mean = spread_of(posterior).mean;
  EXPECT_NEAR(success_probability(posterior, box, merged_mean, stream).probability, 0.83832, 0.001);
  EXPECT_NEAR(best.success.probability, 0.83898, 0.001);
  for (const GraspCandidate& candidate : best.candidates) {
    EXPECT_NEAR(candidate.success.probability, best.success.probability, 5e-4);
  }
  EXPECT_LT((best.pose.translation() - Vector3d(0.04226, -0.02906, 0.60074)).norm(), 1e-4);
  const SO3d expected = SO3d::from_quaternion(Eigen::Quaterniond(0.9824, 0.0485, -0.0063, 0.1803));
  EXPECT_LT(degrees((expected.inverse() * best.pose.rotation()).angle()), 0.3);
}

TEST(SaltBoxStudy, WritesItsFiles) {
  SaltBoxSettings settings = default_salt_box();
  settings.trials = 2;
  settings.flags = 3;
  const Study study = make_salt_box_study(settings);
  ASSERT_EQ(study.items, 3u);
  std::vector<std::string> results;
  for (std::size_t i = 0; i < study.items; ++i) results.push_back(study.run_item(i));
  const StudyReport report = study.report(results);
  const auto content = [&](const std::string& name) {
    const auto found = std::find_if(report.files.begin(), report.files.end(),
                                    [&](const auto& file) { return file.name == name; });
    EXPECT_NE(found, report.files.end()) << name;
    return found->content;
  };
  const auto rows = nlohmann::json::parse(content("study.json"));
  ASSERT_EQ(rows.at("rows").size(), example().size());
  for (const auto& row : rows.at("rows")) {
    EXPECT_GT(row.at("rotation_std_deg").get<double>(), 0.5);
    EXPECT_GT(row.at("translation_std_m").get<double>(), 5e-4);
    const bool fused = row.at("stage").get<std::string>().starts_with("fused_");
    EXPECT_EQ(row.at("log_evidence").is_number(), fused);
  }
  const std::string picture = content("flags_fused_l.svg");
  EXPECT_EQ(std::count(picture.begin(), picture.end(), '\0'), 0);
  EXPECT_NE(picture.find("<polygon"), std::string::npos);
  const MixtureFile posterior = parse_mixture(content("posterior.json"), "posterior.json");
  EXPECT_EQ(std::get<ProjectedPoses>(posterior.mixture).size(), 10u);
  for (const auto& row : rows.at("rows")) {
    const std::string name = "mixture_" + row.at("stage").get<std::string>() + ".json";
    const MixtureFile stage = parse_mixture(content(name), name);
    EXPECT_EQ(std::get<ProjectedPoses>(stage.mixture).size(), row.at("components"));
  }
  EXPECT_NE(content("trials.csv").find("shared_view"), std::string::npos);
}

TEST(SaltBoxStudy, FeaturesOfOneViewAreOverconfident) {
  SaltBoxSettings settings = default_salt_box();
  settings.trials = 120;
  const Study study = make_salt_box_study(settings);
  double independent = 0.0, shared = 0.0;
  for (std::size_t item = 1; item <= settings.trials; ++item) {
    const auto trial = nlohmann::json::parse(study.run_item(item));
    const auto squared = [&](const char* tilts) {
      return trial.at(tilts).back().at("squared_rotation").get<double>() /
             static_cast<double>(settings.trials);
    };
    independent += squared("independent");
    shared += squared("shared_view");
  }
  EXPECT_GT(independent, 0.75);  // 400 trials: 0.97
  EXPECT_LT(independent, 1.2);
  EXPECT_GT(shared, independent + 0.12);  // 400 trials: 1.31
}

TEST(SaltBoxSettings, AreReadAndRefused) {
  const auto read = [](const std::string& text) {
    const TomlDocument document = TomlDocument::parse("schema = 1\n" + text, "box.toml");
    document.root().get_integer("schema");
    const SaltBoxSettings settings = read_salt_box_settings(document.root());
    document.finish();
    return settings;
  };
  EXPECT_EQ(read("").features.size(), 3u);
  EXPECT_EQ(read("composition = \"cubature\"\nkeep = 5\n").composition, CompositionRule::cubature);
  const std::string feature =
      "[[features]]\nname = \"a\"\npoint_m = [0, 0, 0]\ndetected_translation_m = [0, 0, 1]\n"
      "detected_quaternion_wxyz = [1, 0, 0, 0]\n";
  EXPECT_THROW(read(feature), InvalidInput);
  EXPECT_THROW(read(feature + feature), InvalidInput) << "two of one name";
  EXPECT_THROW(read("keep = 0\n"), InvalidInput);
  EXPECT_THROW(read("pair = \"nearest\"\n"), InvalidInput);
  EXPECT_THROW(read("tilt_sd_deg = -1\n"), InvalidInput);
}

}  // namespace
}  // namespace posemix
