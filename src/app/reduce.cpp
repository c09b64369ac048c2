// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <memory>

#include "command_files.hpp"
#include "exit_codes.hpp"
#include "mixture_commands.hpp"
#include "posemix/reduction/reduce.hpp"

namespace posemix {
namespace {

struct ReduceOptions {
  std::string file;
  std::optional<std::size_t> to;
  double drop_below = 0.0;
  std::size_t drop = 0;
  PairRule pair = PairRule::weighted_symmetric_kl;
  DistanceMetric distance = DistanceMetric::tangent_norm;
  MergeRule merge = MergeRule::moment_matched;
  std::size_t samples = DivergenceSamplingSettings{}.samples;
  std::uint64_t seed = 1;
  OutputOptions output;

  ReductionSettings settings(std::size_t components) const {
    ReductionSettings settings;
    settings.prune_below = drop_below;
    settings.drop_smallest = drop;
    settings.max_components = to.value_or(components);
    settings.pair = pair;
    settings.distance = distance;
    settings.merge.rule = merge;
    settings.bound_loss = true;
    return settings;
  }
};

Json bounds_json(const BoundedLoss& loss) {
  return {{"dropped_weight", loss.dropped},
          {"merged_kl_nats", loss.merged_kl},
          {"merged_symmetric_kl_nats", loss.merged_symmetric_kl},
          {"total_variation", loss.total_variation},
          {"kl_from_reduced_nats", loss.kl_from_reduced}};
}

template <class D>
Json report_json(const Mixture<D>& before, const Reduction<D>& reduction,
                 const ReduceOptions& options) {
  RandomStream stream(options.seed);
  const DivergenceEstimate kl =
      measured_loss(before, reduction.mixture, stream, {.samples = options.samples});
  const ReductionReport& made = reduction.report;
  return {{"components_before", made.components_before},
          {"components_dropped", made.components_pruned},
          {"components_after", made.components_after},
          {"weight_dropped", made.weight_pruned},
          {"merges", made.merges.size()},
          {"converged", made.converged},
          {"measured_kl_nats", kl.value},
          {"measured_kl_standard_error", kl.error},
          {"bounds", bounds_json(made.bounded_loss.value())}};
}

int reduce_file(const ReduceOptions& options) {
  const NamedMixture input = read_mixture_input(options.file);
  std::visit(
      [&](const auto& mixture) {
        const auto reduction = reduce(mixture, options.settings(mixture.size()));
        write_mixture({input.file.frames, reduction.mixture}, options.output);
        if (!options.output.quiet) {
          report("reduce", report_json(mixture, reduction, options), options.output);
        }
      },
      input.file.mixture);
  return kExitDone;
}

void check_distance(const CLI::App& command, const ReduceOptions& options) {
  if (command.count("--distance") > 0 && options.pair != PairRule::most_distant)
    throw CLI::ValidationError("--distance", "is for --pair most_distant");
}

/// The options for merging, which is done with --to alone.
void add_rule_options(CLI::App& command, ReduceOptions& options) {
  CLI::Option* const to = command.get_option("--to");
  add_choice<PairRule>(command, "--pair", options.pair, "Which two are merged next")
      ->needs(to)
      ->default_str("weighted_symmetric_kl");
  add_choice<DistanceMetric>(command, "--distance", options.distance,
                             "What distant means, for --pair most_distant")
      ->needs(to)
      ->default_str("tangent_norm");
  add_choice<MergeRule>(command, "--merge", options.merge, "How two become one")
      ->needs(to)
      ->default_str("moment_matched");
}

}  // namespace

void add_reduce_command(CLI::App& program, std::function<int()>& action) {
  const auto options = std::make_shared<ReduceOptions>();
  CLI::App* command = program.add_subcommand("reduce", "A mixture with fewer components");
  command->footer(
      "Drops what --drop-below and --drop say, then merges pair after pair until --to are left.\n"
      "Reports the divergence D(before || after) measured by quasi-Monte Carlo, and bounds: on "
      "the\n"
      "change of any probability (total variation), on the divergence that merging causes, and on\n"
      "D(after || before).\n"
      "\n"
      "Example: posemix reduce mug.json --drop-below 1e-4 --to 10 --out fewer.json\n"
      "         posemix fuse a.json b.json | posemix reduce - --to 5 --pair runnalls --merge "
      "midway");
  command->add_option("file", options->file, "Mixture file; - is the standard input")
      ->required()
      ->type_name("MIXTURE.json");
  add_integer_option(*command, "--to", options->to, {1, kMostComponents},
                     "Components to merge down to; without it none is merged");
  command->add_option("--drop-below", options->drop_below, "Components of less weight are dropped")
      ->check(number_in({.lowest = 0, .highest = 0.999999}))
      ->type_name("WEIGHT");
  add_count_option(*command, "--drop", options->drop, "So many of the lightest are dropped");
  add_rule_options(*command, *options);
  add_integer_option(*command, "--samples", options->samples, {1024, std::uint64_t{1} << 30},
                     "Points for the measured divergence")
      ->capture_default_str();
  add_seed_option(*command, options->seed);
  add_report_options(*command, options->output);
  command->callback([options, command, &action] {
    check_distance(*command, *options);
    action = [options] { return reduce_file(*options); };
  });
}

}  // namespace posemix
