// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "posemix/results/report.hpp"
#include "report_data.hpp"
#include "small_results.hpp"

namespace posemix::testing {

/// A folder with a trace, as written by `posemix slam`.
class TraceFolder {
 public:
  explicit TraceFolder(const std::string& trace) {
    folder_.put("metrics.json", "{}");
    folder_.put("trace.json", trace);
  }
  explicit TraceFolder(const nlohmann::json& trace) : TraceFolder(trace.dump()) {}

  nlohmann::json report(std::vector<std::string>* warnings = nullptr) const {
    ReportOptions options;
    options.warn = [warnings](const std::string& warning) {
      if (warnings != nullptr) warnings->push_back(warning);
    };
    return nlohmann::json::parse(format_report(folder_.path(), options));
  }
  ReportTrace trace() const { return ReportTrace(report()["trace"]); }

 private:
  TemporaryFolder folder_;
};

inline const nlohmann::json& joint_trace() {
  static const nlohmann::json trace = nlohmann::json::parse(SmallResults().files.at("trace.json"));
  return trace;
}

inline const nlohmann::json& multi_object_trace() {
  static const nlohmann::json trace =
      nlohmann::json::parse(SmallResults({"filter={}"}).files.at("trace.json"));
  return trace;
}

}  // namespace posemix::testing
