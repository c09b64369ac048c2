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

/// Mixture files: a mixture over one pose as JSON, with every convention stated. docs/formats.md
/// describes the schema.
namespace posemix {

/// Version of mixture files that this library writes and reads.
inline constexpr std::int64_t kMixtureSchema = 1;

using ConcentratedPoses = Mixture<ConcentratedGaussian<SE3d>>;
using ProjectedPoses = Mixture<ProjectedGaussian<SE3d>>;

/// A mixture of concentrated or of projected Gaussians.
using AnyMixture = std::variant<ConcentratedPoses, ProjectedPoses>;

/// The two frames of a pose T_from_to, which maps points of frame `to` into frame `from`.
struct FrameNames {
  std::string from;
  std::string to;

  bool operator==(const FrameNames&) const = default;
};

/// The content of a mixture file.
struct MixtureFile {
  FrameNames frames;
  AnyMixture mixture;
  /// Warnings about keys that were read under their names of the previous release; not written.
  std::vector<std::string> warnings = {};
};

/// The side of the perturbation of concentrated Gaussians.
enum class Side {
  left,  ///< X = Exp(xi) X0, the convention of the library
  right  ///< X = X0 Exp(delta)
};

/// The words of Side in files and options.
template <>
inline constexpr WordTable<Side, 2> words<Side>{{
    {"left", Side::left},
    {"right", Side::right},
}};

/// The order of the halves of a tangent vector.
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

/// The conventions of a mixture file. The first value of each enum is the convention of the
/// library.
struct MixtureConvention {
  Side side = Side::left;  ///< for concentrated Gaussians only
  TangentOrder order = TangentOrder::rotation_translation;
  AngleUnit angle = AngleUnit::rad;  ///< for concentrated Gaussians only
  LengthUnit length = LengthUnit::m;

  bool operator==(const MixtureConvention&) const = default;
};

/// The text of a mixture file, one line per component. In the convention of the library all numbers
/// are read back bit by bit; in others up to the rounding errors of the conversion.
/// @throws InvalidInput naming the component when a number is not finite or out of range or a
/// covariance is not symmetric positive definite; for names of frames that are not 1 to 100
/// printable characters without blanks
std::string format_mixture(const MixtureFile& file, const MixtureConvention& convention = {});

/// Reads the text of a mixture file in any convention; `name` is the name of the file in messages.
/// Quaternions and weights are normalised, unless they already are up to the last bits. Covariances
/// of right perturbations become Ad(X0) P Ad(X0)^T. The key "distribution" may have its old name
/// "law", with a warning.
/// @throws InvalidInput naming the file and the place in it: text that is not JSON, a key that is
/// missing, unknown or occurs twice, another schema or group, a wrong size, a number that is not
/// finite, a position beyond 1e8 m, a negative weight, a quaternion whose norm differs from one by
/// more than 1e-6, a covariance that is not symmetric positive definite
MixtureFile parse_mixture(std::string_view text, const std::string& name);

/// Reads a file as parse_mixture reads a text.
MixtureFile read_mixture(const std::filesystem::path& path);

}  // namespace posemix
