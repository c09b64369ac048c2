// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <map>
#include <tuple>
#include <utility>

#include "posemix/slam/multi_object_slam.hpp"

/// Which object the observations of a frame are of.
namespace posemix {
namespace {

/// An observation of one pose as the equivalent pose that is nearest to its instance.
Observation as_associated(Observation observation, const Association& association) {
  if (observation.components.size() == 1)
    observation.components.front().pose = association.camera_object;
  return observation;
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
    }
    const bool known = is_known(*object);
    *seen.report = {.status = known ? CandidateStatus::assigned : CandidateStatus::fresh,
                    .object = object};
    update(*object, seen.observation, seen.source, report);
  }
}

void MultiObjectSlam::update_by_class(bool moving, std::span<Seen> sightings,
                                      FrameReport& report) {
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
  const std::vector<Association> associations =
      associate_observations(predicted, of_class, noise.components().front(),
                             objects_[models.front()].symmetries, settings_.association);

  // The known before the new: a model that was seen in this frame is not used again.
  for (std::size_t i = 0; i < image.size(); ++i) {
    CandidateReport& candidate = *image[i]->report;
    candidate.status = associations[i].status;
    if (candidate.status != CandidateStatus::assigned) continue;
    candidate.object = instances[associations[i].instance];
    update(*candidate.object, as_associated(of_class[i], associations[i]), source, report);
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
    if (objects_[object].prior) continue;
    if (!tracks_.gives_way(object) || tracks_.last_frame(object) == objects_.frames()) continue;
    if (!oldest || tracks_.last_frame(object) < tracks_.last_frame(*oldest)) oldest = object;
  }
  if (!oldest) return {.status = CandidateStatus::dropped};
  forget(*oldest);
  return {.status = CandidateStatus::fresh, .object = oldest, .recycled = true};
}

}  // namespace posemix
