// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <filesystem>
#include <variant>

#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/variant.h>

#include "files.hpp"
#include "posemix/config/sequence_file.hpp"
#include "posemix/io/output_folder.hpp"
#include "posemix/results/results.hpp"
#include "posemix/results/simulation_folder.hpp"
#include "record.hpp"
#include "slam.hpp"

namespace posemix::python {

void warn_of_old_names(const std::vector<std::string>& warnings) {
  for (const std::string& warning : warnings)
    if (PyErr_WarnEx(PyExc_FutureWarning, warning.c_str(), 1) != 0) throw nb::python_error();
}

namespace {

namespace fs = std::filesystem;

/// Reads a document by `read`, without the interpreter's lock.
template <class Read>
auto read_document(const fs::path& path, const std::vector<std::string>& overrides, Read read) {
  TomlDocument document = TomlDocument::load(path);
  for (const std::string& assignment : overrides) document.apply_override(assignment);
  auto result = [&] {
    const nb::gil_scoped_release unlocked;
    return read(document);
  }();
  warn_of_old_names(document.warnings());
  return result;
}

constexpr const char* kReadJobDoc = R"(Reads a sequence file and every file that it names.

Parameters
----------
path : path
    The sequence file (TOML).
data : path, optional
    Folder of the recording's files; by default the sequence file's own, then POSEMIX_DATA or the cache of
    ``posemix data``.
overrides : sequence of str
    Settings ``key=value``, as for ``posemix slam --set``.

Raises
------
ValueError
    With file, line and key.
)";

using MethodOrName = std::variant<std::string, SlamMethod>;

SlamJob using_method(const SlamJob& job, const MethodOrName& method) {
  SlamJob other = job;
  const auto* name = std::get_if<std::string>(&method);
  other.use(name != nullptr ? find_slam_method(*name) : std::get<SlamMethod>(method));
  return other;
}

void bind_job(nb::module_& m) {
  using J = SlamJob;
  Record<J>(m, "SlamJob",
            "The input of one run of object SLAM; `posemix.io.read_slam_job` reads it from a file.")
      .made_from([] { return J{{}, {}, {}, unit_density(), {}, {}}; })
      .field("name", &J::name, "str", "Display name of the recording.")
      .field("method", &J::method, "str", "Display name of the method.")
      .field("sequence", &J::sequence, "Sequence", "The recording.")
      .field("camera_prior", &J::camera_prior,
             "posemix.density.ConcentratedGaussian[posemix.lie.SE3]",
             "T_world_camera of the first frame.")
      .field("models", &J::models, "collections.abc.Sequence[ObjectModel]",
             "Models, one per object of the sequence.")
      .field("settings", &J::settings, "ObjectSlamSettings", "Tracker and motion model.")
      .field("smoothing", &J::smoothing, "SmoothingSettings | None",
             "Smoothing, for the multi-object filter only.")
      .field("trace_hypotheses", &J::trace_hypotheses, "int",
             "Number of hypotheses per frame in trace.json.")
      .shown_as([](const J& self) {
        return fmt::format("<SlamJob '{}' by {}: {}>", self.name, self.method,
                           nb::repr(nb::cast(self.sequence)).c_str());
      })
      .constructible(6)
      .done()
      .def("using", &using_method, "method"_a,
           "The job with another method of `slam_methods`: its tracker, smoothing, and noise of "
           "the object models.\n\nRaises\n------\nValueError\n    For a name that is not known.\n");
  m.def(
      "read_slam_job",
      [](const fs::path& path, const std::optional<fs::path>& data,
         const std::vector<std::string>& overrides) {
        return read_document(path, overrides, [&](const TomlDocument& document) {
          return read_slam_job(document, data_folders(path, data));
        });
      },
      "path"_a, "data"_a = nb::none(), "overrides"_a = nb::tuple(), kReadJobDoc);
}

/// Writes the files of a recording to a folder that appears as a whole.
template <class Files>
void write_folder(const fs::path& target, const Files& files) {
  OutputFolder folder(target);
  folder.put_last("sequence.toml");
  for (const auto& [name, content] : files) folder.write(name, content);
  folder.commit();
}

constexpr const char* kWriteResultsDoc =
    R"(Writes the files of ``posemix slam``: trajectories, metrics, posterior, trace, picture.

Parameters
----------
folder : path
    The folder; it appears, or its files are replaced, as a whole. Files of an earlier run in it are removed.
job : SlamJob
    The job.
run : SlamRun
    The result of the job; with recorded hypotheses for the trace.

Raises
------
ValueError
    When an estimate is not finite.
OSError
    If the system refuses.
)";

constexpr const char* kWriteSimulationDoc =
    R"(Writes a simulated recording as files for ``posemix slam``.

Parameters
----------
folder : path
    The folder; it appears as a whole.
file : SimulationFile
    The configuration of the simulation.
simulated : SimulatedSequence
    The recording.
seed : int
    The seed of the simulation, which is recorded in the files.
)";

void bind_results(nb::module_& m) {
  m.def(
      "write_results",
      [](const fs::path& folder, const SlamJob& job, const RecordedRun& run) {
        const nb::gil_scoped_release unlocked;
        OutputFolder results(folder);
        Provenance provenance;
        provenance.finished = utc_now();
        write_results(results, job, run, evaluate(job, run), {.provenance = provenance});
        results.commit();
      },
      "folder"_a, "job"_a, "run"_a, kWriteResultsDoc);
}

void bind_simulation_files(nb::module_& m) {
  using F = SimulationFile;
  Record<F>(m, "SimulationFile", "The content of a simulation file.")
      .field("config", &F::config, "SimulationConfig", "Configuration of the simulation.")
      .field("filter", &F::filter, "collections.abc.Sequence[tuple[str, str]]",
             "The table [filter] for the sequence file: keys, and values in the form of TOML.")
      .constructible(2)
      .done();
  m.def(
      "read_simulation",
      [](const fs::path& path, const std::vector<std::string>& overrides) {
        return read_document(path, overrides, [](const TomlDocument& document) {
          return read_simulation(document);
        });
      },
      "path"_a, "overrides"_a = nb::tuple(),
      "Reads the configuration of ``posemix simulate``; arguments as for `read_slam_job`.");
  m.def(
      "write_simulation",
      [](const fs::path& folder, const F& file, const SimulatedSequence& simulated,
         std::uint64_t seed) {
        const nb::gil_scoped_release unlocked;
        write_folder(folder, format_simulation(file, simulated, seed));
      },
      "folder"_a, "file"_a, "simulated"_a, "seed"_a, kWriteSimulationDoc);
}

}  // namespace

void bind_jobs(nb::module_& m) {
  bind_job(m);
  bind_results(m);
  bind_simulation_files(m);
}

}  // namespace posemix::python
