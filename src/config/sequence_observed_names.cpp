// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "posemix/base/error.hpp"
#include "posemix/io/text.hpp"
#include "sequence_parts.hpp"

/// Names in observations that stand for nothing are errors of their rows.
namespace posemix::internal {
namespace {

/// Throws with the row and the column, or with the key in place of the column.
[[noreturn]] void fail(const ObservationFile& file, std::size_t i, std::string_view column,
                       const std::string& value, const std::string& expected,
                       const std::string& key = {}) {
  if (!key.empty())
    throw InvalidInput(fmt::format("{} is {}, expected {}", key, in_quotes(value), expected));
  throw InvalidInput(fmt::format("{}: got {} = {}, expected {}", file.place(i), column,
                                 in_quotes(value), expected));
}

/// Names for a message.
template <class Names>
std::string one_of(const Names& names) {
  return fmt::format("one of: {}", fmt::join(names, ", "));
}

void require_one_camera(const std::vector<ObservationFile>& files) {
  const std::string* first = nullptr;
  for (const ObservationFile& file : files) {
    for (std::size_t i = 0; i < file.observations.size(); ++i) {
      const std::string& camera = file.observations[i].camera;
      if (first == nullptr) first = &camera;
      if (camera == *first) continue;
      fail(file, i, "camera", camera,
           fmt::format("{} as before, or a table [[cameras]] with the poses of both on the body",
                       in_quotes(*first)),
           file.camera_key);
    }
  }
}

void require_known_cameras(const ObservedRecording& observed) {
  if (observed.cameras.empty()) return require_one_camera(observed.files);
  std::vector<std::string> names;
  names.reserve(observed.cameras.size());
  for (const BodyCamera& camera : observed.cameras) names.push_back(camera.name);
  for (const ObservationFile& file : observed.files) {
    for (std::size_t i = 0; i < file.observations.size(); ++i) {
      const std::string& camera = file.observations[i].camera;
      if (std::find(names.begin(), names.end(), camera) == names.end())
        fail(file, i, "camera", camera, "the name of one of the [[cameras]], " + one_of(names),
             file.camera_key);
    }
  }
}

}  // namespace

bool is_usable_id(const std::string& id) {
  constexpr std::size_t kLongestId = 100;
  constexpr std::string_view kAllowed =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_.-";
  return !id.empty() && id.size() <= kLongestId &&
         id.find_first_not_of(kAllowed) == std::string::npos;
}

void require_known_objects(const std::vector<ObservationFile>& files,
                           const std::vector<ObjectModel>& models, bool any_id) {
  std::set<std::string> ids;
  std::set<std::string> classes;
  for (const ObjectModel& model : models) {
    ids.insert(model.id);
    classes.insert(class_of(model));
  }
  const auto or_none = [](const std::set<std::string>& names) {
    return names.empty() ? "of which there are none" : one_of(names);
  };
  for (const ObservationFile& file : files) {
    for (std::size_t i = 0; i < file.observations.size(); ++i) {
      const Observation& seen = file.observations[i];
      if (seen.object.empty() && classes.count(seen.class_id) == 0)
        fail(file, i, "class", seen.class_id,
             "that of one of the [[objects]], " + or_none(classes));
      if (seen.object.empty() || ids.count(seen.object) != 0) continue;
      if (!any_id)
        fail(
            file, i, "id", seen.object,
            fmt::format("that of one of the [[objects]], {}, or a table [on_sight]", or_none(ids)));
      if (!is_usable_id(seen.object)) fail(file, i, "id", seen.object, std::string(kUsableId));
    }
  }
}

void require_known_sources(const ObservedRecording& observed,
                           const std::vector<ObjectModel>& models) {
  require_known_cameras(observed);
  std::map<std::string, const ObjectModel*> by_id;
  std::map<std::string, const ObjectModel*> by_class;
  for (const ObjectModel& model : models) {
    by_id.emplace(model.id, &model);
    by_class.emplace(class_of(model), &model);
  }
  for (const ObservationFile& file : observed.files) {
    for (std::size_t i = 0; i < file.observations.size(); ++i) {
      const Observation& seen = file.observations[i];
      const ObjectModel& model =
          seen.object.empty() ? *by_class.at(seen.class_id) : *by_id.at(seen.object);
      if (seen.detector.empty() || model.detectors.empty() ||
          model.detectors.count(seen.detector) != 0)
        continue;
      std::vector<std::string> names;
      names.reserve(model.detectors.size());
      for (const auto& [name, noise] : model.detectors) names.push_back(name);
      fail(file, i, "detector", seen.detector,
           fmt::format("one of the detectors of {}, {}", in_quotes(model.id), one_of(names)),
           file.detector_key);
    }
  }
}

}  // namespace posemix::internal
