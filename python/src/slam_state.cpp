// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "slam_state.hpp"

#include <filesystem>
#include <string_view>

#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "posemix/io/output_file.hpp"
#include "posemix/results/state_file.hpp"
#include "record.hpp"

namespace posemix::python {
namespace {

std::string_view view_of(const nb::bytes& bytes) { return {bytes.c_str(), bytes.size()}; }

template <class Slam>
constexpr const char* kClassName = std::is_same_v<Slam, StampedSlam> ? "StampedSlam" : "ObjectSlam";

/// @throws InvalidInput for the state of the other class
template <class Slam>
Slam slam_of(SlamState state) {
  using Tracker =
      std::conditional_t<std::is_same_v<Slam, StampedSlam>, StampedSlam, MultiObjectSlam>;
  using Other = std::conditional_t<std::is_same_v<Slam, StampedSlam>, ObjectSlam, StampedSlam>;
  auto* tracker = std::get_if<Tracker>(&state);
  if (tracker == nullptr) {
    throw InvalidInput(fmt::format("the state is one of {}, expected one of {}", kClassName<Other>,
                                   kClassName<Slam>));
  }
  return Slam(std::move(*tracker));
}

/// @throws InvalidInput for another tracker than the multi-object filter
const MultiObjectSlam& tracker_of(const ObjectSlam& slam) {
  const auto* tracker = std::get_if<MultiObjectSlam>(&slam.tracker());
  require(tracker != nullptr,
          "the tracker has no state that can be saved, expected the multi-object filter");
  return *tracker;
}

const StampedSlam& tracker_of(const StampedSlam& slam) { return slam; }

constexpr const char* kSaveDoc = R"(Writes the whole posterior to a file.

The file appears, or replaces an older one, as a whole or not at all. What is loaded from it goes on
as if it had never been stopped, to the last bit.

Raises
------
OSError
    When the file cannot be written.
ValueError
    For another tracker than the multi-object filter.
)";

constexpr const char* kLoadDoc =
    R"(Reads a file of `save`: the tracker with its models and settings.

Raises
------
ValueError
    When the file cannot be read, is no state, is cut off or damaged, or is of another version of
    the format.
)";

template <class Slam>
void bind_state(nb::class_<Slam>& slam) {
  const auto bytes_of = [](const Slam& self) {
    const std::string bytes = state_bytes(self);
    return nb::bytes(bytes.data(), bytes.size());
  };
  const auto of_bytes = [](const nb::bytes& bytes) {
    const nb::gil_scoped_release unlocked;
    return slam_of<Slam>(slam_of_state(view_of(bytes)));
  };
  slam.def("state_bytes", bytes_of,
           "The whole posterior, with models and settings, as bytes; the same posterior always has "
           "the same bytes.")
      .def_static(
          "from_bytes", of_bytes, "state"_a,
          nb::sig(std::is_same_v<Slam, StampedSlam> ? "def from_bytes(state: bytes) -> StampedSlam"
                                                    : "def from_bytes(state: bytes) -> ObjectSlam"),
          "The tracker of `state_bytes`.\n\n"
          "Raises\n------\nValueError\n    For bytes that are no state, cut off or "
          "damaged, or of another version of the format.\n")
      .def(
          "save",
          [](const Slam& self, const std::filesystem::path& path) {
            // The tracker is read before another thread may go on with it.
            const std::string bytes = state_bytes(self);
            const nb::gil_scoped_release unlocked;
            write_output_file(path, bytes);
          },
          "path"_a, kSaveDoc)
      .def_static(
          "load",
          [](const std::filesystem::path& path) {
            const nb::gil_scoped_release unlocked;
            return slam_of<Slam>(load_state(path));
          },
          "path"_a, kLoadDoc)
      .def(
          "configuration_differences",
          [](const Slam& self, const Slam& expected) {
            return configuration_differences(tracker_of(self), tracker_of(expected));
          },
          "expected"_a,
          "Parts in which models and settings differ from those of another tracker, as \"object "
          "'mug'\" or \"settings\"; none where they are the same to the last bit.")
      .def("__getstate__", bytes_of)
      .def("__setstate__",
           [of_bytes](Slam& self, const nb::bytes& state) { new (&self) Slam(of_bytes(state)); });
}

}  // namespace

void bind_state_of(nb::class_<ObjectSlam>& slam) { bind_state(slam); }
void bind_state_of(nb::class_<StampedSlam>& slam) { bind_state(slam); }

void bind_slam_state(nb::module_& m) {
  using I = StateInfo;
  Record<I>(m, "StateInfo", "The head of a saved state.")
      .field("format", &I::format, "int", "Version of the format.")
      .field("version", &I::version, "str", "Version of posemix that wrote it.")
      .field("is_stamped", &I::is_stamped, "bool",
             "Whether it is one of StampedSlam; else it is one of ObjectSlam.")
      .field("payload_bytes", &I::payload_bytes, "int", "Number of bytes after the head.")
      .done();
  m.def(
      "state_info",
      [](const nb::object& state) {
        if (nb::isinstance<nb::bytes>(state)) return state_info(view_of(nb::bytes(state)));
        std::filesystem::path path;
        if (nb::try_cast(state, path)) return read_state_info(path);
        throw nb::type_error("state is neither bytes nor a path; expected one of them");
      },
      "state"_a, nb::sig("def state_info(state: bytes | str | os.PathLike) -> StateInfo"),
      "The head of a saved state, given as its bytes or the path of its file.\n\n"
      "Raises\n------\nValueError\n    When the file cannot be read, or is no state or one of "
      "another version of the format.\n");
}

}  // namespace posemix::python
