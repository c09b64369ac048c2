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

void bind_report(nb::module_& m) {
  namespace fs = std::filesystem;
  m.def("has_report_page", &has_report_page);
  m.def(
      "write_report",
      [](const fs::path& results, const std::optional<fs::path>& out,
         const std::optional<std::string>& title,
         const std::map<std::string, std::pair<fs::path, double>>& meshes) {
        ReportOptions options{.out = out, .title = title};
        for (const auto& [id, mesh] : meshes) options.meshes[id] = {mesh.first, mesh.second};
        // An exception that a signal handler raises stops the work.
        options.progress = [](std::size_t, std::size_t) {
          const nb::gil_scoped_acquire locked;
          if (PyErr_CheckSignals() != 0) throw nb::python_error();
        };
        const nb::gil_scoped_release unlocked;
        return write_report(results, options);
      },
      "results"_a, "out"_a.none(), "title"_a.none(), "meshes"_a);
}

}  // namespace posemix::python
