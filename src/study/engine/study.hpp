// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

/// Studies: experiments that split into independent work items, so that threads, processes and
/// hosts can share them and an interrupted one can be continued.
namespace posemix {

/// One file of a report.
struct StudyFile {
  std::string name;
  std::string content;
};

/// The report of a study whose items are all done.
struct StudyReport {
  std::vector<StudyFile> files;         ///< study.json, tables (CSV) and figures (SVG)
  std::string summary;                  ///< the main tables as text, with blank lines between them
  std::vector<std::string> notes = {};  ///< what the numbers say, in sentences
};

/// An experiment.
///
/// Invariants: `run_item` depends on nothing but the settings and the item's index (random numbers
/// come from a stream of the item's own), may be called from several threads at once, and gives a
/// text without line breaks; `report` depends on nothing but the texts of all items, in the order
/// of their indices. So the report is the same to the last bit for any number of threads or ranks,
/// except for files with times.
struct Study {
  std::string name;
  std::string settings;   ///< everything that determines the result, as one line of JSON
  std::size_t items = 0;  ///< number of work items
  std::function<std::string(std::size_t)> run_item;
  std::function<StudyReport(std::span<const std::string>)> report;
};

}  // namespace posemix
