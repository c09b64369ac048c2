// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "posemix/lie/lie.hpp"

/// TUM trajectories: one line `stamp tx ty tz qx qy qz qw` per frame, in seconds, metres and a unit
/// quaternion.
namespace posemix {

/// A pose at a time, or a frame without one.
struct StampedPose {
  double stamp = 0;          ///< seconds
  std::optional<SE3d> pose;  ///< T_a_b of the file's two frames; nothing for a miss
};

/// What a TUM file may hold beside plain poses.
struct TumOptions {
  /// A line whose seven pose numbers are all zero is a frame without a pose (detections); otherwise
  /// an error.
  bool allow_misses = false;
  /// A pose with exactly zero translation is a frame without a pose too (degenerate detections).
  bool zero_translation_is_miss = false;
};

/// The frames of a TUM text in their order; at least one.
///
/// Blank lines and lines that start with '#' are skipped; lines end in LF or CRLF. Stamps must be
/// finite and strictly increasing, a quaternion's norm must be within 1e-2 of one (it is then
/// normalised). Throws InvalidInput `name:line: got ..., expected ...`.
std::vector<StampedPose> parse_tum(std::string_view text, const std::string& name,
                                   const TumOptions& options = {});

/// As parse_tum, for a file.
std::vector<StampedPose> read_tum(const std::filesystem::path& path,
                                  const TumOptions& options = {});

/// How format_tum treats frames without a pose.
enum class TumMisses {
  leave_out,   ///< no line
  write_zeros  ///< the stamp and seven zeros, which parse_tum reads back with allow_misses
};

/// The TUM text of frames: poses with 12 significant digits, stamps with as many digits as it takes
/// to read the same stamp again.
std::string format_tum(std::span<const StampedPose> frames,
                       TumMisses misses = TumMisses::leave_out);

}  // namespace posemix
