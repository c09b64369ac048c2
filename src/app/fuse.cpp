// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <memory>

#include "command_files.hpp"
#include "exit_codes.hpp"
#include "mixture_commands.hpp"
#include "posemix/mixture/projected_operations.hpp"

namespace posemix {
namespace {

struct FuseOptions {
  std::vector<std::string> files;
  std::optional<FusionRule> rule;
  std::optional<PairWeight> weight;
  OutputOptions output;

  ProjectedMixtureFuseSettings settings() const {
    ProjectedMixtureFuseSettings settings;
    settings.pair.rule = rule.value_or(FusionRule::mode);
    settings.weight = weight.value_or(PairWeight::overlap);
    return settings;
  }
};

MixtureFusion<ConcentratedGaussian<SE3d>> fused(const ConcentratedPoses& p,
                                                const ConcentratedPoses& q,
                                                const ProjectedMixtureFuseSettings& /*unused*/) {
  return fuse(p, q, FuseSettings{});
}
MixtureFusion<ProjectedGaussian<SE3d>> fused(const ProjectedPoses& p, const ProjectedPoses& q,
                                             const ProjectedMixtureFuseSettings& settings) {
  return fuse(p, q, settings);
}

int fuse_files(const FuseOptions& options) {
  const std::vector<NamedMixture> inputs = read_mixtures(options.files);
  double log_evidence = 0.0;
  bool converged = true;
  const auto settings = options.settings();
  NamedMixture result = inputs.front();
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    require_projected(inputs[i], "--rule", options.rule.has_value());
    require_projected(inputs[i], "--pair-weight", options.weight.has_value());
    if (i == 0) continue;
    require_same_frames(result, inputs[i]);
    AnyMixture product =
        with_one_distribution(result, inputs[i], [&](const auto& p, const auto& q) {
          auto fusion = fused(p, q, settings);
          log_evidence += fusion.log_overlap;
          converged = converged && fusion.converged;
          return std::move(fusion.density);
        });
    result.file.mixture = std::move(product);
  }
  const std::size_t components =
      std::visit([](const auto& mixture) { return mixture.size(); }, result.file.mixture);
  write_mixture(result.file, options.output);
  report("fuse",
         {{"log_evidence", log_evidence}, {"components", components}, {"converged", converged}},
         options.output);
  return kExitDone;
}

}  // namespace

void add_fuse_command(CLI::App& program, std::function<int()>& action) {
  const auto options = std::make_shared<FuseOptions>();
  CLI::App* command =
      program.add_subcommand("fuse", "The product of independent beliefs about one pose");
  command->footer(
      "All pairs of components, weighted by their overlap, so the numbers of components multiply.\n"
      "The log evidence, the log of the integral of the product over rad^3 m^3, tells how well\n"
      "the beliefs agree.\n"
      "\n"
      "Example: posemix fuse left.json right.json --out both.json\n"
      "         posemix fuse one.json two.json | posemix reduce - --to 5 | posemix fuse - "
      "three.json --json");
  command->add_option("files", options->files, "Mixture files; - is the standard input")
      ->required()
      ->type_name("MIXTURE.json");
  add_choice<FusionRule>(*command, "--rule", options->rule,
                         "How projected components fuse; without it at the exact mode");
  add_choice<PairWeight>(*command, "--pair-weight", options->weight,
                         "Weight of a pair of projected components; without it their overlap");
  add_report_options(*command, options->output);
  command->callback([options, &action] {
    if (options->files.size() < 2) {
      throw CLI::ValidationError("files", "got one mixture file, expected two or more");
    }
    action = [options] { return fuse_files(*options); };
  });
}

}  // namespace posemix
