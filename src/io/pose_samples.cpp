// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/io/pose_samples.hpp"

#include <array>
#include <cmath>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "csv_table.hpp"
#include "mixture_parts.hpp"
#include "posemix/base/error.hpp"
#include "posemix/io/npy.hpp"
#include "posemix/io/tum.hpp"

namespace posemix {
namespace {

using namespace internal;

constexpr std::size_t kNumbers = 7;

std::array<double, kNumbers> numbers_of(const SE3d& pose) {
  const Eigen::Vector3d& t = pose.translation();
  const Eigen::Quaterniond& q = pose.rotation().quaternion();
  return {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()};
}

PoseSamples parse_table(std::string_view text, const std::string& name,
                        const PoseSampleOptions& options) {
  CsvTable table(text, name);
  const std::string weights = options.weights.value_or("weight");
  const bool weighted = options.weights.has_value() || table.has(weights);
  if (weighted) table.require_column(weights);
  if (options.residuals) {
    table.require_pose("est_");
    table.require_pose("gt_");
  } else {
    table.require_pose("");
  }
  PoseSamples samples;
  while (table.next()) {
    samples.poses.push_back(
        options.residuals ? residual(table.pose("est_"), table.pose("gt_"), *options.residuals)
                          : table.pose(""));
    if (!weighted) continue;
    samples.weights.push_back(table.number(weights));
    if (samples.weights.back() < 0.0) {
      table.reader().fail(fmt::format("{} = {}", weights, samples.weights.back()),
                          "a number of at least zero");
    }
  }
  return samples;
}

SE3d pose_of_row(const double* row, const std::string& where) {
  const Eigen::Vector4d xyzw = Eigen::Map<const Eigen::Vector4d>(row + 3);
  const double norm = xyzw.stableNorm();
  if (!(std::abs(norm - 1.0) <= kQuaternionNormTolerance)) {
    throw InvalidInput(fmt::format("{}: got a quaternion of norm {:.6g}, expected 1 within {:g}",
                                   where, norm, kQuaternionNormTolerance));
  }
  return SE3d(SO3d::from_stored_quaternion(Eigen::Quaterniond(xyzw)),
              Eigen::Map<const Eigen::Vector3d>(row));
}

std::vector<SE3d> parse_array(std::string_view bytes, const std::string& name) {
  const NpyArray array = parse_npy_array(bytes, name);
  const std::vector<std::size_t>& shape = array.shape;
  const bool rows = shape.size() == 2 && shape[1] == kNumbers;
  const bool matrices = shape.size() == 3 && shape[1] == 4 && shape[2] == 4;
  if (!rows && !matrices) {
    throw InvalidInput(
        fmt::format("{}: got an array of {} numbers of another shape, expected (n, 7) or (n, 4, 4)",
                    name, array.values.size()));
  }
  std::vector<SE3d> poses;
  for (std::size_t i = 0; i < shape[0]; ++i) {
    const std::string where = fmt::format("{}[{}]", name, i);
    const double* values = array.values.data() + i * (rows ? kNumbers : 16);
    poses.push_back(
        rows ? pose_of_row(values, where)
             : pose_from_matrix(
                   Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(values), where));
  }
  return poses;
}

std::vector<SE3d> parse_trajectory(std::string_view text, const std::string& name) {
  std::vector<SE3d> poses;
  for (const StampedPose& frame : parse_tum(text, name)) poses.push_back(*frame.pose);
  return poses;
}

void check_samples(const PoseSamples& samples, const std::string& name) {
  if (samples.poses.empty()) {
    throw InvalidInput(fmt::format("{}: got no poses, expected at least one", name));
  }
  for (std::size_t i = 0; i < samples.poses.size(); ++i) {
    if (!is_position(samples.poses[i].translation())) {
      throw InvalidInput(fmt::format("{}: got a position beyond {:g} m in pose {}, expected metres",
                                     name, kFarthestPosition, i));
    }
  }
}

}  // namespace

std::optional<PoseFormat> pose_format_of(std::string_view name) {
  if (name.ends_with(".csv")) return PoseFormat::csv;
  if (name.ends_with(".npy")) return PoseFormat::npy;
  if (name.ends_with(".tum") || name.ends_with(".txt")) return PoseFormat::tum;
  return std::nullopt;
}

SE3d residual(const SE3d& estimate, const SE3d& truth, Side side) {
  return side == Side::left ? estimate * truth.inverse() : truth.inverse() * estimate;
}

PoseSamples parse_pose_samples(std::string_view text, const std::string& name, PoseFormat format,
                               const PoseSampleOptions& options) {
  if (format != PoseFormat::csv && (options.residuals || options.weights)) {
    throw InvalidInput(fmt::format(
        "{}: got a file without columns, expected CSV for residuals and weights", name));
  }
  PoseSamples samples;
  if (format == PoseFormat::csv) {
    samples = parse_table(text, name, options);
  } else {
    samples.poses =
        format == PoseFormat::npy ? parse_array(text, name) : parse_trajectory(text, name);
  }
  check_samples(samples, name);
  return samples;
}

std::string format_poses(std::span<const SE3d> poses, PoseFormat format) {
  if (format == PoseFormat::tum) {
    std::vector<StampedPose> frames;
    for (const SE3d& pose : poses) frames.push_back({static_cast<double>(frames.size()), pose});
    return format_tum(frames);
  }
  if (format == PoseFormat::npy) {
    NpyArray array{{poses.size(), kNumbers}, {}};
    for (const SE3d& pose : poses) {
      const auto numbers = numbers_of(pose);
      array.values.insert(array.values.end(), numbers.begin(), numbers.end());
    }
    return format_npy(array);
  }
  std::string text = "tx,ty,tz,qx,qy,qz,qw\n";
  for (const SE3d& pose : poses) {
    const auto numbers = numbers_of(pose);
    for (std::size_t i = 0; i < kNumbers; ++i) {
      text += fmt::format("{}{}", numbers[i], i + 1 < kNumbers ? "," : "\n");
    }
  }
  return text;
}

}  // namespace posemix
