// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "convert_sequence.hpp"

#include <filesystem>
#include <system_error>

#include <fmt/format.h>

#include "exit_codes.hpp"
#include "posemix/base/error.hpp"
#include "posemix/config/data_folder.hpp"
#include "posemix/config/observation_sequence.hpp"
#include "posemix/config/sequence_file.hpp"
#include "posemix/io/observation_csv.hpp"
#include "posemix/io/observation_jsonl.hpp"
#include "posemix/io/output_folder.hpp"
#include "summary.hpp"

namespace posemix {
namespace {

constexpr const char* kSequence = "sequence.toml";
constexpr const char* kStamps = "stamps.txt";

std::string stamps_text(const std::vector<double>& stamps) {
  std::string text = "# stamp_s of every frame\n";
  for (const double stamp : stamps) text += fmt::format("{}\n", stamp);
  return text;
}

}  // namespace

int convert_sequence(const SequenceConversion& options) {
  const std::filesystem::path target = std::filesystem::path(options.out) / kSequence;
  if (std::error_code none; std::filesystem::equivalent(target, options.sequence, none)) {
    throw InvalidInput(fmt::format(
        "{}: is the sequence file itself, expected another folder for --out", target.string()));
  }
  TomlDocument document = TomlDocument::load(options.sequence);
  for (const std::string& assignment : options.overrides) document.apply_override(assignment);
  const auto folders = data_folders(options.sequence, options.data);
  const SlamJob job = read_slam_job(document, folders);
  print_warnings(document.warnings());
  const std::vector<Observation> observations = observations_of(job.sequence);
  const bool csv = options.format == ObservationFormat::csv;
  const std::string name = csv ? "observations.csv" : "observations.jsonl";
  OutputFolder folder(options.out);
  folder.put_last(kSequence);
  folder.write(name,
               csv ? format_observations(observations) : format_observation_lines(observations));
  folder.write(kStamps, stamps_text(job.sequence.stamps));
  folder.write(kSequence, format_observation_sequence(document, folders,
                                                      {csv ? "csv" : "jsonl", name, kStamps}));
  folder.commit();
  const std::filesystem::path made = folder.target() / kSequence;
  const SlamJob read =
      read_slam_job(TomlDocument::load(made.string()), data_folders(made.string(), std::nullopt));
  try {
    require_same_frames(job.sequence, read.sequence);
  } catch (const InvalidInput& error) {
    throw InvalidInput(fmt::format("{}: read back, {}", made.string(), error.what()));
  }
  if (!options.quiet) {
    print_text(fmt::format("{} observations in {} frames: {}\n", observations.size(),
                           job.sequence.stamps.size(), made.string()));
  }
  return kExitDone;
}

}  // namespace posemix
