// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <Eigen/Cholesky>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "io/expect_invalid.hpp"
#include "posemix/testing/data.hpp"
#include "trace_folder.hpp"

/// NEES and NIS in trace.json and in a report.
namespace posemix {
namespace {

using nlohmann::json;
using testing::joint_trace;
using testing::kSmallFrames;
using testing::multi_object_trace;
using testing::ReportTrace;
using testing::SmallResults;
using testing::TraceFolder;

SE3d pose_of(const json& numbers) {
  const auto n = numbers.get<std::vector<double>>();
  return SE3d(SO3d::from_quaternion(Eigen::Quaterniond(n[6], n[3], n[4], n[5])),
              {n[0], n[1], n[2]});
}

/// e^T P^-1 e from the numbers of the file.
double nees_of(const json& track, std::size_t k) {
  Matrix6d covariance;
  std::size_t next = 0;
  for (Eigen::Index i = 0; i < 6; ++i) {
    for (Eigen::Index j = i; j < 6; ++j)
      covariance(i, j) = covariance(j, i) = track["covariance"][k][next++].get<double>();
  }
  const Vector6d e = (pose_of(track["truth"][k]) * pose_of(track["pose"][k]).inverse()).log();
  return e.dot(covariance.ldlt().solve(e));
}

void expect_nees(const json& track, const ReportTrace& packed, const std::string& name) {
  ASSERT_EQ(track["nees"].size(), kSmallFrames) << name;
  std::size_t known = 0;
  for (std::size_t k = 0; k < kSmallFrames; ++k) {
    const bool there = !track["pose"][k].is_null() && !track["truth"][k].is_null();
    ASSERT_EQ(track["nees"][k].is_number(), there) << name << " " << k;
    if (!there) continue;
    const double nees = track["nees"][k];
    // The camera may begin at the truth.
    EXPECT_NEAR(nees, nees_of(track, k), 1e-4 * nees + 1e-9) << name << " " << k;
    EXPECT_NEAR(packed[name + "/nees"][k][0], nees, 2.6e-3 * nees + 1e-9) << name << " " << k;
    ++known;
  }
  EXPECT_GT(known, 10U) << name;
}

TEST(TraceNees, IsThatOfEstimateAndTruth) {
  for (const json& trace : {joint_trace(), multi_object_trace()}) {
    const TraceFolder folder(trace);
    const ReportTrace packed = folder.trace();
    expect_nees(trace["camera"], packed, "camera");
    for (const std::string id : {"mug", "box", "can"}) {
      const json& object = trace["objects"][id];
      for (const std::string kind : {"world", "relative"})
        expect_nees(object[kind], packed, "objects/" + id + "/" + kind);
      EXPECT_EQ(object["nees_dof"], 6);
    }
    EXPECT_EQ(folder.report()["trace"]["nees_dof"], json({{"box", 6}, {"can", 6}, {"mug", 6}}));
  }
}

TEST(TraceNees, HasTheDegreesOfFreedomThatSymmetriesLeave) {
  const SmallResults results(
      {"objects.can.symmetries={axes=[{direction=[0, 0, 1]}]}", "filter={}"});
  const json trace = json::parse(results.files.at("trace.json"));
  EXPECT_EQ(trace["objects"]["can"]["nees_dof"], 5);
  EXPECT_EQ(trace["objects"]["mug"]["nees_dof"], 6);
  double sum = 0.0;
  for (const json& nees : trace["objects"]["can"]["relative"]["nees"])
    if (nees.is_number()) sum += nees.get<double>();
  EXPECT_NEAR(sum / kSmallFrames / 5.0, *results.metrics.objects[2].relative_anees * 1.0,
              0.5 * *results.metrics.objects[2].relative_anees);
}

TEST(TraceNees, IsMissingWithoutTruth) {
  SmallResults results({"filter={}"});
  SlamJob job = *results.job;
  job.sequence.camera_truth.clear();
  for (ObjectRecording& object : job.sequence.objects) {
    object.relative_truth.clear();
    object.world_truth.clear();
  }
  const json trace = json::parse(format_trace(job, *results.slam));
  EXPECT_FALSE(trace["camera"].contains("nees"));
  EXPECT_FALSE(trace["objects"]["mug"]["relative"].contains("nees"));
  EXPECT_FALSE(trace["objects"]["mug"].contains("nees_dof"));
  EXPECT_TRUE(trace["objects"]["mug"].contains("nis"));
  const ReportTrace packed = TraceFolder(trace).trace();
  EXPECT_FALSE(packed.has("camera/nees"));
}

TEST(TraceNis, IsOfDetectionsThatWereUsed) {
  for (const json& trace : {joint_trace(), multi_object_trace()}) {
    const ReportTrace packed = TraceFolder(trace).trace();
    std::size_t used = 0;
    for (const auto& [id, object] : trace["objects"].items()) {
      ASSERT_EQ(object["nis"].size(), kSmallFrames);
      for (std::size_t k = 0; k < kSmallFrames; ++k) {
        const bool there = object["status"][k] == "used";
        ASSERT_EQ(object["nis"][k].is_number(), there) << id << " " << k;
        EXPECT_EQ(packed.masked("objects/" + id + "/mask", k, 8), there) << id << " " << k;
        if (!there) continue;
        const double nis = object["nis"][k];
        EXPECT_GT(nis, 0.0);
        EXPECT_NEAR(packed["objects/" + id + "/nis"][k][0] / nis, 1.0, 2.6e-3);
        ++used;
      }
    }
    EXPECT_GT(used, 40U);
  }
}

TEST(TraceNis, ParticleFiltersHaveNone) {
  const SmallResults results({"filter={method=\"rbpf\", particles=20}"});
  const json trace = json::parse(results.files.at("trace.json"));
  for (const auto& [id, object] : trace["objects"].items()) EXPECT_FALSE(object.contains("nis"));
  EXPECT_EQ(TraceFolder(trace).trace().header("objects/mug/mask")["type"], "uint8");
}

TEST(TraceNis, MustBeADistance) {
  json trace = multi_object_trace();
  trace["objects"]["mug"]["nis"][5] = -1;
  EXPECT_INVALID_WITH(TraceFolder(trace).report(), "objects: mug: nis[5]: got -1");
}

}  // namespace
}  // namespace posemix
