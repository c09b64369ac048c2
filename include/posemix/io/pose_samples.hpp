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

/// Lists of poses: samples of a density, or points at which to evaluate one.
namespace posemix {

/// The format of a file with poses.
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

/// The format that the extension of a file's name stands for: .csv, .npy, .tum or .txt.
std::optional<PoseFormat> pose_format_of(std::string_view name);

/// Poses with weights; without weights all count equally.
struct PoseSamples {
  std::vector<SE3d> poses;
  std::vector<double> weights;
};

/// Options for reading a file of poses.
struct PoseSampleOptions {
  /// Read residuals of estimates `est_tx` ... `est_qw` with respect to truths `gt_tx` ... `gt_qw`
  /// of one CSV file, instead of poses: left est gt^-1 (errors in the reference frame), right gt^-1
  /// est.
  std::optional<Side> residuals = {};
  /// Name of the column of weights in a CSV file; by default `weight`, if there is such a column.
  std::optional<std::string> weights = {};
};

/// The residual of an estimate: left est truth^-1, right truth^-1 est.
SE3d residual(const SE3d& estimate, const SE3d& truth, Side side);

/// Reads poses (metres), at least one. Other columns of a CSV file are ignored. `name` is the name
/// of the file in messages.
/// @throws InvalidInput `name:line: got ..., expected ...`: a column that is missing, a value that
/// is not a finite number, a negative weight, a quaternion whose norm differs from one by more than
/// 1e-2, a matrix that is not a pose, a position beyond 1e8 m, no pose; options that the format
/// does not have
PoseSamples parse_pose_samples(std::string_view text, const std::string& name, PoseFormat format,
                               const PoseSampleOptions& options = {});

/// The bytes of a file of poses. Numbers of csv and npy are read back bit by bit; tum has 12
/// significant digits and the stamps 0, 1, 2, ...
std::string format_poses(std::span<const SE3d> poses, PoseFormat format);

}  // namespace posemix
