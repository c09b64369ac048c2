// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <memory>

#include "command_files.hpp"
#include "exit_codes.hpp"
#include "mixture_commands.hpp"

namespace posemix {
namespace {

struct SampleOptions {
  std::string file;
  std::size_t count = 0;
  std::uint64_t seed = 1;
  bool exact = true;
  bool by_projection = false;
  std::optional<PoseFormat> format;
  OutputOptions output;
};

/// A draw from a mixture by sampling in the tangent space and projecting, instead of an exact draw.
SE3d projected_draw(const ProjectedPoses& mixture, RandomStream& stream) {
  return mixture[mixture.draw_index(stream)].density.sample_by_projection(stream);
}

int sample_file(const SampleOptions& options) {
  const NamedMixture input = read_mixture_input(options.file);
  require_projected(input, "--by-projection", options.by_projection);
  RandomStream stream(options.seed);
  std::vector<SE3d> poses;
  poses.reserve(options.count);
  for (std::size_t i = 0; i < options.count; ++i) {
    poses.push_back(options.by_projection
                        ? projected_draw(std::get<ProjectedPoses>(input.file.mixture), stream)
                        : std::visit([&](const auto& mixture) { return mixture.sample(stream); },
                                     input.file.mixture));
  }
  const auto named = pose_format_of(options.output.out);
  write_output(options.output.out,
               format_poses(poses, options.format.value_or(named.value_or(PoseFormat::csv))));
  return kExitDone;
}

}  // namespace

void add_sample_command(CLI::App& program, std::function<int()>& action) {
  const auto options = std::make_shared<SampleOptions>();
  CLI::App* command = program.add_subcommand("sample", "Draw poses from a mixture");
  command->footer(
      "The same seed gives the same poses. Without --format and a name that says it, CSV.\n"
      "\n"
      "Example: posemix sample mug.json -n 1000 --seed 1 --out samples.npy\n"
      "         posemix compose a.json b.json | posemix reduce - --to 5 | posemix sample - -n 100");
  command->add_option("file", options->file, "Mixture file; - is the standard input")
      ->required()
      ->type_name("MIXTURE.json");
  add_count_option(*command, "-n,--count", options->count, "How many")->required();
  add_seed_option(*command, options->seed);
  CLI::Option* projection =
      command->add_flag("--by-projection", options->by_projection,
                        "Project Gaussian draws from the tangent space, as the MPG paper does: not "
                        "the distribution of the density");
  command
      ->add_flag("--exact", options->exact,
                 "Draw from the distribution itself (this is the default)")
      ->excludes(projection);
  add_format_option(*command, options->format);
  add_out_option(*command, options->output);
  command->callback([options, &action] { action = [options] { return sample_file(*options); }; });
}

}  // namespace posemix
