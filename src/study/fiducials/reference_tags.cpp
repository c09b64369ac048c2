// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <cmath>

#include <Eigen/SVD>

#include "posemix/base/statistics.hpp"
#include "posemix/base/units.hpp"
#include "score.hpp"

/// The pose of a tag that most of its sightings agree with.
namespace posemix {
namespace {

constexpr double kNearDeg = 15.0;
constexpr double kNearM = 0.5;
/// A component counts by exp(-(angle / kSpreadDeg)^2 / 2): of two poses with as many components the
/// one that stays at its place as the camera moves wins, as the true one does.
constexpr double kSpreadDeg = 5.0;
constexpr std::size_t kCandidates = 400;
constexpr int kRefinements = 5;

/// A pose as matrix and vector, for many comparisons.
struct Place {
  Eigen::Matrix3d rotation;
  Eigen::Vector3d translation;
};

double angle_deg(const Place& a, const Place& b) {
  const double chord = (a.rotation - b.rotation).norm() / std::sqrt(8.0);
  return degrees(2.0 * std::asin(std::min(chord, 1.0)));
}

/// The components of all sightings of one tag, in the map.
class Components {
 public:
  void begin_sighting() { ++sightings_; }
  void add(const SE3d& map_tag) {
    places_.push_back({map_tag.rotation().matrix(), map_tag.translation()});
    sighting_.push_back(sightings_ - 1);
  }
  /// The directions of the cameras in the tag's frame are those of the views.
  void add_view(const Eigen::Vector3d& map_camera) { cameras_.push_back(map_camera); }

  ReferenceTag most_supported() const {
    const std::vector<std::size_t> tried = candidates();
    std::vector<double> votes(tried.size());
    std::transform(tried.begin(), tried.end(), votes.begin(),
                   [&](std::size_t i) { return support(places_[i]).votes; });
    Place best = places_[tried[index_of_largest(votes)]];
    for (int i = 0; i < kRefinements; ++i) {
      const std::vector<std::size_t> near = support(best).near;
      if (!near.empty()) best = median_of(near);
    }
    ReferenceTag tag;
    tag.pose = SE3d(SO3d::from_matrix(best.rotation), best.translation);
    tag.sightings = sightings_;
    tag.share = share(best);
    for (std::size_t i = 0; i < tried.size(); ++i) {
      if (angle_deg(places_[tried[i]], best) <= 2.0 * kNearDeg) votes[i] = -1.0;
    }
    const std::size_t rival = index_of_largest(votes);
    if (votes[rival] >= 0.0) tag.rival_share = share(places_[tried[rival]]);
    tag.span_deg = span_deg(best.translation);
    return tag;
  }

 private:
  struct Support {
    double votes = 0.0;
    std::vector<std::size_t> near = {};
    std::size_t sightings = 0;
  };

  static std::size_t index_of_largest(const std::vector<double>& values) {
    return static_cast<std::size_t>(std::max_element(values.begin(), values.end()) -
                                    values.begin());
  }

  /// Evenly over all components, at most kCandidates.
  std::vector<std::size_t> candidates() const {
    const double last = static_cast<double>(places_.size() - 1);
    std::vector<std::size_t> chosen;
    for (std::size_t i = 0; i < kCandidates; ++i) {
      const double place = last / (kCandidates - 1.0) * static_cast<double>(i);
      const std::size_t index =
          i + 1 == kCandidates ? places_.size() - 1 : static_cast<std::size_t>(place);
      if (chosen.empty() || chosen.back() != index) chosen.push_back(index);
    }
    return chosen;
  }

  /// Every sighting votes by its nearest component.
  Support support(const Place& place) const {
    Support result;
    std::vector<double> votes(sightings_, -1.0);
    for (std::size_t i = 0; i < places_.size(); ++i) {
      const double angle = angle_deg(places_[i], place);
      if (angle >= kNearDeg || (places_[i].translation - place.translation).norm() >= kNearM)
        continue;
      result.near.push_back(i);
      const double ratio = angle / kSpreadDeg;
      votes[sighting_[i]] = std::max(votes[sighting_[i]], std::exp(-0.5 * ratio * ratio));
    }
    for (const double vote : votes) {
      result.votes += std::max(vote, 0.0);
      result.sightings += vote >= 0.0 ? 1 : 0;
    }
    return result;
  }

  double share(const Place& place) const {
    return static_cast<double>(support(place).sightings) / static_cast<double>(sightings_);
  }

  /// Medians element by element, of which the rotation is the nearest.
  Place median_of(const std::vector<std::size_t>& chosen) const {
    const auto middle = [&](const auto& element) {
      std::vector<double> values(chosen.size());
      std::transform(chosen.begin(), chosen.end(), values.begin(),
                     [&](std::size_t i) { return element(places_[i]); });
      return median(values);
    };
    Eigen::Matrix3d matrix;
    Eigen::Vector3d translation;
    for (Eigen::Index row = 0; row < 3; ++row) {
      for (Eigen::Index column = 0; column < 3; ++column)
        matrix(row, column) = middle([&](const Place& p) { return p.rotation(row, column); });
      translation[row] = middle([&](const Place& p) { return p.translation[row]; });
    }
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const double sign = (svd.matrixU() * svd.matrixV().transpose()).determinant();
    const Eigen::Vector3d signs(1.0, 1.0, sign > 0.0 ? 1.0 : -1.0);
    return {svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose(), translation};
  }

  /// The largest angle between the directions from a point to two cameras.
  double span_deg(const Eigen::Vector3d& point) const {
    std::vector<Eigen::Vector3d> directions;
    directions.reserve(cameras_.size());
    for (const Eigen::Vector3d& camera : cameras_)
      directions.push_back((camera - point).normalized());
    double least = 1.0;
    for (std::size_t i = 0; i < directions.size(); ++i) {
      for (std::size_t k = 0; k < i; ++k) least = std::min(least, directions[i].dot(directions[k]));
    }
    return degrees(std::acos(std::clamp(least, -1.0, 1.0)));
  }

  std::vector<Place> places_;
  std::vector<std::size_t> sighting_;  ///< of every component
  std::vector<Eigen::Vector3d> cameras_;
  std::size_t sightings_ = 0;
};

}  // namespace

ReferenceTags reference_tags(std::span<const Observation> observations, const CameraPoses& cameras,
                             const ReferencePath& reference) {
  std::map<std::string, Components> components;
  for (const Observation& observation : observations) {
    const auto mounting = cameras.find(observation.camera);
    if (mounting == cameras.end()) continue;
    const std::optional<SE3d> rig = reference.at(observation.stamp_s);
    if (!rig) continue;
    const SE3d map_camera = *rig * mounting->second;
    Components& tag = components[observation.object];
    tag.begin_sighting();
    tag.add_view(map_camera.translation());
    for (const ObservationComponent& component : observation.components)
      tag.add(map_camera * component.pose);
  }
  ReferenceTags tags;
  for (const auto& [name, tag] : components) tags.emplace(name, tag.most_supported());
  return tags;
}

}  // namespace posemix
