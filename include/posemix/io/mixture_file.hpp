// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "posemix/base/words.hpp"
#include "posemix/density/projected_gaussian.hpp"
#include "posemix/mixture/operations.hpp"

/// Mixture files: a mixture over one pose, as JSON that states every convention. docs/formats.md
/// describes the schema.
namespace posemix {

/// Version of mixture files that this library writes and reads.
inline constexpr std::int64_t kMixtureSchema = 1;

using ConcentratedPoses = Mixture<ConcentratedGaussian<SE3d>>;
using ProjectedPoses = Mixture<ProjectedGaussian<SE3d>>;

/// A mixture of either kind.
using AnyMixture = std::variant<ConcentratedPoses, ProjectedPoses>;

/// The two frames of a pose T_from_to, which maps points of frame `to` into frame `from`.
struct FrameNames {
  std::string from;
  std::string to;

  bool operator==(const FrameNames&) const = default;
};

/// What a mixture file holds.
struct MixtureFile {
  FrameNames frames;
  AnyMixture mixture;
  /// About keys that were read under the names of the release before; not written.
  std::vector<std::string> warnings = {};
};

/// Side of the perturbation of concentrated Gaussians.
enum class Side {
  left,  ///< X = Exp(xi) X0, the library's
  right  ///< X = X0 Exp(delta)
};

/// The words of Side in files and options.
template <>
inline constexpr WordTable<Side, 2> words<Side>{{
    {"left", Side::left},
    {"right", Side::right},
}};

/// Order of a tangent vector's halves.
enum class TangentOrder { rotation_translation, translation_rotation };

/// The words of TangentOrder in files and options.
template <>
inline constexpr WordTable<TangentOrder, 2> words<TangentOrder>{{
    {"rotation_translation", TangentOrder::rotation_translation},
    {"translation_rotation", TangentOrder::translation_rotation},
}};

enum class AngleUnit { rad, deg };

/// The words of AngleUnit in files and options.
template <>
inline constexpr WordTable<AngleUnit, 2> words<AngleUnit>{{
    {"rad", AngleUnit::rad},
    {"deg", AngleUnit::deg},
}};

enum class LengthUnit { m, mm };

/// The words of LengthUnit in files and options.
template <>
inline constexpr WordTable<LengthUnit, 2> words<LengthUnit>{{
    {"m", LengthUnit::m},
    {"mm", LengthUnit::mm},
}};

/// How a file states what the library holds in the first value of each.
struct MixtureConvention {
  Side side = Side::left;  ///< of concentrated Gaussians only
  TangentOrder order = TangentOrder::rotation_translation;
  AngleUnit angle = AngleUnit::rad;  ///< of concentrated Gaussians only
  LengthUnit length = LengthUnit::m;

  bool operator==(const MixtureConvention&) const = default;
};

/// The text of a mixture file, one line per component. In the convention of the library every
/// number reads back bit by bit; in others up to the rounding of the conversion.
/// @throws InvalidInput naming the component when a number is not finite or out of range or a
/// covariance is not symmetric positive definite; for names of frames that are not 1 to 100
/// printable characters without blanks
std::string format_mixture(const MixtureFile& file, const MixtureConvention& convention = {});

/// Reads the text of a mixture file in any convention; `name` stands for the file in messages.
/// Quaternions are normalised, and weights too, where they are not already to the last bits.
/// Covariances of right perturbations become Ad(X0) P Ad(X0)^T. The key "distribution" may have its
/// old name "law", with a warning.
/// @throws InvalidInput naming the file and the place in it: no JSON, a key that is missing,
/// unknown or there twice, another schema or group, a wrong size, a number that is not finite, a
/// position beyond 1e8 m, a negative weight, a quaternion not of norm one within 1e-6, a covariance
/// that is not symmetric positive definite
MixtureFile parse_mixture(std::string_view text, const std::string& name);

/// As parse_mixture, for a file.
MixtureFile read_mixture(const std::filesystem::path& path);

}  // namespace posemix
