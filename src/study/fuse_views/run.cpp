// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "run.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include <nlohmann/json.hpp>

#include "counts.hpp"
#include "metric.hpp"
#include "posemix/base/units.hpp"
#include "posemix/config/noise_toml.hpp"
#include "posemix/io/bop_views.hpp"
#include "posemix/slam/observed_error.hpp"

namespace posemix {
namespace {

using Json = nlohmann::ordered_json;

/// An instance counts as reported from this probability on.
constexpr double kReported = 0.5;
constexpr double kRightModeDeg = 20.0;
constexpr double kRightModeM = 0.05;

/// One kind of run.
struct FuseViewsCase {
  bool random_groups;
  BopRowUse use;
  bool declared;
  const char* noise;
  const LearnedDetector* detector;  ///< null: the default
};

class FuseViewsRun {
 public:
  FuseViewsRun(const MultiViewScene& scene, const FuseViewsStudySettings& settings,
               const FuseViewsCase& kind)
      : scene_(scene),
        objects_(settings.objects.at(scene.dataset)),
        metric_(objects_, settings.match_m),
        rows_{.use = kind.use, .least_score = settings.least_score},
        fusion_(settings.fusion) {
    take_classes(kind);
    RandomStream stream(settings.seed, static_cast<std::uint64_t>(scene.number));
    for (const auto& images :
         image_groups(scene.images.size(), settings.views, kind.random_groups ? &stream : nullptr))
      add_group(images);
  }

  const FuseViewsCounts& counts() const { return counts_; }

 private:
  void take_classes(const FuseViewsCase& kind) {
    if (kind.declared) {
      for (const auto& [object, group] : objects_.symmetries)
        classes_[std::to_string(object)].symmetries = group;
    }
    if (kind.detector == nullptr) return;
    fusion_.detection_probability = kind.detector->detection_probability;
    fusion_.turned_share = kind.detector->turned_share;
    for (const auto& rows : scene_.estimates) {
      for (const BopRow& row : rows)
        classes_[std::to_string(row.object)].noise = kind.detector->noise;
    }
  }

  void add_group(const std::vector<std::size_t>& images) {
    std::vector<View> views;
    views.reserve(images.size());
    for (const std::size_t image : images)
      views.push_back(
          {scene_.world_camera[image], bop_observations(scene_.estimates[image], rows_)});
    const std::vector<FusedInstance> instances = fuse_views(views, classes_, fusion_);
    std::map<std::int64_t, std::vector<SE3d>> fused;
    for (const FusedInstance& instance : instances)
      fused[std::stoll(instance.class_id)].push_back(instance.density[0].density.mean());
    ++counts_.groups;
    for (std::size_t v = 0; v < images.size(); ++v) add_image(images[v], views[v], fused);
    add_instances(images, instances);
  }

  void add_image(std::size_t image, const View& view,
                 const std::map<std::int64_t, std::vector<SE3d>>& fused) {
    std::map<std::int64_t, std::vector<SE3d>> single;
    for (const Observation& observation : view.observations) {
      const std::int64_t object = std::stoll(observation.class_id);
      const SE3d& pose = observation.components[best_component(observation)].pose;
      single[object].push_back(pose);
      ++counts_.rows;
      if (!is_true(object, view.world_camera * pose)) ++counts_.rows_false;
    }
    const SE3d camera_world = view.world_camera.inverse();
    for (const BopRow& row : scene_.truth[image]) {
      ++counts_.pairs;
      const auto of = [&](const std::vector<SE3d>& poses) -> std::optional<FuseViewsErrors> {
        const auto index = metric_.nearest(poses, row.pose);
        if (!index) return std::nullopt;
        return metric_.errors(row.object, poses[*index], row.pose);
      };
      const auto of_single = of(single[row.object]);
      std::vector<SE3d> seen;
      if (const auto found = fused.find(row.object); found != fused.end()) {
        for (const SE3d& pose : found->second) seen.push_back(camera_world * pose);
      }
      const auto of_fused = of(seen);
      const bool both = of_single && of_fused;
      counts_.single.add(of_single, both);
      counts_.fused.add(of_fused, both);
    }
  }

  bool is_true(std::int64_t object, const SE3d& world_object) const {
    const auto known = scene_.world_objects.find(object);
    return known != scene_.world_objects.end() &&
           metric_.nearest(known->second, world_object).has_value();
  }

  /// The true instances that an image of the group shows, in the world.
  std::map<std::int64_t, std::vector<SE3d>> shown(const std::vector<std::size_t>& images) const {
    std::map<std::int64_t, std::vector<SE3d>> result;
    for (const auto& [object, instances] : scene_.world_objects) {
      for (const SE3d& instance : instances) {
        // Clang before 16 cannot capture a structured binding without a name of its own.
        const auto shows = [&, id = object](std::size_t image) {
          return std::any_of(scene_.truth[image].begin(), scene_.truth[image].end(),
                             [&](const BopRow& row) {
                               const SE3d at = scene_.world_camera[image] * row.pose;
                               return row.object == id &&
                                      (at.translation() - instance.translation()).norm() < 2e-3;
                             });
        };
        if (std::any_of(images.begin(), images.end(), shows)) result[object].push_back(instance);
      }
    }
    return result;
  }

  void add_instances(const std::vector<std::size_t>& images,
                     const std::vector<FusedInstance>& instances) {
    std::map<std::int64_t, std::vector<const FusedInstance*>> by_object;
    for (const FusedInstance& instance : instances) {
      const std::int64_t object = std::stoll(instance.class_id);
      by_object[object].push_back(&instance);
      const bool right = is_true(object, instance.density[0].density.mean());
      ++counts_.output;
      counts_.output_true += right ? 1 : 0;
      counts_.probability += instance.probability;
      if (instance.probability < kReported) continue;
      ++counts_.reported;
      if (!right) ++counts_.reported_false;
    }
    for (const auto& [object, truths] : shown(images)) {
      std::vector<SE3d> poses;
      for (const FusedInstance* instance : by_object[object])
        poses.push_back(instance->density[0].density.mean());
      for (const SE3d& truth : truths) {
        ++counts_.instances;
        const auto index = metric_.nearest(poses, truth);
        if (index) add_consistency(object, *by_object[object][*index], truth);
      }
    }
  }

  void add_consistency(std::int64_t object, const FusedInstance& instance, const SE3d& truth) {
    ++counts_.instances_found;
    const auto& density = instance.density[0].density;
    const bool right =
        metric_.errors(object, density.mean(), truth).within(kRightModeDeg, kRightModeM);
    counts_.mode_probability.push_back(std::exp(instance.density[0].log_weight));
    if (!right) return;
    ++counts_.right_mode;
    const ErrorReduction reduction(metric_.symmetries(object));
    const ObservedError error = reduction(density, truth);
    counts_.nees.push_back(error.pose.nees());
    counts_.rotation_nees.push_back(error.rotation.nees());
    counts_.position_nees.push_back(error.position.nees());
    counts_.dof.push_back(static_cast<double>(reduction.dof()));
  }

  const MultiViewScene& scene_;
  const FuseViewsObjects& objects_;
  FuseViewsMetric metric_;
  BopObservationSettings rows_;
  FuseViewsSettings fusion_;
  ViewClasses classes_;
  FuseViewsCounts counts_;
};

}  // namespace

Json run_fuse_views(const MultiViewScene& scene, const FuseViewsStudySettings& settings,
                    const LearnedDetector& learned) {
  const bool has_symmetries = !settings.objects.at(scene.dataset).symmetries.empty();
  LearnedDetector independent = learned;
  independent.noise = learned.noise.as_white();
  std::vector<FuseViewsCase> cases;
  for (const bool random : {true, false}) {
    for (const auto& [word, use] : words<BopRowUse>) {
      for (const bool declared : {true, false}) {
        if (declared && !has_symmetries) continue;
        cases.push_back({random, use, declared, "default", nullptr});
        cases.push_back({random, use, declared, "learned", &learned});
        cases.push_back({random, use, declared, "independent", &independent});
      }
    }
  }
  Json rows = Json::array();
  for (const FuseViewsCase& kind : cases) {
    Json row = {{"dataset", scene.dataset},
                {"scene", scene.number},
                {"groups_of", kind.random_groups ? "random" : "near"},
                {"input", word_of(kind.use)},
                {"symmetries", kind.declared ? "declared" : "none"},
                {"noise", kind.noise}};
    if (kind.detector == &learned)
      row[kLearnedNoise] = format_noise_toml("detector", learned.noise);
    row.update(FuseViewsRun(scene, settings, kind).counts().json());
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace posemix
