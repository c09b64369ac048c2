// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "study.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "learned.hpp"
#include "posemix/base/error.hpp"
#include "report.hpp"
#include "run.hpp"
#include "scene.hpp"
#include "study/tless/scene.hpp"

namespace posemix {
namespace {

std::string fuse_views_settings_text(const FuseViewsStudySettings& s,
                                     const std::vector<MultiViewScene>& scenes) {
  const FuseViewsSettings& f = s.fusion;
  nlohmann::ordered_json json = {{"data", s.data.string()},
                                 {"views", s.views},
                                 {"seed", s.seed},
                                 {"least_score", s.least_score},
                                 {"match_m", s.match_m},
                                 {"detection_probability", f.detection_probability},
                                 {"turned_share", f.turned_share},
                                 {"gate_probability", f.gate_probability},
                                 {"mode_angle_rad", f.mode_angle_rad},
                                 {"least_separation_m", f.least_separation_m},
                                 {"max_hypotheses", f.max_hypotheses},
                                 {"max_association_hypotheses", f.max_association_hypotheses},
                                 {"max_components", f.max_components},
                                 {"prune_below", f.prune_below}};
  for (const MultiViewScene& scene : scenes)
    json["scenes"].push_back({scene.dataset, scene.number, scene.images.size()});
  for (const auto& [dataset, objects] : s.objects) {
    auto& entry = json["objects"][dataset];
    for (const auto& [object, group] : objects.symmetries)
      entry["symmetries"].push_back({object, group.elements().size(), group.axes().size()});
    for (const auto& [object, box] : objects.boxes)
      entry["boxes"].push_back({object, box.size_m.norm()});
  }
  return json.dump();
}

std::vector<MultiViewScene> read_all_scenes(const FuseViewsStudySettings& settings) {
  std::vector<MultiViewScene> scenes;
  for (const std::string& dataset : settings.datasets) {
    for (MultiViewScene& scene : read_multi_view_scenes(settings.data, dataset))
      scenes.push_back(std::move(scene));
  }
  for (const std::int64_t number : settings.scenes) {
    const auto is_it = [&](const MultiViewScene& scene) { return scene.number == number; };
    if (std::none_of(scenes.begin(), scenes.end(), is_it))
      throw InvalidInput(fmt::format("{}: has no scene {}", settings.data.string(), number));
  }
  return scenes;
}

FuseViewsSettings read_fusion(const TomlTable& table) {
  using S = FuseViewsSettings;
  S s;
  const auto count = [&](const char* name, std::size_t value) {
    return static_cast<std::size_t>(
        table.get_integer_or(name, static_cast<std::int64_t>(value), kAtLeastOne));
  };
  s.detection_probability =
      table.get_double_or("detection_probability", s.detection_probability, S::kProbability);
  s.turned_share = table.get_double_or("turned_share", s.turned_share, S::kShare);
  s.gate_probability = table.get_double_or("gate_probability", s.gate_probability, S::kProbability);
  s.mode_angle_rad =
      radians(table.get_double_or("mode_angle_deg", degrees(s.mode_angle_rad), kNotNegative));
  s.least_separation_m =
      table.get_double_or("least_separation_m", s.least_separation_m, kNotNegative);
  s.max_hypotheses = count("max_hypotheses", s.max_hypotheses);
  s.max_association_hypotheses = count("max_association_hypotheses", s.max_association_hypotheses);
  s.max_components = count("max_components", s.max_components);
  s.prune_below = table.get_double_or("prune_below", s.prune_below, S::kShare);
  return s;
}

FuseViewsObjects read_objects(const TomlTable& table, const std::string& dataset) {
  FuseViewsObjects objects;
  if (dataset == "tless") objects.symmetries = tless_symmetries();
  const auto models = table.find_table("models_info");
  if (models && models->has(dataset)) {
    objects.symmetries.clear();
    for (const auto& [object, model] : read_bop_models(models->get_string(dataset))) {
      objects.symmetries.emplace(object, model.symmetries);
      if (model.box) objects.boxes.emplace(object, *model.box);
    }
  }
  const auto symmetries = table.find_table("symmetries");
  if (symmetries && symmetries->has(dataset))
    objects.symmetries = read_symmetry_file(symmetries->get_string(dataset));
  return objects;
}

}  // namespace

FuseViewsStudySettings read_fuse_views_settings(const TomlTable& table) {
  FuseViewsStudySettings s;
  if (table.has("datasets")) s.datasets = table.get_strings("datasets");
  for (const std::string& dataset : s.datasets) {
    if (dataset != "tless" && dataset != "ycbv")
      table.fail("datasets", fmt::format("got {}, expected tless or ycbv", dataset));
    s.objects[dataset] = read_objects(table, dataset);
  }
  if (table.has("scenes")) {
    for (const double number : table.get_vector("scenes", {}, {.lowest = 0.0, .highest = 1e6})) {
      if (number != std::floor(number)) table.fail("scenes", "expected whole numbers");
      s.scenes.push_back(static_cast<std::int64_t>(number));
    }
  }
  s.views = static_cast<std::size_t>(table.get_integer_or("views", 4, {.lowest = 2}));
  s.seed = static_cast<std::uint64_t>(table.get_integer_or("seed", 1, kAtLeastZero));
  s.least_score = table.get_double_or("least_score", s.least_score);
  s.match_m = table.get_double_or("match_m", s.match_m, kPositive);
  if (const auto fusion = table.find_table("fusion")) s.fusion = read_fusion(*fusion);
  return s;
}

namespace {

/// For every wanted scene what the dataset's scenes of the other half tell: those of odd place in
/// the order of their numbers for those of even place, and the other way round.
std::vector<LearnedDetector> learned_from_others(const FuseViewsStudySettings& settings,
                                                 const std::vector<MultiViewScene>& scenes,
                                                 const std::vector<bool>& wanted) {
  std::map<std::string, std::array<std::vector<const MultiViewScene*>, 2>> halves;
  std::vector<std::size_t> half;
  for (const MultiViewScene& scene : scenes) {
    auto& both = halves[scene.dataset];
    half.push_back((both[0].size() + both[1].size()) % 2);
    both[half.back()].push_back(&scene);
  }
  std::map<std::pair<std::string, std::size_t>, LearnedDetector> learned;
  std::vector<LearnedDetector> result;
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    if (!wanted[i]) continue;
    const std::pair key{scenes[i].dataset, half[i]};
    auto known = learned.find(key);
    if (known == learned.end()) {
      const auto& others = halves[key.first][1 - key.second];
      known = learned.emplace(key, learned_detector(others, settings)).first;
    }
    result.push_back(known->second);
  }
  return result;
}

}  // namespace

Study make_fuse_views_study(const FuseViewsStudySettings& settings) {
  const std::vector<MultiViewScene> all = read_all_scenes(settings);
  std::vector<bool> wanted;
  std::vector<MultiViewScene> scenes;
  for (const MultiViewScene& scene : all) {
    const auto& numbers = settings.scenes;
    wanted.push_back(numbers.empty() ||
                     std::find(numbers.begin(), numbers.end(), scene.number) != numbers.end());
    if (wanted.back()) scenes.push_back(scene);
  }
  struct Item {
    MultiViewScene scene;
    LearnedDetector learned;
  };
  const std::vector<LearnedDetector> learned = learned_from_others(settings, all, wanted);
  const auto items = std::make_shared<std::vector<Item>>();
  for (std::size_t i = 0; i < scenes.size(); ++i) items->push_back({scenes[i], learned[i]});
  Study study;
  study.name = "fuse-views";
  study.settings = fuse_views_settings_text(settings, scenes);
  study.items = items->size();
  study.run_item = [settings, items](std::size_t index) {
    const Item& item = items->at(index);
    return run_fuse_views(item.scene, settings, item.learned).dump();
  };
  study.report = report_fuse_views;
  return study;
}

}  // namespace posemix
