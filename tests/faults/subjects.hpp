// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <functional>

#include "app/data_server.hpp"
#include "config/small_recording.hpp"
#include "faulty_run.hpp"
#include "fetch/checksum.hpp"

namespace posemix::testing {

/// A command whose results must survive faults. All that it writes is below `folder`.
struct Subject {
  const char* name;
  std::vector<Part> parts;
  /// Lays down what the command reads beside `folder`, once.
  std::function<void(const std::filesystem::path& inputs)> prepare;
  /// `earlier`: another result, which the command then replaces.
  std::function<std::vector<std::string>(const std::filesystem::path& inputs,
                                         const std::filesystem::path& folder, bool earlier)>
      command;
  /// What a second try has beside the words of the first.
  std::vector<std::string> again = {};
  /// Lines that it tells first, as the licence of what it fetches.
  std::size_t lines_first = 0;
};

inline void PrintTo(const Subject& subject, std::ostream* out) { *out << subject.name; }

/// A recording, with two sequence files: of the default filter, which writes mixtures, and of the
/// Gaussian-sum filter, which writes none.
inline void copy_recording(const std::filesystem::path& inputs) {
  const SmallFolder small;
  std::filesystem::copy(small.folder.path(), inputs, std::filesystem::copy_options::recursive);
  const std::string text = content_of(inputs / "sequence.toml");
  std::ofstream(inputs / "default.toml") << text.substr(0, text.find("[filter]"));
}

inline std::vector<std::string> slam_command(const std::filesystem::path& inputs,
                                             const std::filesystem::path& folder, bool earlier) {
  const auto sequence = inputs / (earlier ? "default.toml" : "sequence.toml");
  return {POSEMIX_PROGRAM, "slam",  sequence.string(),
          "--quiet",       "--out", (folder / "out").string()};
}

inline std::vector<std::string> study_command(const std::filesystem::path& /*inputs*/,
                                              const std::filesystem::path& folder, bool earlier) {
  return {POSEMIX_PROGRAM,
          "study",
          "monte-carlo",
          "--set",
          "methods=[\"iterated\"]",
          "--set",
          earlier ? "runs=2" : "runs=5",
          "--set",
          "noise_exponents=[1]",
          "--set",
          "path.detections=8",
          "--threads",
          "2",
          "--quiet",
          "--out",
          (folder / "out").string()};
}

/// Two files on a server of this machine, with registries of the first one and of both.
inline void serve_files(const std::filesystem::path& inputs) {
  static DataServer server;
  std::string files;
  for (const char* name : {"first", "second"}) {
    std::string content;
    for (int i = 0; i < 10000; ++i) content += fmt::format("{} {}\n", name, i);
    server.put(name, content);
    std::ofstream(inputs / name) << content;
    files += fmt::format("{{path = \"{}\", size = {}, sha256 = \"{}\"}}, ", name, content.size(),
                         content_of_file(inputs / name)->sha256);
    std::ofstream(inputs / fmt::format("{}.toml", name))
        << "schema = 1\n[[sources]]\nname = \"test\"\ntitle = \"A test\"\nlicence = \"CC0\"\n"
        << fmt::format("base_url = \"{}\"\nfiles = [{}]\n", server.url("plain"), files);
  }
}

inline std::vector<std::string> fetch_command(const std::filesystem::path& inputs,
                                              const std::filesystem::path& folder, bool earlier) {
  const auto registry = inputs / (earlier ? "first.toml" : "second.toml");
  return {POSEMIX_PROGRAM, "data",
          "fetch",         "test",
          "--registry",    registry.string(),
          "--out",         (folder / "out").string(),
          "--yes",         "--quiet"};
}

inline const std::vector<Subject>& subjects() {
  namespace fs = std::filesystem;
  static const std::vector<Subject> all{
      {"slam", {{"out", "metrics.json"}}, copy_recording, slam_command},
      {"save",
       {{"out", "metrics.json"}, {"state", ""}},
       copy_recording,
       [](const fs::path& inputs, const fs::path& folder, bool earlier) {
         auto words = slam_command(inputs, folder, true);
         words.insert(words.end(), {"--save-state", (folder / "state").string(), "--set",
                                    earlier ? "camera.start.translation_sd_m=0.003"
                                            : "camera.start.translation_sd_m=0.002"});
         return words;
       }},
      {"study", {{"out", "study.json"}}, [](const fs::path&) {}, study_command, {"--resume"}},
      {"simulate",
       {{"out", "sequence.toml"}},
       [](const fs::path&) {},
       [](const fs::path&, const fs::path& folder, bool earlier) {
         return std::vector<std::string>{POSEMIX_PROGRAM,
                                         "simulate",
                                         POSEMIX_SOURCE_DIR "/configs/demo.toml",
                                         "--seed",
                                         earlier ? "2" : "1",
                                         "--quiet",
                                         "--out",
                                         (folder / "out").string()};
       }},
      {"report",
       {{"page.html", ""}},
       [](const fs::path& inputs) {
         copy_recording(inputs);
         run_with_fault(slam_command(inputs, inputs, false), "", inputs);
       },
       [](const fs::path& inputs, const fs::path& folder, bool earlier) {
         return std::vector<std::string>{POSEMIX_PROGRAM,
                                         "report",
                                         (inputs / "out").string(),
                                         "--quiet",
                                         "--title",
                                         earlier ? "before" : "now",
                                         "--out",
                                         (folder / "page.html").string()};
       }},
      {"fit",
       {{"fitted.json", ""}},
       [](const fs::path& inputs) {
         std::ofstream(inputs / "samples.tum") << [] {
           std::string text;
           for (int i = 0; i < 40; ++i)
             text += fmt::format("{} 0.{} 0.{} 0.{} 0 0 0 1\n", i, 10 + i, 10 + 7 * i % 53, 99 - i);
           return text;
         }();
       },
       [](const fs::path& inputs, const fs::path& folder, bool earlier) {
         return std::vector<std::string>{
             POSEMIX_PROGRAM, "fit",   (inputs / "samples.tum").string(),
             "--components",  "1",     "--from",
             "camera",        "--to",  earlier ? "before" : "mug",
             "--quiet",       "--out", (folder / "fitted.json").string()};
       }},
      // Every file is a result of its own; the list of what came grows with them.
      {"fetch",
       {{"out/test/first", ""}, {"out/test/second", ""}},
       serve_files,
       fetch_command,
       {},
       4}};
  return all;
}

}  // namespace posemix::testing
