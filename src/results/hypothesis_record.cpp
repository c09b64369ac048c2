// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/results/hypothesis_record.hpp"

#include <algorithm>
#include <cmath>

#include "hypothesis_texts.hpp"
#include "posemix/lie/pose_checks.hpp"

namespace posemix {
namespace internal {
namespace {

constexpr int kHypothesisDigits = 7;

Json hypothesis_json(const HypothesisSnapshot& hypothesis,
                     const std::vector<std::optional<std::size_t>>& indices) {
  Json poses = Json::array({json_pose(hypothesis.poses[kCamera], kHypothesisDigits)});
  for (const auto& index : indices) {
    poses.push_back(index ? json_pose(hypothesis.poses[*index], kHypothesisDigits) : Json(nullptr));
  }
  return {{"weight", rounded(std::exp(hypothesis.log_weight), kHypothesisDigits)},
          {"poses", std::move(poses)}};
}

std::string entry_text(const Json& json, bool is_first) {
  std::string text = json_text(json);
  text.pop_back();  // the line end
  return is_first ? text : "," + text;
}

/// Gives the memory of a vector back, which clearing it does not.
template <class T>
void release(std::vector<T>& values) {
  std::vector<T>().swap(values);
}

}  // namespace

Json joint_hypotheses_json(const FrameEstimate& frame, std::size_t most) {
  std::vector<const HypothesisSnapshot*> sorted;
  sorted.reserve(frame.hypotheses.size());
  for (const HypothesisSnapshot& hypothesis : frame.hypotheses) sorted.push_back(&hypothesis);
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const auto* a, const auto* b) { return a->log_weight > b->log_weight; });
  if (sorted.size() > most) sorted.resize(most);
  Json array = Json::array();
  for (const auto* hypothesis : sorted)
    array.push_back(hypothesis_json(*hypothesis, frame.pose_indices));
  return array;
}

Json alternatives_json(std::vector<ObjectAlternative> list, std::size_t most) {
  // An object is nowhere near such a place, as that of a detection that went astray.
  std::erase_if(list, [](const auto& one) { return !is_valid_pose(one.pose); });
  std::stable_sort(list.begin(), list.end(),
                   [](const auto& a, const auto& b) { return a.probability > b.probability; });
  if (list.size() > most) list.resize(most);
  Json array = Json::array();
  for (const ObjectAlternative& alternative : list) {
    array.push_back({{"id", alternative.id},
                     {"probability", rounded(alternative.probability, kHypothesisDigits)},
                     {"pose", json_pose(alternative.pose, kHypothesisDigits)}});
  }
  return array;
}

void HypothesisTexts::take(FrameEstimate& frame) {
  release(frame.report.update.reductions);
  const auto moves = [](const auto& twist) { return twist.has_value(); };
  if (std::none_of(frame.twists.begin(), frame.twists.end(), moves)) {
    release(frame.twists);
    release(frame.motion_models);
  }
  texts_.append(0, entry_text(joint_hypotheses_json(frame, most_), frames_++ == 0));
  release(frame.hypotheses);
  if (frame.alternatives.empty()) return;
  const bool is_first = alternatives_++ == 0;
  for (std::size_t object = 0; object < objects_; ++object) {
    texts_.append(
        1 + object,
        entry_text(alternatives_json(std::move(frame.alternatives[object]), most_), is_first));
  }
  release(frame.alternatives);
}

}  // namespace internal

HypothesisRecord::HypothesisRecord(const SlamJob& job, const std::filesystem::path& folder)
    : texts_(std::make_unique<internal::HypothesisTexts>(job, folder)) {}

HypothesisRecord::~HypothesisRecord() = default;

void HypothesisRecord::take(FrameEstimate& frame) { texts_->take(frame); }

std::size_t HypothesisRecord::frames() const { return texts_->frames(); }

}  // namespace posemix
