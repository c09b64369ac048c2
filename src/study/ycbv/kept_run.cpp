// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "kept_run.hpp"

#include <algorithm>
#include <cctype>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "posemix/io/output_folder.hpp"
#include "posemix/results/report.hpp"
#include "posemix/results/results.hpp"

namespace posemix {
namespace {

/// Methods may have overrides in their names.
std::string folder_name(const Recording& recording, const YcbvMethod& method) {
  std::string name = fmt::format("{}-{}-{}-{}", recording.sequence, recording.detector,
                                 recording.object, method.name);
  std::ranges::replace_if(
      name,
      [](unsigned char c) { return std::isalnum(c) == 0 && c != '-' && c != '.' && c != '_'; },
      '_');
  return name;
}

/// What the method changes in the profile of the detector.
std::string settings_text(const YcbvStudySettings& settings, const YcbvMethod& method) {
  nlohmann::ordered_json overrides = method.overrides;
  for (const std::string& each : settings.overrides) overrides.push_back(each);
  return nlohmann::ordered_json{{"method", method.name}, {"overrides", std::move(overrides)}}
      .dump();
}

}  // namespace

std::string keep_run(const YcbvStudySettings& settings, const Recording& recording,
                     const YcbvMethod& method, const FinishedRun& finished) {
  const std::string name = folder_name(recording, method);
  OutputFolder folder(settings.runs_in.value() / "runs" / name);
  Provenance provenance{.command = settings.command, .seed = {}};
  provenance.settings = settings_text(settings, method);
  provenance.finished = utc_now();
  write_results(folder, finished.job, finished.run, finished.metrics,
                {.provenance = std::move(provenance)});
  folder.commit();
  write_report(folder.target(),
               {.title = fmt::format("{}: {} {} by {}", recording.sequence, recording.detector,
                                     recording.object, method.name)});
  return fmt::format("runs/{}/report.html", name);
}

}  // namespace posemix
