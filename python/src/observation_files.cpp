// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "files.hpp"
#include "parts.hpp"
#include "posemix/base/error.hpp"
#include "posemix/io/gzip.hpp"
#include "posemix/io/observation_csv.hpp"
#include "posemix/io/observation_jsonl.hpp"
#include "posemix/io/output_file.hpp"

namespace posemix::python {
namespace {

namespace fs = std::filesystem;

constexpr const char* kReadDoc =
    R"(Reads the observations of a .csv or .jsonl file, which may be compressed (.gz).

Parameters
----------
path : path
    A table or JSON lines (docs/formats.md, "Observations").

Returns
-------
list of Observation
    In the order of the file.

Raises
------
ValueError
    With file, line and key, and for another name.
)";

constexpr const char* kWriteDoc =
    R"(Writes observations as a .csv or .jsonl file, compressed if the name ends in .gz.

JSON lines are read back to the last bit; a table has 12 digits of poses and covariances.

Parameters
----------
path : path
    Place of the file.
observations : sequence of Observation
    Each with an `object` or a `class_id`.

Raises
------
ValueError
    For an observation that is not valid, and for another name.

Examples
--------
>>> import pathlib, tempfile
>>> from posemix import SE3, Observation, ObservationComponent, read_observations, write_observations
>>> cup = Observation([ObservationComponent(SE3(translation=[0, 0, 0.8]))], class_id="cup")
>>> with tempfile.TemporaryDirectory() as folder:
...     path = pathlib.Path(folder) / "cups.jsonl"
...     write_observations(path, [cup])
...     read_observations(path) == [cup]
True
)";

/// The name without the ending of a compressed file.
fs::path uncompressed(const fs::path& path) {
  return path.extension() == ".gz" ? fs::path(path).replace_extension() : path;
}

bool is_lines(const fs::path& path) {
  const fs::path extension = uncompressed(path).extension();
  if (extension == ".jsonl") return true;
  if (extension == ".csv") return false;
  throw InvalidInput(path.string() +
                     ": expected a name in .csv or .jsonl, or one of these and .gz");
}

}  // namespace

void bind_observation_files(nb::module_& m) {
  m.def(
      "read_observations",
      [](const fs::path& path) {
        return is_lines(path) ? read_observation_lines(path) : read_observations(path);
      },
      "path"_a, kReadDoc);
  m.def(
      "write_observations",
      [](const fs::path& path, const std::vector<Observation>& observations) {
        const std::string text = is_lines(path) ? format_observation_lines(observations)
                                                : format_observations(observations);
        write_output_file(path, path.extension() == ".gz" ? gzip(text) : text);
      },
      "path"_a, "observations"_a, kWriteDoc);
}

}  // namespace posemix::python
