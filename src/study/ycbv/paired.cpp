// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "paired.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "posemix/base/statistics.hpp"
#include "table_reader.hpp"

namespace posemix {
namespace {

/// An error with its columns.
struct Error {
  const char* name;
  const char* estimate;
  const char* detection;
};

constexpr std::array<Error, 2> kErrors{
    {{"rotation [deg]", "paired_rotation_deg", "paired_detection_rotation_deg"},
     {"position [cm]", "paired_position_cm", "paired_detection_position_cm"}}};

}  // namespace

StudyTable summarise_paired(const StudyTable& rows) {
  const TableReader table(rows);
  StudyTable summary({"detector", "method", "error", "rows", "estimate", "detection", "worst_ratio",
                      "at_most_detection"});
  for (const std::string& detector : table.names("detector")) {
    for (const std::string& method : table.names("method")) {
      for (const Error& error : kErrors) {
        std::vector<double> estimates;
        std::vector<double> detections;
        double worst = 0.0;
        std::int64_t at_most = 0;
        for (std::size_t i = 0; i < table.size(); ++i) {
          if (table.text(i, "detector") != detector || table.text(i, "method") != method) continue;
          const double estimate = table.number(i, error.estimate);
          const double detection = table.number(i, error.detection);
          if (std::isnan(estimate) || std::isnan(detection)) continue;
          estimates.push_back(estimate);
          detections.push_back(detection);
          worst = std::max(worst, estimate / detection);
          at_most += estimate <= detection ? 1 : 0;
        }
        if (estimates.empty()) continue;
        summary.add({detector, method, error.name, static_cast<std::int64_t>(estimates.size()),
                     median(estimates), median(detections), worst, at_most});
      }
    }
  }
  return summary;
}

}  // namespace posemix
