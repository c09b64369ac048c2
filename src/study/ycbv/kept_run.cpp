// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "kept_run.hpp"

#include <algorithm>
#include <cctype>

#include <fmt/format.h>

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

}  // namespace

std::string keep_run(const std::filesystem::path& out, const Recording& recording,
                     const YcbvMethod& method, const FinishedRun& finished) {
  const std::string name = folder_name(recording, method);
  OutputFolder folder(out / "runs" / name);
  write_results(folder, finished.job, finished.run, finished.metrics);
  folder.commit();
  write_report(folder.target(),
               {.title = fmt::format("{}: {} {} by {}", recording.sequence, recording.detector,
                                     recording.object, method.name)});
  return fmt::format("runs/{}/report.html", name);
}

}  // namespace posemix
