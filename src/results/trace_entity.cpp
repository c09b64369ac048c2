// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "trace_entity.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "posemix/base/error.hpp"
#include "posemix/io/text.hpp"
#include "trace_hypotheses.hpp"
#include "trace_names.hpp"

namespace posemix::internal {
namespace {

/// Bits of the column `mask` of the camera and of an object: which arrays have an entry.
const std::map<std::string, unsigned> kMaskBits{
    {"pose", 0U},           {"truth", 1U},           {"world: pose", 0U}, {"world: truth", 1U},
    {"relative: pose", 2U}, {"relative: truth", 3U}, {"detection", 4U},   {"mode_probability", 5U},
    {"existence", 6U},      {"models", 7U},          {"nis", 8U}};

const std::vector<std::string> kCameraKeys{"pose", "sd"};
const std::vector<std::string> kObjectKeys{"world: pose",  "world: sd", "relative: pose",
                                           "relative: sd", "detection", "status"};

TraceSeriesPtr track_series(const std::string& path, const std::string& key,
                            const std::string& prefix, const TraceScales& scales) {
  if (key == "pose") return pose_series(path, prefix, scales);
  if (key == "truth") return pose_series(path, prefix + "/truth", scales);
  if (key == "sd") return sd_series(path, prefix);
  if (key == "nees") return distance_series(path, prefix + "/nees");
  if (key == "position_covariance") return position_series(path, prefix);
  return nullptr;
}

}  // namespace

void write_columns(const std::vector<TraceColumn>& columns, Deflater& data, Json& headers) {
  for (const TraceColumn& column : columns) {
    column.write(data);
    headers.push_back(column.header());
  }
}

TraceSeries* TraceEntity::open(TraceKeys keys, const TraceScales& scales) {
  if (!is_camera() && keys == TraceKeys{std::string(kOldStatusKey)}) {
    keys = {"status"};
    has_old_keys_ = true;
  }
  const std::string key = fmt::format("{}", fmt::join(keys, ": "));
  const std::string path = path_ + ": " + key;
  TraceSeriesPtr made = make(keys, path, scales);
  if (!made) return nullptr;
  const auto [place, is_new] = series_.try_emplace(key, std::move(made));
  if (!is_new) throw InvalidInput(fmt::format("{}: got the key again, expected it once", path));
  return place->second.get();
}

void TraceEntity::write(Deflater& data, Json& headers) {
  check();
  std::vector<TraceColumn> columns{mask()};
  for (auto& [key, series] : series_) series->move_to(columns);
  series_.clear();
  write_columns(columns, data, headers);
}

TraceSeriesPtr TraceEntity::make(const TraceKeys& keys, const std::string& path,
                                 const TraceScales& scales) const {
  if (is_camera()) {
    return keys.size() == 1 ? track_series(path, keys[0], prefix_, scales) : nullptr;
  }
  if (keys.size() == 2 && (keys[0] == "world" || keys[0] == "relative")) {
    return track_series(path, keys[1], prefix_ + "/" + keys[0], scales);
  }
  if (keys.size() != 1) return nullptr;
  const std::string name = prefix_ + "/" + keys[0];
  if (keys[0] == "detection") return pose_series(path, name, scales.coarse());
  if (keys[0] == "nis") return distance_series(path, name);
  if (keys[0] == "status") return status_series(path, name);
  if (keys[0] == "health") return health_series(path, name);
  if (keys[0] == "register_again") return flag_series(path, name);
  if (keys[0] == "models") return shares_series(path, name);
  if (keys[0] == "mode_probability" || keys[0] == "existence")
    return probability_series(path, name);
  if (keys[0] == "alternatives") return alternatives_series(path, prefix_, hypotheses_);
  return nullptr;
}

void TraceEntity::check() const {
  for (const std::string& key : is_camera() ? kCameraKeys : kObjectKeys) {
    if (!has(key)) {
      throw InvalidInput(fmt::format("{}: got no list {}, expected one", path_, in_quotes(key)));
    }
  }
  for (const std::string track : {"", "world: ", "relative: "}) {
    for (const std::string key : {"sd", "position_covariance"}) {
      if (has(track + key)) require_same(track + key, track + "pose");
    }
  }
}

void TraceEntity::require_same(const std::string& key, const std::string& pose) const {
  const std::vector<bool>& ours = series_.at(key)->present();
  const std::vector<bool>& theirs = series_.at(pose)->present();
  const auto [differs, other] =
      std::mismatch(ours.begin(), ours.end(), theirs.begin(), theirs.end());
  if (differs == ours.end()) return;
  throw InvalidInput(fmt::format("{}[{}]: got {}, expected {} as in {}", series_.at(key)->path(),
                                 differs - ours.begin(), *differs ? "numbers" : "null",
                                 *differs ? "null" : "numbers", in_quotes(pose)));
}

TraceColumn TraceEntity::mask() const {
  std::vector<unsigned> bits(series_.begin()->second->frames(), 0U);
  for (const auto& [key, series] : series_) {
    const auto bit = kMaskBits.find(key);
    if (bit == kMaskBits.end()) continue;
    for (std::size_t k = 0; k < bits.size(); ++k) {
      if (series->present()[k]) bits[k] |= 1U << bit->second;
    }
  }
  const auto most = *std::max_element(bits.begin(), bits.end());
  const ColumnType type = most > 0xFFU ? ColumnType::uint16 : ColumnType::uint8;
  TraceColumn column(prefix_ + "/mask", {1, type});
  for (const unsigned value : bits) column.add(std::array{static_cast<double>(value)});
  return column;
}

}  // namespace posemix::internal
