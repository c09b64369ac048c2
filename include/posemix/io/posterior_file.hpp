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

/// The kind of a pose in the joint density.
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

/// A posterior with its method, time and the names of its poses.
struct PosteriorFile {
  std::string method;            ///< display name of the method
  double stamp = 0.0;            ///< seconds
  std::vector<NamedPose> poses;  ///< one per pose of every component, in the same order
  Posterior mixture;
};

/// The text of posterior.json; numbers are read back bit by bit.
/// @throws InvalidInput when the names do not fit the mixture or a number is not finite
std::string format_posterior(const PosteriorFile& file);

/// Reads a text of posterior.json; `name` is the name of the file in messages. Weights and
/// quaternions are normalised; unknown keys are ignored.
/// @throws InvalidInput naming the file and the place in it: text that is not JSON, another schema,
/// another side, order or unit, a wrong size, a number that is not finite, a quaternion whose norm
/// differs from one by more than 1e-6, a covariance that is not symmetric positive definite
PosteriorFile parse_posterior(std::string_view text, const std::string& name);

/// Reads a file as parse_posterior reads a text.
PosteriorFile read_posterior(const std::filesystem::path& path);

}  // namespace posemix
