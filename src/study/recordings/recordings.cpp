// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "recordings.hpp"

#include <algorithm>
#include <map>
#include <system_error>
#include <tuple>

#include <fmt/format.h>

#include "posemix/base/error.hpp"
#include "posemix/io/pose_table.hpp"
#include "posemix/io/text.hpp"
#include "profiles.hpp"
#include "table_folder.hpp"

namespace posemix {
namespace {

namespace fs = std::filesystem;

/// An object with fewer files than this share of the most frequent object's files is a stray.
constexpr double kStrayShare = 0.01;

bool is_folder(const fs::path& path) {
  std::error_code ignored;
  return fs::is_directory(path, ignored);
}

/// The entries of a folder, sorted by name; empty if there is no such folder.
std::vector<fs::path> entries_of(const fs::path& folder) {
  std::vector<fs::path> entries;
  if (!is_folder(folder)) return entries;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
    entries.push_back(it->path());
  if (error) throw InvalidInput(fmt::format("{}: {}", folder.string(), error.message()));
  std::sort(entries.begin(), entries.end());
  return entries;
}

void find_dope(const fs::path& data, std::vector<Recording>& recordings) {
  const auto experiments = find_experiments(data);
  if (!experiments) return;
  for (const fs::path& object : entries_of(*experiments / "inference")) {
    for (const fs::path& file : entries_of(object / "Initial")) {
      if (file.extension() != ".txt") continue;
      const std::string name = object.filename().string();
      recordings.push_back({data, "dope", name, file.stem().string(), {name}});
    }
  }
}

/// The object's number OOOOOO in `obj_OOOOOO_IIIIII.npy`.
std::optional<std::int64_t> object_number(const fs::path& file) {
  const std::string name = file.filename().string();
  const auto fields = split_fields(name, '_');
  if (file.extension() != ".npy" || fields.size() != 3 || fields[0] != "obj") return std::nullopt;
  return parse_integer(fields[1]);
}

std::vector<std::string> cosypose_objects(const fs::path& folder) {
  std::map<std::int64_t, double> files;
  double most = 0.0;
  for (const fs::path& file : entries_of(folder)) {
    const auto number = object_number(file);
    if (number && *number >= 0) most = std::max(most, ++files[*number]);
  }
  std::vector<std::string> objects;
  for (const auto& [number, count] : files) {
    if (count >= kStrayShare * most) objects.push_back(std::to_string(number));
  }
  return objects;
}

void find_cosypose(const fs::path& data, std::vector<Recording>& recordings) {
  for (const fs::path& folder : entries_of(data / "midway" / "cosypose")) {
    auto objects = cosypose_objects(folder);
    if (objects.empty()) continue;
    recordings.push_back({data, "cosypose", "all", folder.filename().string(), std::move(objects)});
  }
}

void find_tables(const fs::path& data, std::vector<Recording>& recordings) {
  constexpr std::string_view kDataset = "ycbv_";
  for (const fs::path& file : entries_of(data / kTableFolder)) {
    const std::string stem = file.stem().string();
    if (file.extension() != ".csv" || !stem.starts_with(kDataset)) continue;
    for (const auto& [scene, numbers] : read_table_objects(file)) {
      Recording recording{
          data, stem.substr(kDataset.size()), "all", fmt::format("{:0>4}", scene), {}};
      for (const std::int64_t number : numbers) recording.objects.push_back(std::to_string(number));
      recordings.push_back(std::move(recording));
    }
  }
}

bool precedes(const Recording& a, const Recording& b) {
  return std::tie(a.detector, a.object, a.sequence) < std::tie(b.detector, b.object, b.sequence);
}

}  // namespace

std::optional<fs::path> find_experiments(const fs::path& data) {
  for (const fs::path& root : {data, data / "slam-super-6d"}) {
    fs::path experiments = root / "experiments" / "ycbv";
    if (is_folder(experiments)) return experiments;
  }
  return std::nullopt;
}

void require_data_folder(const fs::path& data) {
  if (is_folder(data)) return;
  throw InvalidInput(fmt::format(
      "{}: is not a folder, expected the data folder: name it by --data or POSEMIX_DATA, or fetch "
      "public data by `posemix data fetch`",
      data.string()));
}

std::vector<Recording> find_recordings(const fs::path& data) {
  require_data_folder(data);
  std::vector<Recording> recordings;
  find_cosypose(data, recordings);
  find_dope(data, recordings);
  find_tables(data, recordings);
  std::stable_sort(recordings.begin(), recordings.end(), precedes);
  if (recordings.empty()) {
    throw InvalidInput(fmt::format(
        "{}: holds no recording, expected experiments/ycbv/inference/OBJECT/Initial/SEQUENCE.txt "
        "(there or in slam-super-6d) or midway/cosypose/SEQUENCE/obj_OOOOOO_IIIIII.npy or "
        "{}/ycbv_ESTIMATOR.csv",
        data.string(), kTableFolder));
  }
  return recordings;
}

std::string_view recording_profile(std::string_view name) {
  if (name == "dope") return kDopeProfile;
  if (name == "cosypose") return kCosyposeProfile;
  if (name == "published") return kPublishedProfile;
  throw InvalidInput(
      fmt::format("profile {}, expected dope, cosypose or published", in_quotes(name)));
}

std::string_view profile_name_of(const Recording& recording) {
  return recording.detector == "cosypose" ? "cosypose" : "dope";
}

SlamJob read_recording(const Recording& recording, std::span<const std::string> overrides) {
  TomlDocument document =
      recording_document(recording, recording_profile(profile_name_of(recording)));
  for (const std::string& each : overrides) document.apply_override(each);
  return read_slam_job(document, {recording.data});
}

}  // namespace posemix
