// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <filesystem>

#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>

#include "posemix/config/sequence_file.hpp"
#include "posemix/io/output_folder.hpp"
#include "posemix/results/results.hpp"
#include "posemix/results/simulation_folder.hpp"
#include "settings.hpp"
#include "slam.hpp"

namespace posemix::python {
namespace {

namespace fs = std::filesystem;

/// Issues a FutureWarning for each warning.
void warn_of_old_names(const std::vector<std::string>& warnings) {
  if (warnings.empty()) return;
  const nb::gil_scoped_acquire locked;
  for (const std::string& warning : warnings) {
    if (PyErr_WarnEx(PyExc_FutureWarning, warning.c_str(), 2) != 0) throw nb::python_error();
  }
}

TomlDocument document_of(const fs::path& path, const std::vector<std::string>& overrides) {
  TomlDocument document = TomlDocument::load(path);
  for (const std::string& assignment : overrides) document.apply_override(assignment);
  warn_of_old_names(document.warnings());
  return document;
}

/// Reads a document by `read`, without holding the interpreter's lock.
template <class Read>
auto read_document(const fs::path& path, const std::vector<std::string>& overrides, Read read) {
  const TomlDocument document = document_of(path, overrides);
  const nb::gil_scoped_release unlocked;
  return read(document);
}

void bind_job(nb::module_& m) {
  using J = SlamJob;
  nb::class_<J> made(m, "SlamJob");
  made.def(
          "__init__",
          [](J* self, const std::string& name, const std::string& method, const Sequence& sequence,
             const PoseDensity& prior, const std::vector<ObjectModel>& models,
             const ObjectSlamSettings& settings, const std::optional<SmoothingSettings>& smoothing,
             std::size_t trace_hypotheses) {
            new (self)
                J{name, method, sequence, prior, models, settings, smoothing, trace_hypotheses};
          },
          "name"_a, "method"_a, "sequence"_a, "camera_prior"_a, "models"_a, "settings"_a,
          "smoothing"_a.none(), "trace_hypotheses"_a)
      .def("values", [](const J& job) {
        return nb::make_tuple(job.name, job.method, job.sequence, job.camera_prior, job.models,
                              job.settings, job.smoothing, job.trace_hypotheses);
      });
  made.def("use", [](J& job, const std::string& name) { job.use(find_slam_method(name)); });
  m.def(
      "read_slam_job",
      [](const fs::path& path, const std::optional<fs::path>& data,
         const std::vector<std::string>& overrides) {
        return read_document(path, overrides, [&](const TomlDocument& document) {
          return read_slam_job(document, data_folders(path, data));
        });
      },
      "path"_a, "data"_a.none(), "overrides"_a);
  m.def(
      "run_job",
      [](const J& job, bool record, const nb::object& progress) {
        const RunOptions options{.record_hypotheses = record, .progress = progress_of(progress)};
        const nb::gil_scoped_release unlocked;
        return run(job, options);
      },
      "job"_a, "record"_a, "progress"_a.none());
}

/// Writes files to a folder that appears as a whole.
template <class Files>
void write_folder(const fs::path& target, const Files& files) {
  OutputFolder folder(target);
  for (const auto& [name, content] : files) folder.write(name, content);
  folder.commit();
}

void bind_results(nb::module_& m) {
  m.def("write_results",
        [](const fs::path& folder, const SlamJob& job, const SlamRun& run, const Metrics& metrics) {
          const nb::gil_scoped_release unlocked;
          write_folder(folder, format_results(job, run, metrics));
        });
}

void bind_simulation_files(nb::module_& m) {
  using File = SimulationFile;
  m.def("read_simulation", [](const fs::path& path, const std::vector<std::string>& overrides) {
    const File file = read_document(
        path, overrides, [](const TomlDocument& document) { return read_simulation(document); });
    return nb::make_tuple(file.config, file.filter);
  });
  m.def("write_simulation", [](const fs::path& folder, const SimulationConfig& config,
                               const std::vector<std::pair<std::string, std::string>>& filter,
                               const SimulatedSequence& simulated, std::uint64_t seed) {
    const nb::gil_scoped_release unlocked;
    write_folder(folder, format_simulation(File{config, filter}, simulated, seed));
  });
}

}  // namespace

void bind_jobs(nb::module_& m) {
  bind_job(m);
  bind_results(m);
  bind_simulation_files(m);
}

}  // namespace posemix::python
