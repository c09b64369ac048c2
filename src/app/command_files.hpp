// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "command_options.hpp"
#include "posemix/base/error.hpp"
#include "posemix/base/words.hpp"
#include "posemix/io/mixture_file.hpp"
#include "posemix/io/pose_samples.hpp"

/// Input and output of the commands on mixture files. The path `-` is the standard input or output.
namespace posemix {

using Json = nlohmann::ordered_json;

/// Number of components of a result above which a command refuses to multiply mixtures.
inline constexpr std::size_t kMostComponents = 1'000'000;

/// The kind of a mixture's components.
enum class Distribution { concentrated, projected };

/// The words of Distribution in files and options.
template <>
inline constexpr WordTable<Distribution, 2> words<Distribution>{{
    {"concentrated", Distribution::concentrated},
    {"projected", Distribution::projected},
}};

Distribution distribution_of(const AnyMixture& mixture);

/// A mixture and the name of its file in messages.
struct NamedMixture {
  std::string name;
  MixtureFile file;
};

/// The bytes of an input.
/// @throws InvalidInput when it cannot be read
std::string read_text_input(const std::string& path);

/// The name of an input in messages.
std::string input_name(const std::string& path);

/// Reads the mixtures of several inputs.
/// @throws InvalidInput when `-` occurs more than once, and as parse_mixture
std::vector<NamedMixture> read_mixtures(std::span<const std::string> paths);
NamedMixture read_mixture_input(const std::string& path);

/// Reads poses. Unless `format` is given, it is that of the file's name.
/// @throws InvalidInput when neither gives a format, and as parse_pose_samples
PoseSamples read_pose_input(const std::string& path, const std::optional<PoseFormat>& format,
                            const PoseSampleOptions& options = {});

/// @throws InvalidInput when `-` occurs more than once
void require_one_standard_input(std::span<const std::string> paths);

/// Writes to a file, which appears as a whole, or to the standard output.
void write_output(const std::string& path, std::string_view content);
void write_mixture(const MixtureFile& file, const OutputOptions& output);

/// The text of a mixture file; errors, as of numbers that no reader would take, begin with `name`.
std::string formatted(const MixtureFile& file, const MixtureConvention& convention,
                      std::string_view name);

/// Prints the findings of a command on the standard error, as a table or as JSON.
void report(std::string_view command, const Json& found, const OutputOptions& output);

/// Lines `key: value`; values of objects are indented.
std::string format_table(const Json& found);

/// The name of the pose, T_from_to.
std::string transform_name(const FrameNames& frames);

/// @throws InvalidInput when the frames of two mixtures differ
void require_same_frames(const NamedMixture& a, const NamedMixture& b);

std::string_view distribution_name(const AnyMixture& mixture);

/// Adds the option --format for poses.
void add_format_option(CLI::App& command, std::optional<PoseFormat>& format);

/// Calls `work` with both mixtures.
/// @throws InvalidInput when they are of different distributions
template <class Work>
AnyMixture with_one_distribution(const NamedMixture& a, const NamedMixture& b, const Work& work) {
  return std::visit(
      [&](const auto& p, const auto& q) -> AnyMixture {
        if constexpr (std::is_same_v<decltype(p), decltype(q)>) {
          if (p.size() > kMostComponents / q.size()) {
            throw InvalidInput(fmt::format(
                "{}: {} components times the {} of {} are too many, expected at most {} (see "
                "posemix reduce)",
                b.name, q.size(), p.size(), a.name, kMostComponents));
          }
          return work(p, q);
        } else {
          throw InvalidInput(
              fmt::format("{}: got distribution \"{}\", expected \"{}\" as in {} (see "
                          "posemix convert)",
                          b.name, distribution_name(b.file.mixture),
                          distribution_name(a.file.mixture), a.name));
        }
      },
      a.file.mixture, b.file.mixture);
}

/// Throws InvalidInput if an option of projected mixtures is given for another one.
inline void require_projected(const NamedMixture& mixture, const char* option, bool given) {
  if (given && std::holds_alternative<ConcentratedPoses>(mixture.file.mixture)) {
    throw InvalidInput(
        fmt::format("{}: got distribution \"concentrated\", expected \"projected\" with {}",
                    mixture.name, option));
  }
}

}  // namespace posemix
