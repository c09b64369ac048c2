// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <memory>

#include "command_files.hpp"
#include "exit_codes.hpp"
#include "io/mixture_parts.hpp"
#include "mixture_commands.hpp"
#include "posemix/io/text.hpp"
#include "posemix/mixture/em.hpp"

namespace posemix {
namespace {

struct FitOptions {
  std::string samples;
  std::optional<PoseFormat> format;
  PoseSampleOptions columns;
  Distribution distribution = Distribution::concentrated;
  FrameNames frames;
  std::size_t components = 0;
  std::size_t most_components = 0;
  EmSettings em{.restarts = 5};
  std::uint64_t seed = 1;
  OutputOptions output;
};

template <class D>
Json fit_json(const EmResult<D>& fit, const PoseSamples& samples) {
  return {{"samples", samples.poses.size()},
          {"components", fit.mixture.size()},
          {"log_likelihood", fit.log_likelihood},
          {"parameters", fit.parameters},
          {"bic", fit.bic},
          {"iterations", fit.history.size() - 1},
          {"starts", fit.starts},
          {"status", word_of(fit.status)}};
}

template <class D>
void fit_samples(const PoseSamples& samples, const FitOptions& options) {
  RandomStream stream(options.seed);
  EmSettings settings = options.em;
  if (options.most_components == 0) {
    settings.components = options.components;
    const EmResult<D> fit = fit_mixture<D>(samples.poses, samples.weights, settings, stream);
    write_mixture({options.frames, fit.mixture}, options.output);
    report("fit", fit_json(fit, samples), options.output);
    return;
  }
  settings.components = options.most_components;
  const BicSelection<D> selection =
      fit_mixture_by_bic<D>(samples.poses, samples.weights, settings, stream);
  const EmResult<D>& best = selection.fits[selection.best];
  Json found = fit_json(best, samples);
  for (const EmResult<D>& fit : selection.fits) found["bic_by_components"].push_back(fit.bic);
  write_mixture({options.frames, best.mixture}, options.output);
  report("fit", found, options.output);
}

int fit_file(const FitOptions& options) {
  const PoseSamples samples = read_pose_input(options.samples, options.format, options.columns);
  try {
    if (options.distribution == Distribution::projected) {
      fit_samples<ProjectedGaussian<SE3d>>(samples, options);
    } else {
      fit_samples<ConcentratedGaussian<SE3d>>(samples, options);
    }
  } catch (const InvalidInput& error) {
    throw InvalidInput(fmt::format("{}: {}", input_name(options.samples), error.what()));
  }
  return kExitDone;
}

/// The check that the value of an option is the name of a frame.
std::string check_frame_name(const std::string& name) {
  if (internal::is_frame_name(name)) return "";
  return fmt::format("got {}, expected 1 to {} printable ASCII characters without blanks",
                     in_quotes(name), internal::kLongestFrameName);
}

void check_deviations(const EmSettings& em) {
  if (em.max_sd >= em.min_sd) return;
  throw CLI::ValidationError("--max-sd", fmt::format("got {}, expected at least the {} of --min-sd",
                                                     em.max_sd, em.min_sd));
}

void add_sample_options(CLI::App& command, FitOptions& options) {
  command
      .add_option("samples", options.samples,
                  "Poses (see docs/formats.md); - is the standard input")
      ->required()
      ->type_name("POSES");
  add_format_option(command, options.format);
  command
      .add_option("--weights", options.columns.weights,
                  "Column of the weights in CSV; without it `weight` where there is one")
      ->type_name("COLUMN");
  add_choice<Side>(
      command, "--residuals", options.columns.residuals,
      "Fit est gt^-1 (left) or gt^-1 est (right) of the columns est_tx ... and gt_tx ...");
  command.add_option("--from", options.frames.from, "Frame a of the poses T_a_b")
      ->required()
      ->check(check_frame_name)
      ->type_name("NAME");
  command.add_option("--to", options.frames.to, "Frame b")
      ->required()
      ->check(check_frame_name)
      ->type_name("NAME");
}

void add_em_options(CLI::App& command, FitOptions& options) {
  add_choice<Distribution>(command, "--distribution", options.distribution,
                           "Kind of the components")
      ->default_str("concentrated");
  CLI::Option_group* number = command.add_option_group("Number of components");
  add_count_option(*number, "--components", options.components, "So many");
  add_count_option(*number, "--max-components", options.most_components,
                   "1 to so many, whichever has the smallest BIC");
  number->require_option(1);
  add_integer_option(command, "--restarts", options.em.restarts, {1, 10000},
                     "Starts, of which the most likely end is kept")
      ->capture_default_str();
  command.add_option("--min-sd", options.em.min_sd, "Smallest standard deviation, rad and m alike")
      ->check(number_in(kPositive))
      ->type_name("SD")
      ->capture_default_str();
  command.add_option("--max-sd", options.em.max_sd, "Largest; without it there is none")
      ->check(number_in(kPositive))
      ->type_name("SD");
  add_integer_option(command, "--max-iterations", options.em.max_iterations, {1, 1'000'000},
                     "Of one start")
      ->capture_default_str();
  command.add_flag("--diagonal", options.em.diagonal, "Diagonal covariances");
  add_seed_option(command, options.seed);
}

}  // namespace

void add_fit_command(CLI::App& program, std::function<int()>& action) {
  const auto options = std::make_shared<FitOptions>();
  CLI::App* command = program.add_subcommand("fit", "A mixture fitted to poses or residuals by EM");
  command->footer(
      "Reports the log-likelihood, the BIC and how EM ended.\n"
      "\n"
      "Example: posemix fit samples.csv --components 2 --from camera --to mug --out mug.json\n"
      "         posemix fit errors.csv --residuals right --max-components 4 --restarts 5 \\\n"
      "           --from mug --to detected --distribution projected --out noise.json");
  add_sample_options(*command, *options);
  add_em_options(*command, *options);
  add_report_options(*command, options->output);
  command->callback([options, &action] {
    check_deviations(options->em);
    action = [options] { return fit_file(*options); };
  });
}

}  // namespace posemix
