// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/config/detector_noise.hpp"
#include "posemix/config/noise_toml.hpp"
#include "posemix/config/simulation_config.hpp"
#include "posemix/config/symmetries.hpp"
#include "target.hpp"

/// Settings in TOML other than sequences, by the first letter: a simulation, symmetries, or the
/// noise of a detector.
namespace posemix::fuzzing {
namespace {

void read_noise(std::string_view text) {
  takes("f.toml", [&] {
    const TomlDocument document = TomlDocument::parse(text, "f.toml");
    const TomlTable root = document.root();
    const DetectorNoise noise = read_detector_noise(root.get_table("noise").get_table("x"));
    document.finish();
    const std::string written = format_noise_toml("x", noise);
    const TomlDocument again = TomlDocument::parse(written, "again");
    const DetectorNoise read = read_detector_noise(again.root().get_table("noise").get_table("x"));
    expect(read.components().size() == noise.components().size(), "other components after writing");
  });
}

}  // namespace

POSEMIX_FUZZ_TARGET(settings) {
  const Choice choice(bytes);
  switch (choice.letter) {
    case 'y':
      takes("f.toml", [&, text = choice.rest] {
        for (const auto& [object, group] : parse_symmetry_file(text, "f.toml"))
          expect(!group.elements().empty(), "a group without the identity");
      });
      return;
    case 'n':
      return read_noise(choice.rest);
    default:
      takes("f.toml", [&, text = choice.rest] {
        const SimulationFile file = read_simulation(TomlDocument::parse(text, "f.toml"));
        validate(file.config);
      });
      return;
  }
}

}  // namespace posemix::fuzzing
