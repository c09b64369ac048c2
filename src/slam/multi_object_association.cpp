// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

#include "posemix/slam/multi_object_slam.hpp"

/// Which object the observations of a frame are of.
namespace posemix {
namespace {

/// Observations that are of an instance with less than this part of the largest prior are left out.
constexpr double kLeastWeight = 1e-3;

/// An observation of one pose as the equivalent pose that is nearest to its instance.
Observation as_associated(Observation observation, const Association& association) {
  if (observation.components.size() == 1)
    observation.components.front().pose = association.camera_object;
  return observation;
}

/// All observations that may be of an instance as one mixture: the components of each have its
/// prior weight, eq. (8), since the filter itself knows how well they fit. `best` is the one that
/// is assigned, whose names and clutter it has.
Observation mixed_observation(std::span<const Observation> observations,
                              const JointAssociation& joint, std::size_t instance,
                              std::size_t best) {
  Observation mixed = observations[best];
  mixed.components.clear();
  const Eigen::VectorXd logs = joint.log_priors.col(static_cast<Eigen::Index>(instance));
  const double most = logs.maxCoeff();
  double sum = 0.0;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    const double weight = std::exp(logs[static_cast<Eigen::Index>(i)] - most);
    if (weight < kLeastWeight) continue;
    for (ObservationComponent component : observations[i].components) {
      component.weight *= weight;
      sum += component.weight;
      mixed.components.push_back(std::move(component));
    }
  }
  for (ObservationComponent& component : mixed.components) component.weight /= sum;
  return mixed;
}

}  // namespace

void MultiObjectSlam::update_named(bool moving, std::span<Seen> sightings, FrameReport& report) {
  for (const Seen& seen : sightings) {
    const std::string& id = seen.observation.object;
    if (id.empty()) continue;
    auto object = objects_.find(id);
    const bool moves = object ? moving_.has(*object) : has_own_track(settings_.on_sight->motion);
    if (moves != moving) continue;
    if (!object) {
      ObjectModel model = *settings_.on_sight;
      model.id = id;
      object = add_object(std::move(model));
      report.statuses.push_back(DetectionStatus::none);
      report.nis.emplace_back();
    }
    const bool known = is_known(*object);
    *seen.report = {.status = known ? CandidateStatus::assigned : CandidateStatus::fresh,
                    .object = object};
    update(*object, seen.observation, seen.source, report);
  }
}

void MultiObjectSlam::update_by_class(bool moving, std::span<Seen> sightings, FrameReport& report) {
  // Observations of one class in one image by one detector exclude each other.
  std::map<std::tuple<std::string, std::string, std::string>, std::vector<Seen*>> images;
  for (Seen& seen : sightings) {
    const Observation& o = seen.observation;
    if (o.object.empty()) images[{o.class_id, o.camera, o.detector}].push_back(&seen);
  }
  if (images.empty()) return;
  std::map<std::string, std::vector<std::size_t>> models_of;
  for (std::size_t object = 0; object < objects_.size(); ++object)
    models_of[class_of(objects_[object])].push_back(object);
  for (auto& [key, image] : images) {
    const auto models = models_of.find(std::get<0>(key));
    if (models == models_of.end()) continue;
    const bool any_moves = std::ranges::any_of(
        models->second, [&](std::size_t object) { return moving_.has(object); });
    if (any_moves != moving) continue;
    std::stable_sort(image.begin(), image.end(), [](const Seen* a, const Seen* b) {
      return a->observation.score.value_or(0.0) > b->observation.score.value_or(0.0);
    });
    update_image(models->second, image, report);
  }
}

void MultiObjectSlam::update_image(const std::vector<std::size_t>& models,
                                   std::span<Seen* const> image, FrameReport& report) {
  // Which instance each observation is of, all at once.
  const ObservationSource& source = image.front()->source;
  std::vector<std::size_t> instances;
  std::vector<PoseDensity> predicted;
  for (const std::size_t object : models) {
    if (!is_known(object)) continue;
    instances.push_back(object);
    predicted.push_back(predicted_detection(object, source));
  }
  std::vector<Observation> of_class;
  for (const Seen* seen : image) of_class.push_back(seen->observation);
  const DetectorNoise& noise = filter_.sensor(models.front(), source.detector).noise;
  const JointAssociation joint =
      associate_jointly(predicted, of_class, noise.components().front(),
                        objects_[models.front()].symmetries, settings_.association);
  const std::vector<Association>& associations = joint.best;

  // The known before the new: a model that was seen in this frame is not used again.
  for (std::size_t i = 0; i < image.size(); ++i) {
    CandidateReport& candidate = *image[i]->report;
    candidate.status = associations[i].status;
    if (candidate.status != CandidateStatus::assigned) continue;
    candidate.object = instances[associations[i].instance];
    const std::size_t instance = associations[i].instance;
    const bool is_certain = joint.probabilities(Eigen::Index(i), Eigen::Index(instance)) >=
                            settings_.association.certain_probability;
    update(*candidate.object,
           is_certain ? as_associated(of_class[i], associations[i])
                      : mixed_observation(of_class, joint, instance, i),
           source, report);
  }
  for (std::size_t i = 0; i < image.size(); ++i) {
    CandidateReport& candidate = *image[i]->report;
    if (candidate.status != CandidateStatus::fresh) continue;
    candidate = new_instance(models);
    if (candidate.object) update(*candidate.object, of_class[i], source, report);
  }
}

CandidateReport MultiObjectSlam::new_instance(const std::vector<std::size_t>& models) {
  std::optional<std::size_t> oldest;
  for (const std::size_t object : models) {
    if (!is_known(object)) return {.status = CandidateStatus::fresh, .object = object};
    if (!tracks_.gives_way(object) || tracks_.last_frame(object) == objects_.frames()) continue;
    if (!oldest || tracks_.last_frame(object) < tracks_.last_frame(*oldest)) oldest = object;
  }
  if (!oldest) return {.status = CandidateStatus::dropped};
  forget(*oldest);
  return {.status = CandidateStatus::fresh, .object = oldest, .recycled = true};
}

}  // namespace posemix
