// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "command_files.hpp"
#include "exit_codes.hpp"
#include "mixture_commands.hpp"
#include "posemix/divergence/monte_carlo.hpp"
#include "posemix/divergence/wasserstein.hpp"
#include "summary.hpp"

namespace posemix {
namespace {

struct DivergenceOptions {
  std::vector<std::string> files;
  std::size_t samples = DivergenceSamplingSettings{}.samples;
  std::uint64_t seed = 1;
  double length_scale = 1.0;
  bool json = false;
  OutputOptions output;
};

Json estimate_json(const DivergenceEstimate& estimate, const char* unit) {
  return {{"value", estimate.value}, {"standard_error", estimate.error}, {"unit", unit}};
}

/// Adds the mixture-Wasserstein distance; null, with the reason, if one of the mixtures is
/// projected.
template <class P, class Q>
void add_wasserstein(Json& found, const Mixture<P>& p, const Mixture<Q>& q, double length_scale) {
  using Concentrated = ConcentratedGaussian<SE3d>;
  constexpr bool kOfP = std::is_same_v<P, Concentrated>;
  constexpr bool kOfQ = std::is_same_v<Q, Concentrated>;
  if constexpr (kOfP && kOfQ) {
    found["wasserstein"] = {
        {"value", mixture_wasserstein(p, q, length_scale)},
        {"unit", "m"},
        {"length_scale_m_per_rad", length_scale},
        {"estimator", "MW2: the components moved onto each other at the least cost"}};
  } else {
    const char* const projected = !kOfP && !kOfQ ? "both are" : kOfP ? "q is" : "p is";
    found["wasserstein"] = nullptr;
    found["wasserstein_reason"] = fmt::format(
        "it is of two concentrated mixtures, {} projected (see posemix convert)", projected);
  }
}

template <class P, class Q>
Json divergences(const Mixture<P>& p, const Mixture<Q>& q, const DivergenceOptions& options) {
  const DivergenceSamplingSettings settings{.samples = options.samples};
  const auto stream = [&](std::uint64_t index) { return RandomStream(options.seed, index); };
  RandomStream forward = stream(0);
  RandomStream backward = stream(1);
  RandomStream both = stream(2);
  RandomStream squared = stream(3);
  Json found = {
      {"kl", estimate_json(kl_monte_carlo(p, q, forward, settings), "nats")},
      {"kl_reverse", estimate_json(kl_monte_carlo(q, p, backward, settings), "nats")},
      {"symmetric_kl", estimate_json(symmetric_kl_monte_carlo(p, q, both, settings), "nats")},
      {"isd", estimate_json(isd_monte_carlo(p, q, squared, settings), "rad^-3 m^-3")},
  };
  add_wasserstein(found, p, q, options.length_scale);
  found["estimator"] = "randomised quasi-Monte Carlo, with respect to the Haar measure rad^3 m^3";
  found["samples"] = options.samples;
  found["seed"] = options.seed;
  return found;
}

/// Of divergences that are below zero by more than their errors.
std::vector<std::string> warnings_of(const Json& found) {
  constexpr double kErrors = 4.0;
  std::vector<std::string> warnings;
  for (const char* const key : {"kl", "kl_reverse", "symmetric_kl"}) {
    const double value = found.at(key).at("value").get<double>();
    if (value < -kErrors * found.at(key).at("standard_error").get<double>())
      warnings.push_back(
          fmt::format("{} is negative: the mixtures turn by more than half a turn, where their "
                      "densities do not integrate to one",
                      key));
  }
  return warnings;
}

int compare_files(const DivergenceOptions& options) {
  const std::vector<NamedMixture> inputs = read_mixtures(options.files);
  require_same_frames(inputs[0], inputs[1]);
  const Json found =
      std::visit([&](const auto& p, const auto& q) { return divergences(p, q, options); },
                 inputs[0].file.mixture, inputs[1].file.mixture);
  print_warnings(warnings_of(found));
  write_output(options.output.out, options.json ? found.dump() + "\n" : format_table(found));
  return kExitDone;
}

}  // namespace

void add_divergence_command(CLI::App& program, std::function<int()>& action) {
  const auto options = std::make_shared<DivergenceOptions>();
  CLI::App* command = program.add_subcommand("divergence", "How far apart two mixtures are");
  command->footer(
      "Prints D(p || q), D(q || p), their sum, the integral square distance, each with one "
      "standard\n"
      "error, and for concentrated mixtures the mixture-Wasserstein distance. The distributions "
      "may "
      "differ.\n"
      "\n"
      "Example: posemix divergence before.json after.json --json\n"
      "         posemix reduce mug.json --to 3 | posemix divergence mug.json -");
  command->add_option("files", options->files, "Mixture files p and q; - is the standard input")
      ->required()
      ->expected(2)
      ->type_name("MIXTURE.json");
  add_integer_option(*command, "--samples", options->samples, {1024, std::uint64_t{1} << 30},
                     "Points of each estimate")
      ->capture_default_str();
  add_seed_option(*command, options->seed);
  command
      ->add_option("--length-scale", options->length_scale,
                   "Metres that one radian weighs as much as, in the Wasserstein distance")
      ->check(number_in(kPositive))
      ->type_name("M")
      ->capture_default_str();
  command->add_flag("--json", options->json, "One line of JSON instead of a table");
  add_out_option(*command, options->output);
  command->callback([options, &action] { action = [options] { return compare_files(*options); }; });
}

}  // namespace posemix
