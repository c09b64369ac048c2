// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <memory>

#include "exit_codes.hpp"
#include "mixture_verbs.hpp"
#include "posemix/divergence/conversion.hpp"
#include "verb_files.hpp"

namespace posemix {
namespace {

struct ConvertOptions {
  std::string file;
  std::optional<Law> law;
  std::optional<Side> side;
  std::optional<AngleUnit> angle;
  MixtureConvention convention;
  ConversionSettings conversion;
  std::uint64_t seed = 1;
  OutputOptions output;
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

/// The mixture in the other law, and what that cost.
std::pair<AnyMixture, Json> in_other_law(const AnyMixture& mixture, const ConvertOptions& options) {
  RandomStream stream(options.seed);
  if (const auto* concentrated = std::get_if<ConcentratedPoses>(&mixture)) {
    auto made = to_projected(*concentrated, stream, options.conversion);
    Json cost = conversion_json(made);
    return {std::move(made.mixture), std::move(cost)};
  }
  auto made = to_concentrated(std::get<ProjectedPoses>(mixture), stream, options.conversion);
  Json cost = conversion_json(made);
  return {std::move(made.mixture), std::move(cost)};
}

MixtureConvention stated_convention(const ConvertOptions& options, Law law) {
  if (law == Law::projected && (options.side || options.angle)) {
    throw InvalidInput(fmt::format("{}: got law \"projected\", expected \"concentrated\" with {}",
                                   options.file, options.side ? "--side" : "--angle-unit"));
  }
  MixtureConvention convention = options.convention;
  convention.side = options.side.value_or(Side::left);
  convention.angle = options.angle.value_or(AngleUnit::rad);
  return convention;
}

int convert_file(const ConvertOptions& options) {
  const NamedMixture input = read_mixture_input(options.file);
  const Law had = law_of(input.file.mixture);
  const Law wanted = options.law.value_or(had);
  const MixtureConvention convention = stated_convention(options, wanted);
  if (wanted == had) {
    write_output(options.output.out, format_mixture(input.file, convention));
    return kExitDone;
  }
  auto [mixture, cost] = in_other_law(input.file.mixture, options);
  write_output(options.output.out,
               format_mixture({input.file.frames, std::move(mixture)}, convention));
  report("convert", cost, options.output);
  return kExitDone;
}

void add_law_options(CLI::App& verb, ConvertOptions& options) {
  add_choice<std::optional<Law>, Law>(verb, "--law", options.law, law_words(),
                                      "Law of the result; without it that of the file");
  add_choice<ConversionRule, ConversionRule>(
      verb, "--rule", options.conversion.rule,
      {{"maximum_likelihood", ConversionRule::maximum_likelihood},
       {"cubature", ConversionRule::cubature},
       {"linear", ConversionRule::linear}},
      "How a component of one law stands for one of the other")
      ->default_str("maximum_likelihood");
  verb.add_option("--max-kl", options.conversion.max_kl,
                  "Largest divergence that a component may lose [nats]")
      ->check(CLI::PositiveNumber)
      ->type_name("KL")
      ->capture_default_str();
  add_choice<LargeLoss, LargeLoss>(
      verb, "--on-large-loss", options.conversion.on_large_loss,
      {{"split", LargeLoss::split}, {"refuse", LargeLoss::refuse}, {"accept", LargeLoss::accept}},
      "What happens to a component that would lose more")
      ->default_str("split");
  add_seed_option(verb, options.seed);
}

void add_convention_options(CLI::App& verb, ConvertOptions& options) {
  add_choice<std::optional<Side>, Side>(verb, "--side", options.side,
                                        {{"left", Side::left}, {"right", Side::right}},
                                        "Side of the perturbation of concentrated components");
  add_choice<TangentOrder, TangentOrder>(
      verb, "--order", options.convention.order,
      {{"rotation_translation", TangentOrder::rotation_translation},
       {"translation_rotation", TangentOrder::translation_rotation}},
      "Order of the covariance")
      ->default_str("rotation_translation");
  add_choice<std::optional<AngleUnit>, AngleUnit>(
      verb, "--angle-unit", options.angle, {{"rad", AngleUnit::rad}, {"deg", AngleUnit::deg}},
      "Unit of the rotation of concentrated components");
  add_choice<LengthUnit, LengthUnit>(verb, "--length-unit", options.convention.length,
                                     {{"m", LengthUnit::m}, {"mm", LengthUnit::mm}},
                                     "Unit of means and covariances")
      ->default_str("m");
}

}  // namespace

void add_convert_verb(CLI::App& program, std::function<int()>& action) {
  const auto options = std::make_shared<ConvertOptions>();
  CLI::App* verb = program.add_subcommand("convert", "A mixture file in another law or convention");
  verb->footer(
      "Between the laws the divergence D(original || converted) is reported; a component that "
      "would\n"
      "lose more than --max-kl is split. Side, order and units are exact up to rounding; all "
      "other\n"
      "verbs read them and write left, rotation_translation, rad and m.\n"
      "\n"
      "Example: posemix convert mug.json --law projected --out mug-projected.json\n"
      "         posemix convert mug.json --side right --order translation_rotation --length-unit "
      "mm");
  verb->add_option("file", options->file, "Mixture file; - is the standard input")
      ->required()
      ->type_name("MIXTURE.json");
  add_law_options(*verb, *options);
  add_convention_options(*verb, *options);
  add_report_options(*verb, options->output);
  verb->callback([options, &action] { action = [options] { return convert_file(*options); }; });
}

}  // namespace posemix
