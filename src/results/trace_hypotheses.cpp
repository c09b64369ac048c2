// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "trace_hypotheses.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "posemix/base/error.hpp"

namespace posemix::internal {
namespace {

constexpr ColumnFormat kIdFormat{1, ColumnType::int32};
constexpr ColumnFormat kHypothesisProbability{1, ColumnType::uint16, 1.0 / 65535.0};
constexpr std::size_t kMostHypotheses = 1000;

std::int32_t id_at(const TracePlace& place) {
  const double id = place.number_in(0.0, std::numeric_limits<std::int32_t>::max());
  if (id != std::floor(id)) place.fail(fmt::format("{}", id), "an integer");
  return static_cast<std::int32_t>(id);
}

std::size_t number_of_hypotheses(const TracePlace& place) {
  if (place.size() > kMostHypotheses) {
    place.fail(fmt::format("{} hypotheses", place.size()),
               fmt::format("at most {}", kMostHypotheses));
  }
  return place.size();
}

class AlternativesSeries final : public TraceSeries {
 public:
  AlternativesSeries(std::string path, std::string prefix, const TraceScales& scales)
      : TraceSeries(std::move(path)), prefix_(std::move(prefix)), slots_(scales) {}
  void move_to(std::vector<TraceColumn>& columns) override { slots_.move_to(prefix_, columns); }

 private:
  void read(const TracePlace& place) override {
    hypotheses_.clear();
    places_.clear();
    const std::size_t size = place.value().is_null() ? 0 : number_of_hypotheses(place);
    places_.reserve(size);
    for (std::size_t i = 0; i < size; ++i) {
      const TracePlace& item = places_.emplace_back(place.item(i));
      const std::int32_t id = id_at(item.member("id"));
      const auto same = [id](const TraceHypothesis& other) { return other.id == id; };
      if (std::any_of(hypotheses_.begin(), hypotheses_.end(), same)) {
        item.fail(fmt::format("the id {} again", id), "another");
      }
      hypotheses_.push_back({id, item.member("probability").probability(), item.member("pose")});
    }
    slots_.add(hypotheses_);
  }

  std::string prefix_;
  HypothesisSlots slots_;
  std::vector<TracePlace> places_;  ///< places of the entries of hypotheses_
  std::vector<TraceHypothesis> hypotheses_;
};

}  // namespace

HypothesisSlots::Slot::Slot(std::size_t index, const TraceScales& scales, std::size_t frames)
    : mask(fmt::format("/hypotheses/{}/mask", index), {}),
      ids(fmt::format("/hypotheses/{}/id", index), kIdFormat),
      probabilities(fmt::format("/hypotheses/{}/probability", index), kHypothesisProbability),
      poses(fmt::format("/hypotheses/{}", index), scales) {
  mask.repeat_until(frames);
  ids.repeat_until(frames);
  probabilities.repeat_until(frames);
  poses.repeat_until(frames);
}

HypothesisSlots::Slot& HypothesisSlots::slot_of(std::int32_t id) {
  const auto has = [&](std::optional<std::int32_t> wanted) {
    return std::find_if(slots_.begin(), slots_.end(),
                        [&](const Slot& slot) { return slot.id == wanted; });
  };
  auto found = has(id);
  if (found == slots_.end()) found = has(std::nullopt);
  if (found == slots_.end()) return slots_.emplace_back(slots_.size(), scales_, frames_);
  return *found;
}

void HypothesisSlots::add(const std::vector<TraceHypothesis>& hypotheses) {
  for (Slot& slot : slots_) {
    const auto lives = [&](const TraceHypothesis& each) { return slot.id == each.id; };
    if (std::none_of(hypotheses.begin(), hypotheses.end(), lives)) slot.id.reset();
  }
  for (const TraceHypothesis& hypothesis : hypotheses) {
    Slot& slot = slot_of(hypothesis.id);
    slot.id = hypothesis.id;
    slot.ids.add(std::array{static_cast<double>(hypothesis.id)});
    slot.probabilities.add(std::array{hypothesis.probability});
    slot.poses.add(hypothesis.pose);
  }
  end_frame();
}

void HypothesisSlots::end_frame() {
  ++frames_;
  for (Slot& slot : slots_) {
    slot.mask.add(std::array{slot.id ? 1.0 : 0.0});
    slot.ids.repeat_until(frames_);
    slot.probabilities.repeat_until(frames_);
    slot.poses.repeat_until(frames_);
  }
}

void HypothesisSlots::move_to(const std::string& prefix, std::vector<TraceColumn>& columns) {
  const std::size_t first = columns.size();
  for (Slot& slot : slots_) {
    columns.push_back(std::move(slot.mask));
    columns.push_back(std::move(slot.ids));
    columns.push_back(std::move(slot.probabilities));
    std::move(slot.poses).move_to(columns);
  }
  for (std::size_t i = first; i < columns.size(); ++i) columns[i].put_before_name(prefix);
}

void JointHypotheses::read(const TracePlace& place) {
  std::vector<TracePlace> places;
  const std::size_t size = place.value().is_null() ? 0 : number_of_hypotheses(place);
  places.reserve(2 * size);
  std::vector<std::vector<TraceHypothesis>> of_pose(slots_.size());
  for (std::size_t i = 0; i < size; ++i) {
    const TracePlace& item = places.emplace_back(place.item(i));
    const double weight = item.member("weight").probability();
    const TracePlace& poses = places.emplace_back(item.member("poses"));
    if (poses.size() == 0) poses.fail("no poses", "the camera's and the objects'");
    if (slots_.empty()) {
      HypothesisSlots unseen(scales_);
      for (std::size_t frame = 1; frame < frames(); ++frame) unseen.add({});
      slots_.assign(poses.size(), unseen);
      of_pose.resize(poses.size());
    }
    if (poses.size() != slots_.size()) {
      poses.fail(fmt::format("{} poses", poses.size()), fmt::format("{}", slots_.size()));
    }
    for (std::size_t pose = 0; pose < poses.size(); ++pose) {
      if (poses.value()[pose].is_null()) continue;
      of_pose[pose].push_back({static_cast<std::int32_t>(i), weight, poses.item(pose)});
    }
  }
  for (std::size_t pose = 0; pose < slots_.size(); ++pose) slots_[pose].add(of_pose[pose]);
}

void JointHypotheses::name(std::vector<std::string> prefixes) {
  if (!slots_.empty() && slots_.size() != prefixes.size()) {
    throw InvalidInput(fmt::format("{}: got {} poses, expected {}: the camera's and the objects'",
                                   path(), slots_.size(), prefixes.size()));
  }
  prefixes_ = std::move(prefixes);
}

void JointHypotheses::move_to(std::vector<TraceColumn>& columns) {
  for (std::size_t pose = 0; pose < slots_.size(); ++pose) {
    slots_[pose].move_to(prefixes_[pose], columns);
  }
}

TraceSeriesPtr alternatives_series(std::string path, const std::string& prefix,
                                   const TraceScales& scales) {
  return std::make_unique<AlternativesSeries>(std::move(path), prefix, scales);
}

}  // namespace posemix::internal
