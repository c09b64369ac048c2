// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "posemix/filter/gaussian_sum_filter.hpp"

/// posterior.json: a joint mixture over camera and objects. docs/formats.md describes the schema.
namespace posemix {

/// Version of posterior.json that this library writes and reads.
inline constexpr std::int64_t kPosteriorSchema = 1;

/// What a pose of the joint density is.
enum class PoseKind {
  camera,         ///< T_world_camera
  camera_motion,  ///< T_camera_camera over one reference period (constant velocity)
  object          ///< T_world_object
};

/// A pose of the joint density by name; an object's name is its id.
struct NamedPose {
  std::string name;
  PoseKind kind;
};

/// A posterior and what a reader needs to know about it.
struct PosteriorFile {
  std::string method;            ///< what made it, for people
  double stamp = 0.0;            ///< seconds
  std::vector<NamedPose> poses;  ///< one per pose of every component, in their order
  Posterior mixture;
};

/// The text of posterior.json; numbers read back bit by bit.
/// @throws InvalidInput when the names do not fit the mixture or a number is not finite
std::string format_posterior(const PosteriorFile& file);

/// Reads a text of posterior.json; `name` stands for the file in messages. Weights are normalised,
/// quaternions too; keys that are not known are ignored.
/// @throws InvalidInput naming the file and the place in it: no JSON, another schema, another side,
/// order or unit, a wrong size, a number that is not finite, a quaternion not of norm one within
/// 1e-6, a covariance that is not symmetric positive definite
PosteriorFile parse_posterior(std::string_view text, const std::string& name);

/// As parse_posterior, for a file.
PosteriorFile read_posterior(const std::filesystem::path& path);

}  // namespace posemix
