// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/io/npy.hpp"

#include <limits>

#include <gtest/gtest.h>
#include <Eigen/SVD>

#include "expect_invalid.hpp"
#include "npy_bytes.hpp"
#include "posemix/io/text.hpp"
#include "posemix/testing/data.hpp"
#include "temporary_folder.hpp"

namespace posemix {
namespace {

using testing::npy_bytes;
using testing::NpyForm;

const SE3d kPose = SE3d::exp((SE3d::Tangent() << 0.4, -0.7, 2.1, 0.3, -0.2, 1.1).finished());

TEST(Npy, EveryForm) {
  for (const int version : {1, 2, 3}) {
    for (const bool fortran : {false, true}) {
      const NpyForm wide{.version = version, .fortran = fortran, .wide = true};
      EXPECT_EQ(parse_npy_matrix(npy_bytes(kPose.matrix(), wide), "m"), kPose.matrix());
      const NpyForm narrow{.version = version, .fortran = fortran};
      const Eigen::Matrix4d rounded = kPose.matrix().cast<float>().cast<double>();
      EXPECT_EQ(parse_npy_matrix(npy_bytes(kPose.matrix(), narrow), "m"), rounded);
    }
  }
}

TEST(Npy, RoundedRotationBecomesTheNearest) {
  const Eigen::Matrix4d rounded = kPose.matrix().cast<float>().cast<double>();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(rounded.topLeftCorner<3, 3>(),
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix3d nearest = svd.matrixU() * svd.matrixV().transpose();
  const SE3d pose = parse_npy_pose(npy_bytes(kPose.matrix(), {}), "m");
  EXPECT_LT((pose.rotation().matrix() - nearest).norm(), 1e-14);
  EXPECT_TRUE(pose.is_approx(kPose, 1e-6));
}

TEST(Npy, HeaderVariantsOfOtherWriters) {
  const auto with_header = [](std::string_view header) {
    return npy_bytes(kPose.matrix(), {.header = std::string(header)});
  };
  EXPECT_NO_THROW(parse_npy_matrix(
      with_header("{\"shape\": (4,4), \"fortran_order\": False, \"descr\": \"<f4\"}\n"), "m"));
  EXPECT_INVALID_WITH(
      parse_npy_matrix(with_header("{'descr': '>f4', 'fortran_order': False, 'shape': (4, 4)}"),
                       "m"),
      "m: got numbers of type \">f4\", expected '<f4' or '<f8'");
  EXPECT_INVALID_WITH(
      parse_npy_matrix(with_header("{'descr': '<f4', 'fortran_order': False, 'shape': (16,)}"),
                       "m"),
      "got the shape \"(16,)\", expected (4, 4)");
  EXPECT_INVALID_WITH(
      parse_npy_matrix(with_header("{'descr': '<f4', 'fortran_order': 0, 'shape': (4, 4)}"), "m"),
      "got fortran_order \"0\", expected True or False");
  EXPECT_INVALID_WITH(parse_npy_matrix(with_header("{'descr': '<f4', 'shape': (4, 4)}"), "m"),
                      "got a header without 'fortran_order'");
  EXPECT_INVALID_WITH(
      parse_npy_matrix(
          with_header("{'descr': '<f4', 'fortran_order': False, 'shape': (4, 4), 'x': 1}"), "m"),
      "got unknown keys in the header");
}

TEST(Npy, BrokenHeaders) {
  for (const char* header :
       {" ", "{", "}", "{'descr'", "{'descr': ", "{'descr': '<f4", "{'descr' '<f4'}",
        "{'shape': (4, 4", "{1: 2}", "{'descr': '<f4' 'fortran_order': False}",
        "{'descr': '<f4', 'descr': '<f4'}",
        "{'descr': '<f4', 'fortran_order': False, 'shape': (4, 4)} x"}) {
    const std::string bytes = npy_bytes(kPose.matrix(), {.header = header});
    EXPECT_INVALID_WITH(parse_npy_matrix(bytes, "m"), "in the header");
  }
}

TEST(Npy, EveryTruncationIsAnError) {
  for (const int version : {1, 2}) {
    const std::string bytes = npy_bytes(kPose.matrix(), {.version = version});
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      EXPECT_INVALID_WITH(parse_npy_pose(std::string_view(bytes).substr(0, size), "cut.npy"),
                          "cut.npy: got ");
    }
    EXPECT_INVALID_WITH(parse_npy_pose(bytes + "x", "m"), "of header, 64 of data)");
  }
  const std::string bytes = npy_bytes(kPose.matrix(), {});
  EXPECT_INVALID(parse_npy_pose(bytes.substr(0, 150), "cut.npy"),
                 "cut.npy: got 150 bytes, expected 192 (128 of header, 64 of data)");
}

TEST(Npy, OtherContents) {
  EXPECT_INVALID_WITH(parse_npy_pose("0 1 2 3 0 0 0 1\n", "t.npy"),
                      "t.npy: got \"0 1 2 \", expected a NumPy file");
  std::string bytes = npy_bytes(kPose.matrix(), {});
  bytes[6] = 4;
  EXPECT_INVALID_WITH(parse_npy_pose(bytes, "m"),
                      "m: got NumPy format 4.0, expected 1.0, 2.0 or 3.0");
}

TEST(Npy, MatricesThatAreNoPose) {
  const auto message_of = [](const Eigen::Matrix4d& matrix) {
    return testing::invalid_input_message(
        [&] { parse_npy_pose(npy_bytes(matrix, {.wide = true}), "m.npy"); });
  };
  Eigen::Matrix4d matrix = kPose.matrix();
  matrix(1, 2) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(message_of(matrix).starts_with("m.npy: ")) << message_of(matrix);
  matrix = kPose.matrix();
  matrix(3, 0) = 0.1;
  EXPECT_NE(message_of(matrix).find("last row"), std::string::npos);
  matrix = kPose.matrix();
  matrix.topLeftCorner<3, 3>() *= 1.001;
  EXPECT_NE(message_of(matrix).find("not orthonormal"), std::string::npos);
  matrix = kPose.matrix();
  matrix.col(0) *= -1;
  EXPECT_NE(message_of(matrix).find("reflection"), std::string::npos);
  EXPECT_NE(message_of(Eigen::Matrix4d::Zero()), "(no InvalidInput)");
}

TEST(NpyDetections, FramesFromFileNames) {
  const testing::TemporaryFolder folder;
  const std::string bytes = npy_bytes(kPose.matrix(), {});
  folder.put("obj_000014_000223.npy", bytes);
  folder.put("obj_000014_1000000.npy", bytes);
  folder.put("obj_000015_000001.npy", "another object");
  folder.put("obj_000014_000009.txt", "another format");
  const auto poses = read_npy_detections(folder.path(), "obj_000014_");
  ASSERT_EQ(poses.size(), 2U);
  EXPECT_TRUE(poses.contains(223));
  EXPECT_TRUE(poses.at(1000000).is_approx(kPose, 1e-6));
}

TEST(NpyDetections, BadFolders) {
  const testing::TemporaryFolder folder;
  const std::string bytes = npy_bytes(kPose.matrix(), {});
  EXPECT_INVALID(read_npy_detections(folder.path(), "obj_"),
                 folder.path().string() + ": got no file obj_<number>.npy, expected at least one");
  EXPECT_INVALID_WITH(read_npy_detections(folder / "none", "obj_"),
                      "none: cannot be read: No such file");
  folder.put("a_01.npy", bytes);
  folder.put("a_1.npy", bytes);
  EXPECT_INVALID_WITH(read_npy_detections(folder.path(), "a_"),
                      "a_1.npy: got frame 1 again, expected one file");
  for (const char* name : {"b_.npy", "c_000001_7.npy", "d_-3.npy", "e_0.npy", "f_1x.npy",
                           "g_99999999999999999999.npy"}) {
    folder.put(name, bytes);
    EXPECT_INVALID_WITH(read_npy_detections(folder.path(), std::string(name, 2)),
                        std::string(name) + ": got \"");
  }
  folder.put("h_1.npy", bytes.substr(0, 100));
  EXPECT_INVALID_WITH(read_npy_detections(folder.path(), "h_"),
                      "h_1.npy: got 100 bytes, expected at least the 128");
}

TEST(NpyData, CosyPoseDetections) {
  POSEMIX_REQUIRE_DATA();
  const auto folder = *testing::data_dir() / "midway/cosypose/0022";
  EXPECT_EQ(read_npy_detections(folder, "obj_000004_").size(), 1152U);
  EXPECT_EQ(read_npy_detections(folder, "obj_000006_").size(), 1152U);
  EXPECT_EQ(read_npy_detections(folder, "obj_000008_").size(), 1142U);
  const auto mug = read_npy_detections(folder, "obj_000014_");
  EXPECT_EQ(mug.size(), 1152U);
  EXPECT_EQ(mug.begin()->first, 1);
  EXPECT_EQ(mug.rbegin()->first, 1152);
  for (const auto& [frame, pose] : mug) {
    EXPECT_GT(pose.translation().z(), 0.3) << frame;
    EXPECT_LT(pose.translation().norm(), 2) << frame;
  }
}

}  // namespace
}  // namespace posemix
