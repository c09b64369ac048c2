// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

#include "io/npy_bytes.hpp"
#include "posemix/config/toml_table.hpp"
#include "posemix/io/bop.hpp"
#include "posemix/io/npy.hpp"
#include "posemix/io/object_poses.hpp"
#include "posemix/io/tum.hpp"
#include "posemix/io/tum_covariance.hpp"
#include "posemix/slam/consistency.hpp"
#include "posemix/testing/mutate.hpp"

namespace posemix {
namespace {

using testing::fuzz;
using testing::FuzzReport;

constexpr std::size_t kDamagedFiles = 10000;

const std::vector<std::string> kTum{
    "# stamp tx ty tz qx qy qz qw\n"
    "0.0 -0.174718 -0.77447 0.750517 -0.889809099865 0.041161664042 -0.037258627222 "
    "0.452942908002\n"
    "0.1 -0.174335 -0.774839 0.750842 -0.88993160312 0.040002164846 -0.036361173611 "
    "0.452879049669\n"
    "0.2 0.0 0.0 0.0 0.0 0.0 0.0 0.0\n"
    "0.3 -0.173147 -0.775490 0.750877 -0.890001646406 0.03987445041 -0.035327700204 "
    "0.452834463351\n",
    "1700000000.25 1 2 3 0 0 0 1\r\n1700000000.5 1 2 3 0 0 0 1\r\n\r\n1700000000.75 1 2 3 0 1 0 0"};

const std::vector<std::string> kBop{
    "scene_id,im_id,obj_id,score,R,t,time\n"
    "2,3,5,1.0,-0.47162949 -0.88175398 0.00867902 -0.84637999 0.44990361 -0.285003 0.24739818 "
    "-0.14176183 "
    "-0.958487,9.87377756 -63.12937739 783.01941078,1.0\n"
    "2,4,5,0.5,1 0 0 0 1 0 0 0 1,0 0 500,-1\n",
    "2,3,5,1,0 -1 0 1 0 0 0 0 1,1 2 3,1\r\n2,3,5,0.25,1 0 0 0 1 0 0 0 1,1 2 3,1"};

const std::vector<std::string> kObjects{
    "# id tx ty tz qx qy qz qw\n4 0.0095 -0.0187 0.076 0.02560949 0.02645996 0.79530443 0.6050908\n"
    "mug -0.0058 -0.1359 0.0377 0 0 0 1\n"};

const std::vector<std::string> kToml{
    R"(title = "demo"  # a comment
object = "003_cracker_box"
[odometry]
path = "odom/${object}/0001.txt"
sd_deg = [0.13, 0.13, 0.13]
sd_m = [0.0017, 1.7e-3, 0.0017]
[filter]
gate = 0.99
components = 16
joint = true
rule = "midway"
[noise.mug]
weights = [0.38, 0.62]
covariance = [[1.0, 0.5], [0.5, 2.0]]
[[objects]]
id = "mug"
detections = { kind = "npy", prefix = "obj_000014_" }
[[objects]]
id = "can"
detections = { kind = 'bop', scene = 48, first = 1979-05-27T07:32:00Z }
)",
    "a.b.c = 1\r\n[x.\"y z\"]\r\nt = '''\r\nlines\r\n'''\r\nh = 0xff\r\nu = \"\\u00e9\\n\"\r\n"};

void require(bool holds, const char* what) {
  if (!holds) throw std::logic_error(what);
}

void require_pose(const SE3d& pose) {
  require(pose.translation().allFinite(), "a translation that is not finite");
  require(std::abs(pose.rotation().quaternion().norm() - 1) < 1e-12,
          "a quaternion that is not unit");
}

/// Reads the keys of a sequence file leniently, so that damage of every kind reaches a getter.
void read_every_way(const TomlTable& table) {
  enum class Word { one, two };
  const auto attempt = [](auto read) {
    try {
      read();
    } catch (const InvalidInput&) {
    }
  };
  for (const std::string& key : table.keys()) {
    attempt([&] { require(std::isfinite(table.get_double(key)), "a number that is not finite"); });
    attempt([&] { require(table.get_double(key, kUnitInterval) <= 1, "a number out of range"); });
    attempt([&] { require(table.get_integer(key, kAtLeastOne) >= 1, "an integer out of range"); });
    attempt([&] { table.get_bool(key); });
    attempt([&] { table.get_string(key); });
    attempt([&] { table.get_strings(key); });
    attempt([&] { table.get_enum<Word>(key, {{"midway", Word::one}, {"npy", Word::two}}); });
    attempt([&] { require(table.get_vector(key).allFinite(), "a vector that is not finite"); });
    attempt([&] { table.get_matrix(key, 2, 2); });
    attempt([&] { read_every_way(table.get_table(key)); });
    attempt([&] {
      for (const TomlTable& item : table.get_tables(key)) read_every_way(item);
    });
  }
}

void expect_sound(const FuzzReport& report, std::size_t least_of_each) {
  EXPECT_TRUE(report.failures.empty())
      << report.failures.size() << " failures, the first: " << report.failures[0];
  EXPECT_GT(report.accepted, least_of_each);
  EXPECT_GT(report.rejected, least_of_each);
}

TEST(DamagedIo, Tum) {
  const auto parse = [](const std::string& text) {
    const auto frames = parse_tum(text, "f", {.allow_misses = true});
    require(!frames.empty(), "no frames");
    double last = -INFINITY;
    for (const StampedPose& frame : frames) {
      require(std::isfinite(frame.stamp) && frame.stamp > last, "stamps that do not increase");
      last = frame.stamp;
      if (frame.pose) require_pose(*frame.pose);
    }
    const auto again =
        parse_tum(format_tum(frames, TumMisses::write_zeros), "f", {.allow_misses = true});
    require(again.size() == frames.size(), "another number of frames after writing");
  };
  expect_sound(fuzz(kTum, kDamagedFiles, 1, parse), 100);
}

TEST(DamagedIo, TumWithCovariancesAndTheirConsistency) {
  const std::string upper = " 1e-4 0 0 0 0 2e-5 4e-4 0 0 0 0 1e-4 0 0 0 1e-4 0 0 9e-4 0 1e-4\n";
  const std::vector<std::string> texts{"0 1 2 3 0 0 0 1" + upper + "0.1 1 2 3 0 0 0.6 0.8" + upper +
                                       "0.2 1 2 4 0 0 0 1" + upper};
  const auto parse = [](const std::string& text) {
    const auto frames = parse_tum_covariance(text, "f", CovarianceConvention::ros());
    require(!frames.empty(), "no frames");
    std::vector<EstimateWithTruth> series;
    for (const StampedDensity& frame : frames) {
      require_pose(frame.density.mean());
      require(frame.density.covariance().allFinite(), "a covariance that is not finite");
      series.push_back({frame.stamp, frame.density, SE3d(SO3d(), {1, 2, 3})});
    }
    require(!consistency_of(series).findings.empty(), "nothing found");
  };
  expect_sound(fuzz(texts, kDamagedFiles, 5, parse), 100);
}

TEST(DamagedIo, Bop) {
  const auto parse = [](const std::string& text) {
    for (const auto& [image, poses] : parse_bop(text, "f", {2, 5})) {
      require(image >= 0 && !poses.empty(), "an image without poses");
      for (const ScoredPose& each : poses) require_pose(each.pose);
    }
  };
  expect_sound(fuzz(kBop, kDamagedFiles, 2, parse), 100);
}

TEST(DamagedIo, ObjectPoses) {
  const auto parse = [](const std::string& text) {
    for (const auto& [id, pose] : parse_object_poses(text, "f")) require_pose(pose);
  };
  expect_sound(fuzz(kObjects, kDamagedFiles, 3, parse), 100);
}

TEST(DamagedIo, Npy) {
  const SE3d pose = SE3d::exp((SE3d::Tangent() << 0.4, -0.7, 2.1, 0.3, -0.2, 1.1).finished());
  std::vector<std::string> originals;
  for (const int version : {1, 2, 3}) {
    originals.push_back(
        testing::npy_bytes(pose.matrix(), {.version = version, .fortran = version == 2}));
    originals.push_back(testing::npy_bytes(pose.matrix(), {.version = version, .wide = true}));
  }
  expect_sound(fuzz(originals, kDamagedFiles, 4,
                    [](const std::string& bytes) { require_pose(parse_npy_pose(bytes, "f")); }),
               100);
}

TEST(DamagedIo, Toml) {
  const auto parse = [](const std::string& text) {
    const TomlDocument document = TomlDocument::parse(text, "f");
    read_every_way(document.root());
    document.finish();
  };
  expect_sound(fuzz(kToml, kDamagedFiles, 5, parse), 100);
}

TEST(DamagedIo, TomlOverrides) {
  const std::vector<std::string> assignments{"filter.gate=0.99", "objects.0.id=cup",
                                             "objects.mug.detections.kind='bop'",
                                             "noise.mug.weights=[0.5, 0.5]", "\"a.b\".c={d = 1}"};
  const auto parse = [](const std::string& assignment) {
    TomlDocument document = TomlDocument::parse(kToml[0], "f");
    document.apply_override(assignment);
    read_every_way(document.root());
    document.finish();
  };
  expect_sound(fuzz(assignments, kDamagedFiles / 5, 6, parse), 100);
}

}  // namespace
}  // namespace posemix
