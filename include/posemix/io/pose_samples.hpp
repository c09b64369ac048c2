// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "posemix/base/words.hpp"
#include "posemix/io/mixture_file.hpp"
#include "posemix/lie/lie.hpp"

/// Lists of poses: samples of a density, or points at which to ask for one.
namespace posemix {

/// How a file holds poses.
enum class PoseFormat {
  tum,  ///< lines `stamp tx ty tz qx qy qz qw`
  csv,  ///< a header and columns tx, ty, tz, qx, qy, qz, qw
  npy   ///< shape (n, 7), rows as in csv, or (n, 4, 4)
};

/// The words of PoseFormat in files and options.
template <>
inline constexpr WordTable<PoseFormat, 3> words<PoseFormat>{{
    {"csv", PoseFormat::csv},
    {"tum", PoseFormat::tum},
    {"npy", PoseFormat::npy},
}};

/// The format that the end of a file's name says: .csv, .npy, .tum or .txt.
std::optional<PoseFormat> pose_format_of(std::string_view name);

/// Poses with weights; no weights: all count the same.
struct PoseSamples {
  std::vector<SE3d> poses;
  std::vector<double> weights;
};

/// What a reader takes from a file of poses.
struct PoseSampleOptions {
  /// Residuals of estimates `est_tx` ... `est_qw` to truths `gt_tx` ... `gt_qw` of one CSV file, in
  /// place of poses: left est gt^-1 (errors in the reference frame), right gt^-1 est.
  std::optional<Side> residuals = {};
  /// Column of the weights of a CSV file; without it `weight` where there is such a column.
  std::optional<std::string> weights = {};
};

/// The residual of an estimate: left est truth^-1, right truth^-1 est.
SE3d residual(const SE3d& estimate, const SE3d& truth, Side side);

/// Poses, metres, at least one. Other columns of a CSV file are not looked at. `name` stands for
/// the file in messages.
/// @throws InvalidInput `name:line: got ..., expected ...`: a column that is missing, a value that
/// is no finite number, a negative weight, a quaternion whose norm is further than 1e-2 from one, a
/// matrix that is no pose, a position beyond 1e8 m, no pose; options that the format does not have
PoseSamples parse_pose_samples(std::string_view text, const std::string& name, PoseFormat format,
                               const PoseSampleOptions& options = {});

/// The bytes of a file of poses. Numbers of csv and npy read back bit by bit; tum has 12
/// significant digits and the stamps 0, 1, 2, ...
std::string format_poses(std::span<const SE3d> poses, PoseFormat format);

}  // namespace posemix
