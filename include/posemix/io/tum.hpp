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

/// A pose at a time; a frame of a detector may have none.
struct StampedPose {
  double stamp = 0;  ///< seconds
  /// T_a_b for the two frames of the file; empty for a frame without a pose.
  std::optional<SE3d> pose;
};

/// Options for reading a TUM file that has frames without a pose.
struct TumOptions {
  /// A line whose seven pose numbers are all zero is a frame without a pose (detections); without
  /// this option it is an error.
  bool allow_misses = false;
  /// A pose with exactly zero translation is also a frame without a pose (degenerate detections).
  bool zero_translation_is_miss = false;
};

/// Reads the frames of a TUM text in their order; at least one.
///
/// Blank lines and lines that start with '#' are skipped; lines end in LF or CRLF. Stamps must be
/// finite and strictly increasing; the norm of a quaternion must be within 1e-2 of one and is then
/// normalised.
/// @throws InvalidInput `name:line: got ..., expected ...`
std::vector<StampedPose> parse_tum(std::string_view text, const std::string& name,
                                   const TumOptions& options = {});

/// Reads a file as parse_tum reads a text.
std::vector<StampedPose> read_tum(const std::filesystem::path& path,
                                  const TumOptions& options = {});

/// The treatment of frames without a pose by format_tum.
enum class TumMisses {
  leave_out,   ///< no line
  write_zeros  ///< stamp and seven zeros, which parse_tum reads with allow_misses
};

/// The TUM text of frames: poses with 12 significant digits, stamps with as many as are needed to
/// read back the same number.
/// @throws InvalidInput naming the first frame whose stamp parse_tum would refuse
std::string format_tum(std::span<const StampedPose> frames,
                       TumMisses misses = TumMisses::leave_out);

}  // namespace posemix
