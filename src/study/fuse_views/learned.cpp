// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "learned.hpp"

#include <algorithm>

#include "posemix/detector/noise_fit.hpp"

namespace posemix {
namespace {

/// The row of an object nearest to a true pose.
const BopRow* nearest_row(const std::vector<BopRow>& rows, const BopRow& truth, double match_m) {
  const BopRow* best = nullptr;
  double least = match_m;
  for (const BopRow& row : rows) {
    const double distance = (row.pose.translation() - truth.pose.translation()).norm();
    if (row.object != truth.object || distance > least) continue;
    least = distance;
    best = &row;
  }
  return best;
}

struct LearnedCounts {
  double rows = 0.0, true_rows = 0.0, shown = 0.0, seen = 0.0;
};

/// The detections of one true instance, one for each image that shows it.
NoiseTrack track_of(const MultiViewScene& scene, std::int64_t object, const SE3d& world_object,
                    const SymmetryGroup& symmetries, double match_m) {
  constexpr double kSamePlaceM = 2e-3;
  constexpr double kMetresPerRadian = 0.1;
  Matrix6d information = Matrix6d::Identity();
  information.bottomRightCorner<3, 3>() /= kMetresPerRadian * kMetresPerRadian;
  NoiseTrack track(scene.images.size());
  for (std::size_t k = 0; k < scene.images.size(); ++k) {
    const SE3d camera_object = scene.world_camera[k].inverse() * world_object;
    for (const BopRow& truth : scene.truth[k]) {
      if (truth.object != object ||
          (truth.pose.translation() - camera_object.translation()).norm() > kSamePlaceM)
        continue;
      const BopRow* row = nearest_row(scene.estimates[k], truth, match_m);
      if (row == nullptr) continue;
      track[k] = NoiseObservation{symmetries.closest(truth.pose, row->pose, information), row->pose,
                                  static_cast<std::size_t>(scene.number)};
    }
  }
  return track;
}

void count_rows(const MultiViewScene& scene, double match_m, LearnedCounts& counts) {
  for (std::size_t k = 0; k < scene.images.size(); ++k) {
    counts.rows += static_cast<double>(scene.estimates[k].size());
    for (const BopRow& truth : scene.truth[k]) {
      counts.shown += 1.0;
      counts.seen += nearest_row(scene.estimates[k], truth, match_m) != nullptr ? 1.0 : 0.0;
    }
    for (const BopRow& row : scene.estimates[k]) {
      const auto known = scene.world_objects.find(row.object);
      if (known == scene.world_objects.end()) continue;
      const Eigen::Vector3d place = scene.world_camera[k] * row.pose.translation();
      counts.true_rows += std::any_of(known->second.begin(), known->second.end(),
                                      [&](const SE3d& object) {
                                        return (object.translation() - place).norm() <= match_m;
                                      })
                              ? 1.0
                              : 0.0;
    }
  }
}

}  // namespace

LearnedDetector learned_detector(const std::vector<const MultiViewScene*>& scenes,
                                 const FuseViewsStudySettings& settings) {
  std::vector<NoiseTrack> tracks;
  LearnedCounts counts;
  for (const MultiViewScene* scene : scenes) {
    count_rows(*scene, settings.match_m, counts);
    const SymmetryGroups& groups = settings.objects.at(scene->dataset).symmetries;
    for (const auto& [object, instances] : scene->world_objects) {
      const auto known = groups.find(object);
      for (const SE3d& instance : instances) {
        tracks.push_back(track_of(*scene, object, instance,
                                  known == groups.end() ? SymmetryGroup() : known->second,
                                  settings.match_m));
      }
    }
  }
  RandomStream stream(settings.seed);
  const NoiseFit fit = fit_noise(
      tracks, {.max_components = 3, .restarts = 3, .frame = NoiseFrame::ray, .modes = false},
      stream);
  // The fit has seen only rows at objects; what is clutter there is turned.
  const double true_share = counts.true_rows / counts.rows;
  const double turned = true_share * fit.noise.clutter().weight;
  const double clutter = 1.0 - true_share + turned;
  std::vector<NoiseComponent> components = fit.noise.components();
  for (NoiseComponent& component : components) component.weight *= true_share;
  const DetectorNoise noise(components, {clutter, fit.noise.clutter().volume_m3},
                            fit.noise.dependence());
  return {noise, std::clamp(counts.seen / counts.shown, 0.01, 0.99), turned / clutter};
}

}  // namespace posemix
