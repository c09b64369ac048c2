// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "study/grasp/data.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

#include <fmt/format.h>

#include "posemix/base/error.hpp"

namespace posemix {
namespace {

using SceneKey = std::pair<std::string, std::int64_t>;

/// The trials of both folders with the grippers of the first; those of others are left out.
GraspOutcomes joined(const GraspOutcomes& data, const std::optional<GraspOutcomes>& train) {
  GraspOutcomes all = data;
  if (!train) return all;
  for (GraspTrial trial : train->trials) {
    std::vector<std::optional<bool>> outcomes(all.grippers.size());
    for (std::size_t i = 0; i < train->grippers.size(); ++i) {
      const auto place = std::find(all.grippers.begin(), all.grippers.end(), train->grippers[i]);
      if (place == all.grippers.end()) continue;
      outcomes[static_cast<std::size_t>(place - all.grippers.begin())] = trial.outcomes[i];
    }
    trial.outcomes = std::move(outcomes);
    all.trials.push_back(std::move(trial));
  }
  return all;
}

bool is_grasped(const GraspTrial& trial) {
  return std::any_of(trial.outcomes.begin(), trial.outcomes.end(),
                     [](const auto& outcome) { return outcome.has_value(); });
}

void find_symmetries(GraspData& data, const std::vector<SymmetricObject>& symmetric) {
  for (const GraspTrial& trial : data.outcomes.trials) {
    const auto known =
        std::find_if(symmetric.begin(), symmetric.end(), [&](const SymmetricObject& s) {
          return s.dataset == trial.dataset && s.object == trial.object;
        });
    data.symmetric.push_back(known != symmetric.end());
    data.symmetries.push_back(known != symmetric.end() ? known->symmetry : SymmetryGroup());
    data.errors.push_back(
        data.symmetries.back().reduced_error(trial.truth.inverse() * trial.estimate));
  }
}

void find_detections(GraspData& data) {
  std::map<std::tuple<bool, std::string, std::int64_t, std::int64_t, std::int64_t>, std::size_t>
      known;
  for (std::size_t i = 0; i < data.outcomes.trials.size(); ++i) {
    const GraspTrial& t = data.outcomes.trials[i];
    const auto [place, fresh] = known.try_emplace(
        {i < data.predicted, t.dataset, t.scene, t.image, t.object}, data.members.size());
    if (fresh) data.members.emplace_back();
    data.detections.push_back(place->second);
    data.members[place->second].push_back(i);
  }
}

/// By trial, the block of its scene's time that its image lies in.
std::vector<std::size_t> blocks_of(const GraspData& data, std::size_t blocks) {
  std::map<SceneKey, std::set<std::int64_t>> images;
  for (const GraspTrial& t : data.outcomes.trials) images[{t.dataset, t.scene}].insert(t.image);
  std::map<std::tuple<std::string, std::int64_t, std::int64_t>, std::size_t> block;
  for (const auto& [scene, ids] : images) {
    std::size_t place = 0;
    for (const std::int64_t image : ids) {
      block[{scene.first, scene.second, image}] = place++ * blocks / ids.size();
    }
  }
  std::vector<std::size_t> result;
  result.reserve(data.outcomes.trials.size());
  for (const GraspTrial& t : data.outcomes.trials) {
    result.push_back(block.at({t.dataset, t.scene, t.image}));
  }
  return result;
}

/// Appends a fold that predicts the grasps of the trials for which `held` is set; none of the
/// trials of `apart` are learnt from.
void add_fold(GraspData& data, const char* split, const std::string& name,
              const std::vector<bool>& held, const std::vector<bool>& apart) {
  GraspFold fold{split, name, apart, data.cases(held)};
  fold.learn.flip();
  if (!fold.test.empty()) data.folds.push_back(std::move(fold));
}

/// Scenes in which an object was grasped.
std::map<ObjectKey, std::set<std::int64_t>> grasp_scenes(const GraspData& data) {
  std::map<ObjectKey, std::set<std::int64_t>> scenes;
  for (std::size_t i = 0; i < data.outcomes.trials.size(); ++i) {
    if (is_grasped(data.outcomes.trials[i])) {
      scenes[data.object(i)].insert(data.outcomes.trials[i].scene);
    }
  }
  return scenes;
}

void add_scene_folds(GraspData& data) {
  const auto scenes = grasp_scenes(data);
  std::set<SceneKey> all;
  for (const auto& [object, seen] : scenes) {
    if (seen.size() < 2) continue;
    for (const std::int64_t scene : seen) all.insert({object.first, scene});
  }
  const std::vector<GraspTrial>& trials = data.outcomes.trials;
  for (const SceneKey& scene : all) {
    std::vector<bool> apart(trials.size());
    std::vector<bool> held(trials.size());
    for (std::size_t i = 0; i < trials.size(); ++i) {
      apart[i] = trials[i].dataset == scene.first && trials[i].scene == scene.second;
      const auto seen = scenes.find(data.object(i));
      held[i] = apart[i] && seen != scenes.end() && seen->second.size() > 1;
    }
    add_fold(data, "scene", fmt::format("{}/{}", scene.first, scene.second), held, apart);
  }
}

void add_block_folds(GraspData& data, std::size_t blocks) {
  const auto scenes = grasp_scenes(data);
  const std::vector<std::size_t> block = blocks_of(data, blocks);
  for (std::size_t b = 0; b < blocks; ++b) {
    std::vector<bool> apart(block.size());
    std::vector<bool> held(block.size());
    for (std::size_t i = 0; i < block.size(); ++i) {
      apart[i] = block[i] == b;
      const auto seen = scenes.find(data.object(i));
      held[i] = apart[i] && seen != scenes.end() && seen->second.size() == 1;
    }
    add_fold(data, "block", fmt::format("{}", b), held, apart);
  }
}

void add_train_fold(GraspData& data) {
  std::vector<bool> held(data.outcomes.trials.size());
  std::fill_n(held.begin(), data.predicted, true);
  add_fold(data, "train", "all", held, held);
}

}  // namespace

std::vector<GraspCase> GraspData::cases(const std::vector<bool>& chosen) const {
  std::vector<GraspCase> found;
  for (std::size_t i = 0; i < outcomes.trials.size(); ++i) {
    if (!chosen[i]) continue;
    for (std::size_t g = 0; g < outcomes.grippers.size(); ++g) {
      const std::optional<bool> outcome = outcomes.trials[i].outcomes[g];
      if (outcome) found.push_back({i, g, *outcome});
    }
  }
  return found;
}

GraspData grasp_data(const GraspOutcomes& data, const std::optional<GraspOutcomes>& train,
                     const GraspStudySettings& settings) {
  GraspData all;
  all.outcomes = joined(data, train);
  all.predicted = data.trials.size();
  find_symmetries(all, settings.symmetric);
  find_detections(all);
  if (train) {
    add_train_fold(all);
  } else {
    add_scene_folds(all);
    add_block_folds(all, settings.blocks);
  }
  require(!all.folds.empty(), "study grasp: there are no outcomes of grasps to predict");
  return all;
}

}  // namespace posemix
