// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cstdio>

#include <posemix/results/report.hpp>

/// Writes the report of a results folder.
int main(int argc, char** argv) {
  if (argc != 2) return posemix::has_report_page() ? 0 : 1;
  std::puts(posemix::write_report(argv[1]).c_str());
}
