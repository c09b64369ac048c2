// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <limits>
#include <memory>

#include "command_files.hpp"
#include "exit_codes.hpp"
#include "mixture_commands.hpp"
#include "posemix/base/units.hpp"
#include "posemix/mixture/projected_operations.hpp"

namespace posemix {
namespace {

struct ComposeOptions {
  std::vector<std::string> files;
  bool inverse = false;
  bool between = false;
  std::optional<CompositionRule> rule;
  std::optional<double> split_above_deg;
  OutputOptions output;

  ProjectedMixtureComposeSettings settings() const {
    return {rule.value_or(CompositionRule::cubature),
            split_above_deg ? radians(*split_above_deg) : std::numeric_limits<double>::infinity()};
  }
};

using Settings = ProjectedMixtureComposeSettings;

ConcentratedPoses product(const ConcentratedPoses& x, const ConcentratedPoses& y,
                          const Settings& /*of projected*/) {
  return compose(x, y);
}
ProjectedPoses product(const ProjectedPoses& x, const ProjectedPoses& y, const Settings& settings) {
  return compose(x, y, settings);
}
ConcentratedPoses quotient(const ConcentratedPoses& x, const ConcentratedPoses& y,
                           const Settings& /*of projected*/) {
  return between(x, y);
}
ProjectedPoses quotient(const ProjectedPoses& x, const ProjectedPoses& y,
                        const Settings& settings) {
  return between(x, y, settings);
}
ConcentratedPoses inverted(const ConcentratedPoses& x, const Settings& /*of projected*/) {
  return inverse(x);
}
ProjectedPoses inverted(const ProjectedPoses& x, const Settings& settings) {
  return inverse(x, settings);
}

void require_common_frame(const NamedMixture& a, const std::string& end, const NamedMixture& b,
                          const std::string& start) {
  if (end == start) return;
  throw InvalidInput(fmt::format("{}: got {}, expected one from frame {} as {} is {}", b.name,
                                 transform_name(b.file.frames), end, a.name,
                                 transform_name(a.file.frames)));
}

NamedMixture inverse_of(const NamedMixture& a, const Settings& settings) {
  return {a.name,
          {{a.file.frames.to, a.file.frames.from},
           std::visit([&](const auto& x) -> AnyMixture { return inverted(x, settings); },
                      a.file.mixture)}};
}

NamedMixture between_of(const NamedMixture& a, const NamedMixture& b, const Settings& settings) {
  require_common_frame(a, a.file.frames.from, b, b.file.frames.from);
  return {b.name,
          {{a.file.frames.to, b.file.frames.to},
           with_one_distribution(
               a, b, [&](const auto& x, const auto& y) { return quotient(x, y, settings); })}};
}

NamedMixture product_of(const NamedMixture& a, const NamedMixture& b, const Settings& settings) {
  require_common_frame(a, a.file.frames.to, b, b.file.frames.from);
  return {b.name,
          {{a.file.frames.from, b.file.frames.to},
           with_one_distribution(
               a, b, [&](const auto& x, const auto& y) { return product(x, y, settings); })}};
}

void check_count(const ComposeOptions& options) {
  const auto check = [&](bool good, const char* option, const char* expected) {
    if (good) return;
    throw CLI::ValidationError(
        option, fmt::format("got {} mixture files, expected {}", options.files.size(), expected));
  };
  if (options.inverse) return check(options.files.size() == 1, "--inverse", "one");
  if (options.between) return check(options.files.size() == 2, "--between", "two");
  check(options.files.size() > 1, "files", "two or more, or --inverse");
}

int compose_files(const ComposeOptions& options) {
  const std::vector<NamedMixture> inputs = read_mixtures(options.files);
  for (const NamedMixture& input : inputs) {
    require_projected(input, "--rule", options.rule.has_value());
    require_projected(input, "--split-above-deg", options.split_above_deg.has_value());
  }
  const Settings settings = options.settings();
  NamedMixture result = inputs.front();
  if (options.inverse) {
    result = inverse_of(result, settings);
  } else if (options.between) {
    result = between_of(result, inputs[1], settings);
  } else {
    for (std::size_t i = 1; i < inputs.size(); ++i) {
      result = product_of(result, inputs[i], settings);
    }
  }
  write_mixture(result.file, options.output);
  return kExitDone;
}

}  // namespace

void add_compose_command(CLI::App& program, std::function<int()>& action) {
  const auto options = std::make_shared<ComposeOptions>();
  CLI::App* command = program.add_subcommand("compose", "Chain uncertain poses, or invert one");
  command->footer(
      "T_a_c = T_a_b T_b_c for independent T_a_b and T_b_c: all pairs of components, so the\n"
      "numbers of components multiply. The frames must chain.\n"
      "\n"
      "Example: posemix compose T_table_camera.json T_camera_mug.json --out T_table_mug.json\n"
      "         posemix compose --inverse T_camera_mug.json\n"
      "         posemix compose --between T_camera_mug.json T_camera_box.json | posemix reduce - "
      "--to 5");
  command->add_option("files", options->files, "Mixture files; - is the standard input")
      ->required()
      ->type_name("MIXTURE.json");
  CLI::Option* inverse = command->add_flag("--inverse", options->inverse, "T_b_a of one T_a_b");
  command->add_flag("--between", options->between, "T_b_c of T_a_b and T_a_c")->excludes(inverse);
  add_choice<CompositionRule>(
      *command, "--rule", options->rule,
      "How projected components compose; without it by cubature of degree five");
  command
      ->add_option("--split-above-deg", options->split_above_deg,
                   "Projected components on the left whose rotation is wider are split first")
      ->check(number_in(kPositive))
      ->type_name("DEG");
  add_out_option(*command, options->output);
  command->callback([options, &action] {
    check_count(*options);
    action = [options] { return compose_files(*options); };
  });
}

}  // namespace posemix
