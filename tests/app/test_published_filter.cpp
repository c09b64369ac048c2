// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "posemix/base/units.hpp"
#include "posemix/config/sequence_file.hpp"
#include "posemix/io/text.hpp"
#include "posemix/io/tum.hpp"
#include "posemix/results/results.hpp"
#include "posemix/testing/data.hpp"

/// configs/ycbv-0022-paper.toml against the published filter of the midway-merge paper, frame by
/// frame.
namespace posemix {
namespace {

constexpr double kTolerance = 1e-6;
const std::vector<std::string> kIds{"4", "6", "8", "14"};

/// One line of 0022_reference_filter.csv.
class ReferenceFrame {
 public:
  ReferenceFrame(const std::vector<std::string_view>& names,
                 const std::vector<std::string_view>& fields) {
    for (std::size_t i = 0; i < names.size(); ++i)
      values_[std::string(names[i])] = *parse_number(fields[i]);
  }

  double at(const std::string& name) const { return values_.at(name); }
  std::size_t count(const std::string& name) const { return static_cast<std::size_t>(at(name)); }

  SE3d pose(const std::string& body) const {
    const Eigen::Quaterniond q(at(body + "_qw"), at(body + "_qx"), at(body + "_qy"),
                               at(body + "_qz"));
    return SE3d(SO3d::from_quaternion(q), {at(body + "_tx"), at(body + "_ty"), at(body + "_tz")});
  }

  Vector6d sd(const std::string& body) const {
    Vector6d sd;
    for (int i = 0; i < 6; ++i) sd[i] = at(body + "_sd" + std::to_string(i));
    return sd;
  }

 private:
  std::map<std::string, double> values_;
};

std::vector<ReferenceFrame> read_reference(const std::filesystem::path& path) {
  const std::string text = read_file(path);
  LineReader reader(text, path.string());
  std::vector<std::string_view> names;
  std::vector<ReferenceFrame> frames;
  while (reader.next_content()) {
    const auto fields = split_fields(reader.line(), ',');
    if (names.empty()) {
      names = fields;
    } else {
      frames.emplace_back(names, fields);
    }
  }
  return frames;
}

struct PaperRun {
  SlamJob job;
  SlamRun run;
  Metrics metrics;
};

PaperRun run_paper_profile(const std::vector<std::string>& overrides = {}) {
  const std::filesystem::path config = POSEMIX_SOURCE_DIR "/configs/ycbv-0022-paper.toml";
  TomlDocument document = TomlDocument::load(config);
  for (const std::string& each : overrides) document.apply_override(each);
  SlamJob job = read_slam_job(document, data_folders(config, testing::data_dir()));
  SlamRun result = run(job.sequence, job.camera_prior, job.models, job.settings);
  Metrics metrics = evaluate(job.sequence, result);
  return {std::move(job), std::move(result), std::move(metrics)};
}

const PaperRun& paper() {
  static const PaperRun run = run_paper_profile();
  return run;
}

/// Largest difference of two poses in metres and radians.
double difference(const SE3d& a, const SE3d& b) {
  return std::max((a.translation() - b.translation()).norm(),
                  (a.rotation() * b.rotation().inverse()).log().norm());
}

TEST(PublishedFilter, TheNumbersOfThePaper) {
  POSEMIX_REQUIRE_DATA();
  const Metrics& metrics = paper().metrics;
  EXPECT_EQ(metrics.frames, 1152U);
  EXPECT_NEAR(*metrics.camera.position_log_rmse_m, 0.02823, 0.00002);
  EXPECT_NEAR(*metrics.camera.rotation_rmse_deg, 1.823, 0.002);
  EXPECT_NEAR(*metrics.objects[3].relative.rotation_rmse_deg, 2.802, 0.001);
  RecordProperty("position_log_rmse_m", std::to_string(*metrics.camera.position_log_rmse_m));
}

TEST(PublishedFilter, EveryFrameOfTheFilesAgrees) {
  POSEMIX_REQUIRE_DATA();
  const auto reference = read_reference(*testing::data_dir() / "derived/0022_reference_filter.csv");
  ASSERT_EQ(reference.size(), 1151U);
  std::map<std::string, std::string> files;
  for (auto& [name, text] : format_results(paper().job, paper().run, paper().metrics))
    files[name] = text;
  double worst = 0.0;
  const auto compare = [&](const std::string& file, const std::string& body) {
    const auto estimates = parse_tum(files.at(file), file);
    ASSERT_EQ(estimates.size(), 1152U);
    for (const ReferenceFrame& frame : reference) {
      const StampedPose& estimate = estimates[frame.count("frame") - 1];
      worst = std::max(worst, difference(*estimate.pose, frame.pose(body)));
    }
  };
  compare("camera.tum", "camera");
  for (const std::string& id : kIds) compare("object_" + id + ".tum", "obj" + id);
  EXPECT_LT(worst, kTolerance);
}

TEST(PublishedFilter, EveryStandardDeviationAndCountAgrees) {
  POSEMIX_REQUIRE_DATA();
  const auto reference = read_reference(*testing::data_dir() / "derived/0022_reference_filter.csv");
  double worst = 0.0;
  const auto compare = [&](const PoseDensity& estimate, const Vector6d& sd) {
    worst =
        std::max(worst, (estimate.covariance().diagonal().cwiseSqrt() - sd).cwiseAbs().maxCoeff());
  };
  for (const ReferenceFrame& frame : reference) {
    const FrameEstimate& estimate = paper().run.frames[frame.count("frame") - 1];
    compare(estimate.camera, frame.sd("camera"));
    for (std::size_t i = 0; i < kIds.size(); ++i)
      compare(*estimate.objects[i], frame.sd("obj" + kIds[i]));
    ASSERT_EQ(estimate.report.update.reductions.size(), 1U);
    const ReductionReport& reduction = estimate.report.update.reductions[0];
    EXPECT_EQ(reduction.components_before - reduction.components_pruned,
              frame.count("components_before_reduction"));
    EXPECT_EQ(reduction.components_after, frame.count("components_after"));
    EXPECT_EQ(reduction.merges.size(), frame.count("merges"));
  }
  EXPECT_LT(worst, kTolerance);
}

TEST(PublishedFilter, TangentOfLargerDiffersLittle) {
  POSEMIX_REQUIRE_DATA();
  const PaperRun other = run_paper_profile({"filter.merge_rule=tangent_of_larger"});
  const auto compare = [](const char* what, double midway, double tangent) {
    std::printf("%s: midway %.12g, tangent of larger %.12g, difference %.3g\n", what, midway,
                tangent, tangent - midway);
    EXPECT_NEAR(midway, tangent, 1e-6);
  };
  compare("camera position_log [m]", *paper().metrics.camera.position_log_rmse_m,
          *other.metrics.camera.position_log_rmse_m);
  compare("camera rotation [deg]", *paper().metrics.camera.rotation_rmse_deg,
          *other.metrics.camera.rotation_rmse_deg);
  compare("mug relative rotation [deg]", *paper().metrics.objects[3].relative.rotation_rmse_deg,
          *other.metrics.objects[3].relative.rotation_rmse_deg);
}

}  // namespace
}  // namespace posemix
