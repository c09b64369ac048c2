// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/results/report.hpp"

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>

#include "arrays.hpp"

namespace posemix::python {

constexpr const char* kReportDoc =
    R"(Writes one HTML file that shows results in a browser without network or server, like ``posemix report``.

Parameters
----------
results : path
    A folder of `write_results`, ``posemix slam`` or ``posemix study``, a folder of mixture files, or one
    of these.
out : path, optional
    The file to write; by default report.html in the folder, or beside the mixture file.
title : str, optional
    Title of the page; by default it is taken from the results.
meshes : mapping, optional
    For an object id, a PLY file and the length of its unit [m]: 1e-3 for BOP's models.

Returns
-------
pathlib.Path
    The file written.

Raises
------
ValueError
    With file and place: no results, a damaged file, a mesh for an unknown object.
OSError
    If the system refuses, or the package was built without the page (npm was missing).
)";

void bind_report(nb::module_& m) {
  namespace fs = std::filesystem;
  m.def("has_report_page", &has_report_page);
  m.def(
      "write_report",
      [](const fs::path& results, const std::optional<fs::path>& out,
         const std::optional<std::string>& title,
         const std::optional<std::map<std::string, std::pair<fs::path, double>>>& meshes) {
        ReportOptions options{.out = out, .title = title};
        if (meshes)
          for (const auto& [id, mesh] : *meshes) options.meshes[id] = {mesh.first, mesh.second};
        // What a signal's handler raises ends the work.
        options.progress = [](std::size_t, std::size_t) {
          const nb::gil_scoped_acquire locked;
          if (PyErr_CheckSignals() != 0) throw nb::python_error();
        };
        const nb::gil_scoped_release unlocked;
        return write_report(results, options);
      },
      "results"_a, "out"_a = nb::none(), "title"_a = nb::none(), "meshes"_a = nb::none(),
      kReportDoc);
}

}  // namespace posemix::python
