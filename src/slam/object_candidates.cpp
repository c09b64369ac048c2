// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <map>

#include "posemix/slam/object_slam.hpp"

namespace posemix {
namespace {

const std::string& class_of(const ObjectModel& model) {
  return model.class_id.empty() ? model.id : model.class_id;
}

}  // namespace

void ObjectSlam::observe_candidates(MultiObjectFilter& filter,
                                    const std::vector<Candidate>& candidates, FrameReport& report) {
  std::map<std::string, std::vector<std::size_t>> models_of;
  for (std::size_t object = 0; object < objects_.size(); ++object)
    models_of[class_of(objects_[object])].push_back(object);
  std::map<std::string, std::vector<std::size_t>> candidates_of;
  for (std::size_t i = 0; i < candidates.size(); ++i)
    candidates_of[candidates[i].class_id].push_back(i);
  for (auto& [name, members] : candidates_of) {
    std::stable_sort(members.begin(), members.end(), [&](std::size_t a, std::size_t b) {
      return candidates[a].score > candidates[b].score;
    });
  }

  report.candidates.assign(candidates.size(), {.status = CandidateStatus::dropped});
  for (const auto& [name, members] : candidates_of) {
    const auto models = models_of.find(name);
    if (models != models_of.end())
      observe_class(filter, models->second, candidates, members, report);
  }
}

void ObjectSlam::observe_class(MultiObjectFilter& filter, const std::vector<std::size_t>& models,
                               const std::vector<Candidate>& candidates,
                               const std::vector<std::size_t>& members, FrameReport& report) {
  // Which instance each candidate is of, all at once.
  std::vector<std::size_t> instances;
  std::vector<ConcentratedGaussian<SE3d>> predicted;
  for (const std::size_t object : models) {
    const auto leading = filter.leading(object);
    if (!leading) continue;
    instances.push_back(object);
    predicted.push_back(predicted_instance(filter, object));
  }
  std::vector<Candidate> of_class;
  of_class.reserve(members.size());
  for (const std::size_t i : members) of_class.push_back(candidates[i]);
  const ObjectModel& model = objects_[models.front()];
  const std::vector<Association> associations = associate(
      predicted, of_class, model.noise.components().front(), model.symmetries, association_);

  // The known before the new: a model that was seen in this frame is not used again.
  for (std::size_t i = 0; i < members.size(); ++i) {
    CandidateReport& candidate = report.candidates[members[i]];
    candidate.status = associations[i].status;
    if (candidate.status != CandidateStatus::assigned) continue;
    candidate.object = instances[associations[i].instance];
    update(filter, *candidate.object, associations[i].camera_object, report);
  }
  for (std::size_t i = 0; i < members.size(); ++i) {
    CandidateReport& candidate = report.candidates[members[i]];
    if (candidate.status != CandidateStatus::fresh) continue;
    candidate = new_instance(filter, models);
    if (candidate.object) update(filter, *candidate.object, associations[i].camera_object, report);
  }
}

ConcentratedGaussian<SE3d> ObjectSlam::predicted_instance(const MultiObjectFilter& filter,
                                                          std::size_t object) const {
  const std::size_t leading = *filter.leading(object);
  ConcentratedGaussian<SE3d> density = filter.relative(object, leading);
  if (motion_.model != MotionModel::odometry) return density;
  // After n detections with noise R the filter has R / (n - 1 + 1 / birth factor), and says as many
  // times that as detections count as one: more than R while n is less.
  const double detections = static_cast<double>(filter.hypotheses(object)[leading].detections);
  const double independent = detections - 1.0 + 1.0 / birth_covariance_factor_;
  const double share = std::min(1.0, independent / filter.correlation_length());
  return ConcentratedGaussian<SE3d>::trusted(density.mean(), share * density.covariance());
}

CandidateReport ObjectSlam::new_instance(MultiObjectFilter& filter,
                                         const std::vector<std::size_t>& models) {
  std::optional<std::size_t> oldest;
  for (const std::size_t object : models) {
    if (!filter.leading(object)) return {.status = CandidateStatus::fresh, .object = object};
    const Sightings& seen = sightings_[object];
    if (seen.count >= confirming_detections_ || seen.last_frame == frame_) continue;
    if (!oldest || seen.last_frame < sightings_[*oldest].last_frame) oldest = object;
  }
  if (!oldest) return {.status = CandidateStatus::dropped};
  filter.forget(*oldest);
  sightings_[*oldest] = {};
  return {.status = CandidateStatus::fresh, .object = oldest, .recycled = true};
}

}  // namespace posemix
