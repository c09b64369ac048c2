// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/fuse_views.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Cholesky>

#include "posemix/base/error.hpp"
#include "posemix/base/statistics.hpp"
#include "slam/view_cluster.hpp"

namespace posemix {
namespace {

using internal::ViewMember;

constexpr double kNone = -std::numeric_limits<double>::infinity();

void check_fuse_settings(const FuseViewsSettings& s) {
  using S = FuseViewsSettings;
  S::kProbability.check(s.detection_probability, "fuse_views: detection_probability");
  S::kShare.check(s.turned_share, "fuse_views: turned_share");
  S::kProbability.check(s.gate_probability, "fuse_views: gate_probability");
  kNotNegative.check(s.mode_angle_rad, "fuse_views: mode_angle_rad");
  kNotNegative.check(s.least_separation_m, "fuse_views: least_separation_m");
  S::kShare.check(s.prune_below, "fuse_views: prune_below");
  require(s.max_hypotheses > 0, "fuse_views: max_hypotheses is 0, expected at least 1");
  require(s.max_association_hypotheses > 0,
          "fuse_views: max_association_hypotheses is 0, expected at least 1");
  require(s.max_components > 0, "fuse_views: max_components is 0, expected at least 1");
}

/// The members of every class.
std::map<std::string, std::vector<ViewMember>> members_by_class(std::span<const View> views) {
  std::map<std::string, std::vector<ViewMember>> classes;
  for (std::size_t v = 0; v < views.size(); ++v) {
    if (!views[v].world_camera.matrix().allFinite()) {
      throw InvalidInput(fmt::format("views[{}].world_camera holds a value that is not finite", v));
    }
    for (std::size_t k = 0; k < views[v].observations.size(); ++k) {
      const Observation& observation = views[v].observations[k];
      const std::string& name =
          observation.object.empty() ? observation.class_id : observation.object;
      try {
        validate(observation);
        require(!name.empty(), "it has neither object nor class, expected one of them");
      } catch (const InvalidInput& error) {
        throw InvalidInput(fmt::format("views[{}].observations[{}]: {}", v, k, error.what()));
      }
      classes[name].push_back({v, k, &observation, views[v].world_camera});
    }
  }
  return classes;
}

/// Groups of observations of one class, each with one observation of a view at most.
class ViewAssociation {
 public:
  ViewAssociation(const std::vector<ViewMember>& members, const ViewClass& known,
                  const FuseViewsSettings& settings, std::size_t views)
      : members_(members), known_(known), settings_(settings), views_(views) {
    fill_gates();
    for (std::size_t i = 0; i < members_.size(); ++i) {
      clusters_.push_back({i});
      evidence_.push_back(evidence_of(clusters_.back()));
    }
    const auto count = static_cast<Eigen::Index>(clusters_.size());
    gain_ = Eigen::MatrixXd::Constant(count, count, kNone);
    for (Eigen::Index a = 0; a < count; ++a) {
      for (Eigen::Index b = a + 1; b < count; ++b) gain_(a, b) = gain_of(at(a), at(b));
    }
  }

  /// Joins the pair of the largest gain until there is no gain.
  std::vector<std::vector<ViewMember>> run() {
    while (gain_.size() > 0) {
      Eigen::Index a = 0;
      Eigen::Index b = 0;
      if (!(gain_.maxCoeff(&a, &b) > 0.0)) break;
      join(a, b);
    }
    std::vector<std::vector<ViewMember>> groups;
    for (const auto& cluster : clusters_) {
      if (!cluster.empty()) groups.push_back(members_of(cluster));
    }
    return groups;
  }

 private:
  using Cluster = std::vector<std::size_t>;  ///< indices of members, rising

  static std::size_t at(Eigen::Index index) { return static_cast<std::size_t>(index); }

  void fill_gates() {
    const double limit = chi_square_quantile(settings_.gate_probability, 3, "gate_probability");
    std::vector<Eigen::Vector3d> positions;
    std::vector<Eigen::Matrix3d> covariances;
    for (const ViewMember& member : members_) {
      positions.push_back(member.position());
      covariances.push_back(internal::position_covariance(member, known_));
    }
    is_near_.assign(members_.size(), std::vector<bool>(members_.size(), false));
    for (std::size_t i = 0; i < members_.size(); ++i) {
      for (std::size_t k = i + 1; k < members_.size(); ++k) {
        if (members_[i].view == members_[k].view) continue;
        const Eigen::LLT<Eigen::Matrix3d> factor(Eigen::Matrix3d(covariances[i] + covariances[k]));
        const Eigen::Vector3d whitened =
            factor.matrixL().solve(Eigen::Vector3d(positions[k] - positions[i]));
        is_near_[i][k] = is_near_[k][i] = whitened.squaredNorm() <= limit;
      }
    }
  }

  std::vector<ViewMember> members_of(const Cluster& cluster) const {
    std::vector<ViewMember> result;
    for (const std::size_t i : cluster) result.push_back(members_[i]);
    return result;
  }
  double evidence_of(const Cluster& cluster) const {
    return internal::cluster_belief(members_of(cluster), known_, settings_, views_,
                                    settings_.max_association_hypotheses)
        .log_evidence();
  }
  /// All observations of the two are from different views and near each other.
  bool can_join(const Cluster& a, const Cluster& b) const {
    for (const std::size_t i : a) {
      for (const std::size_t k : b) {
        if (!is_near_[i][k]) return false;
      }
    }
    return !a.empty() && !b.empty();
  }
  static Cluster joined(const Cluster& a, const Cluster& b) {
    Cluster both;
    std::merge(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(both));
    return both;
  }
  double gain_of(std::size_t a, std::size_t b) const {
    if (!can_join(clusters_[a], clusters_[b])) return kNone;
    return evidence_of(joined(clusters_[a], clusters_[b])) - evidence_[a] - evidence_[b];
  }
  void join(Eigen::Index a, Eigen::Index b) {
    clusters_[at(a)] = joined(clusters_[at(a)], clusters_[at(b)]);
    clusters_[at(b)].clear();
    evidence_[at(a)] = evidence_of(clusters_[at(a)]);
    gain_.row(b).setConstant(kNone);
    gain_.col(b).setConstant(kNone);
    for (Eigen::Index k = 0; k < gain_.rows(); ++k) {
      if (k == a) continue;
      gain_(std::min(a, k), std::max(a, k)) = gain_of(at(std::min(a, k)), at(std::max(a, k)));
    }
  }

  const std::vector<ViewMember>& members_;
  const ViewClass& known_;
  const FuseViewsSettings& settings_;
  std::size_t views_;
  std::vector<std::vector<bool>> is_near_;
  std::vector<Cluster> clusters_;
  std::vector<double> evidence_;
  Eigen::MatrixXd gain_;  ///< of joining two clusters, above the diagonal
};

void sort_by_probability(std::vector<FusedInstance>& instances) {
  std::stable_sort(instances.begin(), instances.end(),
                   [](const auto& a, const auto& b) { return a.probability > b.probability; });
}

/// The instances of one class without those at the place of a more probable one.
std::vector<FusedInstance> instances_of(const std::vector<ViewMember>& members,
                                        const ViewClass& known, const FuseViewsSettings& settings,
                                        std::size_t views) {
  std::vector<FusedInstance> all;
  for (const auto& group : ViewAssociation(members, known, settings, views).run())
    all.push_back(internal::fused_instance(group, known, settings, views));
  sort_by_probability(all);
  const bool is_one = !members.front().observation->object.empty();
  std::vector<FusedInstance> kept;
  for (FusedInstance& instance : all) {
    const Eigen::Vector3d place = instance.density[0].density.mean().translation();
    const bool has_room = std::none_of(kept.begin(), kept.end(), [&](const auto& other) {
      return is_one || (other.density[0].density.mean().translation() - place).norm() <
                           settings.least_separation_m;
    });
    if (has_room) kept.push_back(std::move(instance));
  }
  return kept;
}

}  // namespace

std::vector<FusedInstance> fuse_views(std::span<const View> views, const ViewClasses& classes,
                                      const FuseViewsSettings& settings) {
  check_fuse_settings(settings);
  std::vector<FusedInstance> result;
  for (const auto& [name, members] : members_by_class(views)) {
    const auto known = classes.find(name);
    const ViewClass defaults;
    for (FusedInstance& instance : instances_of(
             members, known == classes.end() ? defaults : known->second, settings, views.size())) {
      instance.class_id = name;
      result.push_back(std::move(instance));
    }
  }
  sort_by_probability(result);
  return result;
}

}  // namespace posemix
