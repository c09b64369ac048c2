// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <algorithm>
#include <limits>
#include <string>
#include <utility>
#include <variant>

#include <fmt/ranges.h>

#include "slam.hpp"

/// What a run has of one object over its frames.
namespace posemix::python {

inline constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// One number per frame.
template <class Value>
Array over_frames(const RecordedRun& run, Value value) {
  NewArray out({run.frames.size()});
  for (std::size_t i = 0; i < run.frames.size(); ++i) out.data[i] = value(run.frames[i]);
  return std::move(out.array);
}

/// An index or an id.
using ObjectKey = std::variant<std::size_t, std::string>;

/// @throws InvalidInput for an object that there is not
inline std::size_t index_of(const RecordedRun& run, const ObjectKey& object) {
  const auto* index = std::get_if<std::size_t>(&object);
  if (index != nullptr && *index >= run.ids.size()) {
    throw InvalidInput(
        fmt::format("there is no object {}; expected less than {}", *index, run.ids.size()));
  }
  if (index != nullptr) return *index;
  const auto found = std::ranges::find(run.ids, std::get<std::string>(object));
  if (found == run.ids.end()) {
    throw InvalidInput(fmt::format("no object is called '{}'; expected one of {}",
                                   std::get<std::string>(object), fmt::join(run.ids, ", ")));
  }
  return static_cast<std::size_t>(found - run.ids.begin());
}

/// A method of the run for one object by index or id.
template <class Value>
auto of_object(Value value) {
  return [value](const RecordedRun& run, const ObjectKey& object) {
    return value(run, index_of(run, object));
  };
}

/// Existence, health and motion of objects over the frames.
void bind_run_health(nb::class_<RecordedRun>& run);

}  // namespace posemix::python
