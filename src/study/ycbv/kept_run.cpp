// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "kept_run.hpp"

#include <algorithm>
#include <cctype>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "base/checksum.hpp"
#include "posemix/io/output_folder.hpp"
#include "posemix/results/report.hpp"
#include "posemix/results/results.hpp"

namespace posemix {
namespace {

constexpr std::size_t kLongest = 100;

/// Whether the name says which method it is.
bool is_known(const YcbvMethod& method) {
  const std::vector<std::string> names = ycbv_methods();
  return std::ranges::find(names, method.name) != names.end() &&
         find_ycbv_method(method.name).overrides == method.overrides;
}

/// Different for methods of other names or overrides, of which a name of a folder may not tell.
std::string folder_name(const Recording& recording, const YcbvMethod& method) {
  std::string name = fmt::format("{}-{}-{}-{}", recording.sequence, recording.detector,
                                 recording.object, method.name);
  std::ranges::replace_if(
      name,
      [](unsigned char c) { return std::isalnum(c) == 0 && c != '-' && c != '.' && c != '_'; },
      '_');
  const std::string plain = fmt::format("{}-{}-{}-{}", recording.sequence, recording.detector,
                                        recording.object, method.name);
  if (name == plain && name.size() <= kLongest && is_known(method)) return name;
  const std::string all = fmt::format("{}: {}", plain, fmt::join(method.overrides, " "));
  return fmt::format("{}-{:016x}", name.substr(0, kLongest), internal::crc64(all));
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
