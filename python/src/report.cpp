// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/results/report.hpp"

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include "arrays.hpp"

namespace posemix::python {

constexpr const char* kReportDoc =
    R"(Writes one HTML file that shows results in a browser without network or server, like ``posemix report``.

Parameters
----------
results : path
    A folder of `write_results`, ``posemix slam`` or ``posemix study``, a folder of mixture files, or one
    of these; a folder with several runs is compared, as by `write_comparison`.
out : path, optional
    The file to write; by default report.html in the folder, or beside the mixture file.
title : str, optional
    Title of the page; by default it is taken from the results.
meshes : mapping, optional
    For an object id, a PLY file and the length of its unit [m]: 1e-3 for BOP's models.
camera : tuple, optional
    Intrinsics of the camera, ``(fx, fy, cx, cy, width, height)`` in pixels, without distortion.
images : path, optional
    A folder of JPEG and PNG files of the camera, with stamps in their names [s or ns] or in a file ``stamps.csv`` with
    the columns ``name,stamp_s``. Where they have more than 8 MB in all, every n-th is taken, with a UserWarning.

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

constexpr const char* kComparisonDoc =
    R"(Writes one HTML file that compares runs over one recording, like ``posemix report A B C``.

Parameters
----------
runs : sequence of path
    Folders of `write_results` or ``posemix slam``, at least two.
out : path, optional
    The file to write; by default comparison.html in the folder that all of them are in.
title, meshes, camera, images : optional
    As for `write_report`.

Returns
-------
pathlib.Path
    The file written.

Raises
------
ValueError
    As `write_report`, and for runs that are not over one recording.
OSError
    As `write_report`.
)";

namespace {

namespace fs = std::filesystem;

using Meshes = std::optional<std::map<std::string, std::pair<fs::path, double>>>;
using Camera =
    std::optional<std::tuple<double, double, double, double, std::uint32_t, std::uint32_t>>;

ReportOptions options_of(const std::optional<fs::path>& out,
                         const std::optional<std::string>& title, const Meshes& meshes,
                         const Camera& camera, const std::optional<fs::path>& images) {
  ReportOptions options{.out = out, .title = title};
  if (meshes)
    for (const auto& [id, mesh] : *meshes) options.meshes[id] = {mesh.first, mesh.second};
  if (camera) {
    const auto& [fx, fy, cx, cy, width, height] = *camera;
    options.camera = ReportCamera{fx, fy, cx, cy, width, height};
  }
  if (images) options.images = ReportImages{*images};
  // What a signal's handler raises ends the work.
  options.progress = [](std::size_t, std::size_t) {
    const nb::gil_scoped_acquire locked;
    if (PyErr_CheckSignals() != 0) throw nb::python_error();
  };
  return options;
}

/// Writes a page without the interpreter's lock; warnings come at the end.
template <class Write>
fs::path write_page(ReportOptions options, const Write& write) {
  std::vector<std::string> warnings;
  options.warn = [&](const std::string& warning) { warnings.push_back(warning); };
  fs::path path = [&] {
    const nb::gil_scoped_release unlocked;
    return write(options);
  }();
  for (const std::string& warning : warnings)
    if (PyErr_WarnEx(PyExc_UserWarning, warning.c_str(), 1) != 0) throw nb::python_error();
  return path;
}

}  // namespace

void bind_report(nb::module_& m) {
  m.def("has_report_page", &has_report_page);
  m.def(
      "write_report",
      [](const fs::path& results, const std::optional<fs::path>& out,
         const std::optional<std::string>& title, const Meshes& meshes, const Camera& camera,
         const std::optional<fs::path>& images) {
        return write_page(
            options_of(out, title, meshes, camera, images),
            [&](const ReportOptions& options) { return write_report(results, options); });
      },
      "results"_a, "out"_a = nb::none(), "title"_a = nb::none(), "meshes"_a = nb::none(),
      "camera"_a = nb::none(), "images"_a = nb::none(), kReportDoc);
  m.def(
      "write_comparison",
      [](const std::vector<fs::path>& runs, const std::optional<fs::path>& out,
         const std::optional<std::string>& title, const Meshes& meshes, const Camera& camera,
         const std::optional<fs::path>& images) {
        return write_page(
            options_of(out, title, meshes, camera, images),
            [&](const ReportOptions& options) { return write_comparison(runs, options); });
      },
      "runs"_a, "out"_a = nb::none(), "title"_a = nb::none(), "meshes"_a = nb::none(),
      "camera"_a = nb::none(), "images"_a = nb::none(), kComparisonDoc);
}

}  // namespace posemix::python
