// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <memory>

#include "command_files.hpp"
#include "convert_sequence.hpp"
#include "exit_codes.hpp"
#include "io/renamed.hpp"
#include "mixture_commands.hpp"
#include "override_option.hpp"
#include "posemix/divergence/conversion.hpp"
#include "summary.hpp"

namespace posemix {
namespace {

struct ConvertOptions {
  std::string file;
  std::optional<Distribution> distribution;
  std::optional<Side> side;
  std::optional<AngleUnit> angle;
  MixtureConvention convention;
  ConversionSettings conversion;
  std::uint64_t seed = 1;
  OutputOptions output;
  SequenceConversion sequence;
};

template <class D>
Json conversion_json(const Conversion<D>& conversion) {
  return {{"kl_lost_nats", conversion.kl_lost},
          {"kl_lost_standard_error", conversion.kl_error},
          {"largest_component_kl_nats", conversion.largest_component_kl},
          {"components_after", conversion.mixture.size()},
          {"components_split", conversion.components_split},
          {"converged", conversion.converged},
          {"within_limit", conversion.within_limit}};
}

/// The name of what is made of an input, in messages.
std::string converted(const NamedMixture& input) {
  return fmt::format("{}: converted", input.name);
}

/// The mixture in the other distribution, and the loss by the conversion.
std::pair<AnyMixture, Json> in_other_distribution(const NamedMixture& input,
                                                  const ConvertOptions& options) try {
  const AnyMixture& mixture = input.file.mixture;
  RandomStream stream(options.seed);
  if (const auto* concentrated = std::get_if<ConcentratedPoses>(&mixture)) {
    auto made = to_projected(*concentrated, stream, options.conversion);
    Json cost = conversion_json(made);
    return {std::move(made.mixture), std::move(cost)};
  }
  auto made = to_concentrated(std::get<ProjectedPoses>(mixture), stream, options.conversion);
  Json cost = conversion_json(made);
  return {std::move(made.mixture), std::move(cost)};
} catch (const InvalidInput& error) {
  throw InvalidInput(fmt::format("{}: {}", converted(input), error.what()));
}

MixtureConvention stated_convention(const ConvertOptions& options, Distribution distribution) {
  if (distribution == Distribution::projected && (options.side || options.angle)) {
    throw InvalidInput(
        fmt::format("{}: got distribution \"projected\", expected \"concentrated\" with {}",
                    options.file, options.side ? "--side" : "--angle-unit"));
  }
  MixtureConvention convention = options.convention;
  convention.side = options.side.value_or(Side::left);
  convention.angle = options.angle.value_or(AngleUnit::rad);
  return convention;
}

int convert_file(const ConvertOptions& options) {
  const NamedMixture input = read_mixture_input(options.file);
  const Distribution had = distribution_of(input.file.mixture);
  const Distribution wanted = options.distribution.value_or(had);
  const MixtureConvention convention = stated_convention(options, wanted);
  if (wanted == had) {
    write_output(options.output.out, formatted(input.file, convention, converted(input)));
    return kExitDone;
  }
  auto [mixture, cost] = in_other_distribution(input, options);
  const MixtureFile made{input.file.frames, std::move(mixture)};
  write_output(options.output.out, formatted(made, convention, converted(input)));
  report("convert", cost, options.output);
  return kExitDone;
}

bool is_sequence(const ConvertOptions& options) { return options.file.ends_with(".toml"); }

/// The options of a sequence file are none for a mixture, and the other way round.
void check_kind(const CLI::App& command, const ConvertOptions& options) {
  constexpr const char* kOfMixtures[] = {"--distribution", "--law",           "--rule", "--max-kl",
                                         "--seed",         "--on-large-loss", "--side", "--order",
                                         "--angle-unit",   "--length-unit",   "--json"};
  constexpr const char* kOfSequences[] = {"--observations", "--data", "--set"};
  const auto check = [&](const auto& names, const char* file) {
    for (const char* name : names)
      if (command.count(name) > 0)
        throw CLI::ValidationError(name, fmt::format("is for {} files", file));
  };
  if (is_sequence(options) && options.output.out == "-")
    throw CLI::ValidationError("--out", "is required for a sequence file, expected a folder");
  is_sequence(options) ? check(kOfMixtures, "mixture") : check(kOfSequences, "sequence");
}

/// How a distribution is converted says nothing where none is.
void check_distribution_options(const CLI::App& command) {
  if (command.count("--distribution") > 0 || command.count("--law") > 0) return;
  for (const char* name : {"--rule", "--max-kl", "--on-large-loss", "--seed"}) {
    if (command.count(name) > 0)
      throw CLI::ValidationError(
          name, "requires --distribution, without which no distribution is converted");
  }
}

int convert(const ConvertOptions& options) {
  if (!is_sequence(options)) return convert_file(options);
  SequenceConversion sequence = options.sequence;
  sequence.sequence = options.file;
  sequence.out = options.output.out;
  sequence.quiet = options.output.quiet;
  return convert_sequence(sequence);
}

/// Adds the option under its name of the previous release; the help does not show it.
void add_old_distribution_option(CLI::App& command, ConvertOptions& options) {
  add_choice<Distribution>(command, "--law", options.distribution, "")->group("");
}

/// Warns of the old name, after checking that the new one is not given too.
void check_old_distribution_option(const CLI::App& command) {
  if (command.count("--law") == 0) return;
  if (command.count("--distribution") > 0) {
    throw CLI::ValidationError("--law", "is the old name of --distribution, expected one of them");
  }
  print_warnings({internal::renamed_warning("convert", "option", "--law", "--distribution")});
}

void add_distribution_options(CLI::App& command, ConvertOptions& options) {
  add_choice<Distribution>(command, "--distribution", options.distribution,
                           "Distribution of the result; without it that of the file");
  add_old_distribution_option(command, options);
  add_choice<ConversionRule>(command, "--rule", options.conversion.rule,
                             "How a component of one distribution stands for one of the other")
      ->default_str("maximum_likelihood");
  command
      .add_option("--max-kl", options.conversion.max_kl,
                  "Largest divergence that a component may lose [nats]")
      ->check(number_in(kPositive))
      ->type_name("KL")
      ->capture_default_str();
  add_choice<LargeLoss>(command, "--on-large-loss", options.conversion.on_large_loss,
                        "What happens to a component that would lose more")
      ->default_str("split");
  add_seed_option(command, options.seed);
}

void add_convention_options(CLI::App& command, ConvertOptions& options) {
  add_choice<Side>(command, "--side", options.side,
                   "Side of the perturbation of concentrated components");
  add_choice<TangentOrder>(command, "--order", options.convention.order, "Order of the covariance")
      ->default_str("rotation_translation");
  add_choice<AngleUnit>(command, "--angle-unit", options.angle,
                        "Unit of the rotation of concentrated components");
  add_choice<LengthUnit>(command, "--length-unit", options.convention.length,
                         "Unit of means and covariances")
      ->default_str("m");
}

void add_sequence_options(CLI::App& command, SequenceConversion& options) {
  add_choice<ObservationFormat>(command, "--observations", options.format,
                                "Form of the observations of a sequence file")
      ->default_str("jsonl");
  command.add_option("--data", options.data, "Folder below which the recording's files lie")
      ->type_name("DIR");
  add_override_option(command, options.overrides,
                      "Override a key of the sequence file; repeatable");
}

}  // namespace

void add_convert_command(CLI::App& program, std::function<int()>& action) {
  const auto options = std::make_shared<ConvertOptions>();
  CLI::App* command =
      program.add_subcommand("convert",
                             "A mixture file in another distribution or convention; a sequence "
                             "file as one with observations");
  command->footer(
      "Between the distributions the divergence D(original || converted) is reported; a component "
      "that would\n"
      "lose more than --max-kl is split. Side, order and units are exact up to rounding; all "
      "other\n"
      "commands read them and write left, rotation_translation, rad and m.\n"
      "\n"
      "Of a sequence file --out is a folder: sequence.toml, observations.jsonl and stamps.txt, "
      "with\n"
      "which posemix slam gives the same estimates.\n"
      "\n"
      "Example: posemix convert mug.json --distribution projected --out mug-projected.json\n"
      "         posemix convert mug.json --side right --order translation_rotation --length-unit "
      "mm\n"
      "         posemix convert sequence.toml --out converted");
  command
      ->add_option("file", options->file, "Mixture file, - is the standard input; or sequence file")
      ->required()
      ->type_name("MIXTURE.json|SEQUENCE.toml");
  add_distribution_options(*command, *options);
  add_convention_options(*command, *options);
  add_sequence_options(*command, options->sequence);
  add_report_options(*command, options->output);
  command->callback([options, command, &action] {
    check_old_distribution_option(*command);
    check_kind(*command, *options);
    check_distribution_options(*command);
    action = [options] { return convert(*options); };
  });
}

}  // namespace posemix
