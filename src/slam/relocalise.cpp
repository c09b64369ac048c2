// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/relocalise.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Eigenvalues>

#include "map_search.hpp"
#include "posemix/base/error.hpp"
#include "posemix/base/range.hpp"
#include "posemix/mixture/log_weights.hpp"

namespace posemix {
namespace {

using internal::MapPair;
using internal::MapPose;
using internal::MapSearch;
using internal::MapSide;
using internal::PairsFit;

/// A relocalisation from the poses that were found.
class Relocaliser {
 public:
  Relocaliser(const MultiObjectSlam& old_map, const MultiObjectSlam& now,
              const RelocaliseSettings& settings)
      : old_(old_map, settings.least_existence),
        now_(now, settings.least_existence),
        settings_(settings) {}

  Relocalisation run() const;

 private:
  void describe(const PairsFit& fit, std::span<const std::size_t> shared,
                Relocalisation& result) const;
  void relocate(const PairsFit& fit, std::span<const std::size_t> shared,
                Relocalisation& result) const;

  MapSide old_;
  MapSide now_;
  RelocaliseSettings settings_;
};

/// Objects of the new run that agree with none of the old map.
std::vector<std::size_t> elsewhere(const PairsFit& fit, std::span<const std::size_t> shared) {
  std::vector<std::size_t> found;
  for (const std::size_t object : shared) {
    const bool agrees = std::ranges::any_of(
        fit.pairs(), [&](const MapPair& pair) { return pair.new_object == object; });
    if (!agrees) found.push_back(object);
  }
  return found;
}

void Relocaliser::describe(const PairsFit& fit, std::span<const std::size_t> shared,
                           Relocalisation& result) const {
  const std::vector<double> squared_distances = fit.left_out();
  for (std::size_t k = 0; k < fit.pairs().size(); ++k) {
    const auto& [old_object, a, new_object, b] = fit.pairs()[k];
    result.agreed.push_back(
        {old_.model(old_object).id, a, now_.model(new_object).id, b, squared_distances[k]});
  }
  for (const std::size_t object : elsewhere(fit, shared))
    result.disagreeing.push_back(now_.model(object).id);
}

void Relocaliser::relocate(const PairsFit& fit, std::span<const std::size_t> shared,
                           Relocalisation& result) const {
  const std::vector<std::size_t> moved = elsewhere(fit, shared);
  result.new_old.emplace(fit.new_old(), fit.covariance());
  for (std::size_t j = 0; j < old_.size(); ++j) {
    const auto& hypotheses = old_.hypotheses(j);
    if (hypotheses.empty()) continue;
    const std::string& id = old_.model(j).id;
    const auto pair = std::ranges::find(fit.pairs(), j, &MapPair::old_object);
    if (pair != fit.pairs().end()) {
      const auto& now = now_.hypotheses(pair->new_object)[pair->new_hypothesis];
      const auto [world, given_camera] = fit.relocated(j, pair->old_hypothesis);
      result.objects.push_back({id, world, given_camera, now.probability, true});
      continue;
    }
    const bool may_have_moved = std::ranges::any_of(moved, [&](std::size_t object) {
      return internal::may_be_one(now_.model(object), old_.model(j));
    });
    if (may_have_moved) continue;
    const auto best = std::ranges::max_element(hypotheses, {}, &ObjectHypothesis::probability);
    const auto h = static_cast<std::size_t>(best - hypotheses.begin());
    const double stayed = 1.0 - settings_.moved_probability;
    const auto [world, given_camera] = fit.relocated(j, h);
    result.objects.push_back(
        {id, world, given_camera, best->probability * old_.existence(j) * stayed, false});
  }
}

Relocalisation Relocaliser::run() const {
  const MapSearch search(old_, now_, settings_);
  Relocalisation result{.shared = search.shared().size()};
  if (result.shared < settings_.least_objects) return result;
  result.outcome = RelocaliseOutcome::too_few_agree;
  const std::vector<MapPose> all = search.poses();
  if (all.empty()) return result;
  std::vector<double> logs;
  logs.reserve(all.size());
  for (const MapPose& pose : all) logs.push_back(pose.log_probability);
  const PairsFit& best = all.front().fit;
  result.probability = std::exp(logs.front() - log_sum_exp(logs));
  describe(best, search.shared(), result);
  if (best.pairs().size() < settings_.least_objects) return result;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> rotation(
      Eigen::Matrix3d(best.covariance().topLeftCorner<3, 3>()), Eigen::EigenvaluesOnly);
  const double largest = settings_.largest_rotation_sd_rad;
  if (rotation.eigenvalues().maxCoeff() > largest * largest) {
    result.outcome = RelocaliseOutcome::undetermined;
  } else if (result.probability < settings_.least_probability) {
    result.outcome = RelocaliseOutcome::ambiguous;
  } else {
    result.outcome = RelocaliseOutcome::found;
    relocate(best, search.shared(), result);
  }
  return result;
}

void validate(const RelocaliseSettings& settings) {
  require(settings.least_objects > 0, "least_objects is 0, expected at least 1");
  kUnitInterval.check(settings.least_probability, "least_probability");
  kOpenUnitInterval.check(settings.agreement_probability, "agreement_probability");
  kOpenUnitInterval.check(settings.moved_probability, "moved_probability");
  kPositive.check(settings.volume_m3, "volume_m3");
  kPositive.check(settings.largest_rotation_sd_rad, "largest_rotation_sd_rad");
  kUnitInterval.check(settings.least_existence, "least_existence");
}

}  // namespace

Relocalisation relocalise(const MultiObjectSlam& old_map, const MultiObjectSlam& now,
                          const RelocaliseSettings& settings) {
  validate(settings);
  return Relocaliser(old_map, now, settings).run();
}

std::vector<ObjectModel> models_with_priors(const MultiObjectSlam& old_map,
                                            const Relocalisation& relocalisation) {
  if (relocalisation.outcome != RelocaliseOutcome::found) {
    throw InvalidInput(
        fmt::format("the relocalisation is {}, expected found", word_of(relocalisation.outcome)));
  }
  std::vector<ObjectModel> models = old_map.objects();
  for (ObjectModel& model : models) model.prior.reset();
  for (const RelocatedObject& object : relocalisation.objects) {
    const auto model = std::ranges::find(models, object.object, &ObjectModel::id);
    if (model == models.end()) {
      throw InvalidInput(
          fmt::format("the old map has no object '{}', expected the map that the "
                      "relocalisation is of",
                      object.object));
    }
    model->prior =
        ObjectPrior{PoseDensity(object.world.mean(), object.given_camera), object.probability};
  }
  return models;
}

}  // namespace posemix
