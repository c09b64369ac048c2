// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <array>
#include <memory>
#include <span>

#include "command_files.hpp"
#include "exit_codes.hpp"
#include "mixture_commands.hpp"
#include "posemix/mixture/log_densities.hpp"

namespace posemix {
namespace {

struct DensityOptions {
  std::array<std::string, 2> files;
  std::optional<PoseFormat> format;
  OutputOptions output;
};

std::vector<double> values_at(const AnyMixture& mixture, const std::vector<SE3d>& poses) {
  return std::visit(
      [&]<class D>(const Mixture<D>& of_one_distribution) {
        return posemix::log_densities(of_one_distribution, std::span<const SE3d>(poses));
      },
      mixture);
}

int density_at_poses(const DensityOptions& options) {
  require_one_standard_input(options.files);
  const NamedMixture input = read_mixture_input(options.files[0]);
  const PoseSamples points = read_pose_input(options.files[1], options.format);
  std::string text = "log_density_per_rad3_m3\n";
  for (const double value : values_at(input.file.mixture, points.poses)) {
    text += fmt::format("{}\n", value);
  }
  write_output(options.output.out, text);
  return kExitDone;
}

}  // namespace

void add_density_command(CLI::App& program, std::function<int()>& action) {
  const auto options = std::make_shared<DensityOptions>();
  CLI::App* command = program.add_subcommand("density", "Log density of a mixture at poses");
  command->footer(
      "Writes one column, log_density_per_rad3_m3, with one line per pose: the natural logarithm\n"
      "of the density with respect to the Haar measure, rotation vector volume at the identity\n"
      "(rad^3) times volume (m^3); -inf where there is none.\n"
      "\n"
      "Example: posemix density mug.json candidates.csv\n"
      "         posemix sample mug.json -n 10 | posemix density mug.json - --format csv");
  command->add_option("mixture", options->files[0], "Mixture file; - is the standard input")
      ->required()
      ->type_name("MIXTURE.json");
  command
      ->add_option("poses", options->files[1],
                   "Poses (see docs/formats.md); - is the standard input")
      ->required()
      ->type_name("POSES");
  add_format_option(*command, options->format);
  add_out_option(*command, options->output);
  command->callback(
      [options, &action] { action = [options] { return density_at_poses(*options); }; });
}

}  // namespace posemix
