// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "object_hypotheses.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "posemix/filter/update.hpp"
#include "posemix/mixture/log_weights.hpp"

namespace posemix::internal {
namespace {

/// The hypothesis with the joint Gaussian's pose and covariances where it leads.
ObjectHypothesis current(const JointGaussian& joint, const ObjectState& object, std::size_t h) {
  ObjectHypothesis result = object.hypotheses[h];
  if (!object.index || h != object.leading) return result;
  result.pose = joint.pose(*object.index);
  result.covariance = joint.covariance(*object.index, *object.index);
  result.cross_covariance = joint.covariance(*object.index, kCamera);
  return result;
}

/// True when two hypotheses agree; `b` becomes the representative of its pose that is nearest.
bool agree(const JointGaussian& joint, const ObjectState& object, const ObjectHypothesis& a,
           ObjectHypothesis& b, const MergeBounds& bounds) {
  const Matrix6d camera = joint.covariance(kCamera, kCamera);
  const auto seen_from_camera = [&](const ObjectHypothesis& h) {
    return Matrix6d(h.covariance + camera - h.cross_covariance - h.cross_covariance.transpose());
  };
  if ((a.pose.translation() - b.pose.translation()).norm() > bounds.translation_m) return false;
  if (!object.sensor.symmetries.is_trivial()) {
    b.pose = object.sensor.symmetries.closest(b.pose, a.pose, Matrix6d::Identity());
  }
  if ((a.pose.rotation().inverse() * b.pose.rotation()).log().norm() > bounds.rotation_rad)
    return false;
  const Eigen::LLT<Matrix6d> mean(0.5 * (seen_from_camera(a) + seen_from_camera(b)));
  const Vector6d z = (b.pose * a.pose.inverse()).log();
  return mean.matrixL().solve(z).squaredNorm() < bounds.squared_distance;
}

/// Midway-merge paper, eq. 12 to 19, for the object's rows of two joint densities.
struct Midway {
  SE3d pose;
  Vector6d mean_a;
  Vector6d mean_b;
  Matrix6d transport_a;  ///< J_l^-1, eq. 14
  Matrix6d transport_b;
  double share_a;
  double share_b;

  Midway(const ObjectHypothesis& a, const ObjectHypothesis& b) {
    share_b = 1.0 / (1.0 + std::exp(a.log_weight - b.log_weight));
    share_a = 1.0 - share_b;
    const Vector6d distance = (b.pose * a.pose.inverse()).log();
    mean_a = -share_b * distance;
    mean_b = share_a * distance;
    pose = SE3d::exp(-mean_a) * a.pose;
    transport_a = SE3d::left_jacobian_inverse(mean_a);
    transport_b = SE3d::left_jacobian_inverse(mean_b);
  }
  Matrix6d covariance(const Matrix6d& a, const Matrix6d& b) const {
    Matrix6d sum =
        share_a * (transport_a * a * transport_a.transpose() + mean_a * mean_a.transpose()) +
        share_b * (transport_b * b * transport_b.transpose() + mean_b * mean_b.transpose());
    symmetrize(sum);
    return sum;
  }
  template <class Block>
  Block cross(const Block& a, const Block& b) const {
    return share_a * transport_a * a + share_b * transport_b * b;
  }
};

ObjectHypothesis merged(const ObjectHypothesis& a, const ObjectHypothesis& b,
                        const Midway& midway) {
  const double weights[] = {a.log_weight, b.log_weight};
  ObjectHypothesis result = a.log_weight >= b.log_weight ? a : b;
  result.pose = midway.pose;
  result.covariance = midway.covariance(a.covariance, b.covariance);
  result.cross_covariance = midway.cross(a.cross_covariance, b.cross_covariance);
  result.log_weight = log_sum_exp(weights);
  result.score = std::max(a.score, b.score);
  result.detections = std::max(a.detections, b.detections);
  return result;
}

/// Rows of the joint Gaussian for hypothesis h: its own where it leads, by regression on the camera
/// otherwise.
Eigen::MatrixXd rows_of(const JointGaussian& joint, const ObjectState& object,
                        const ObjectHypothesis& hypothesis, bool leads) {
  if (leads) return rows(joint.covariance(), *object.index);
  const Eigen::LLT<Matrix6d> camera(joint.covariance(kCamera, kCamera));
  const Matrix6d by = camera.solve(hypothesis.cross_covariance.transpose()).transpose();
  return by * rows(joint.covariance(), kCamera);
}

void merge_two(JointGaussian& joint, ObjectState& object, std::size_t a, std::size_t b,
               const ObjectHypothesis& at_a, const ObjectHypothesis& at_b) {
  const Midway midway(at_a, at_b);
  const ObjectHypothesis result = merged(at_a, at_b, midway);
  if (object.leading == a || object.leading == b) {
    const Eigen::MatrixXd row = midway.cross(rows_of(joint, object, at_a, object.leading == a),
                                             rows_of(joint, object, at_b, object.leading == b));
    joint.set_rows(*object.index, midway.pose, row, result.covariance);
  }
  object.hypotheses[a] = result;
  object.hypotheses.erase(object.hypotheses.begin() + static_cast<std::ptrdiff_t>(b));
  if (object.leading == b) {
    object.leading = a;
  } else if (object.leading > b) {
    --object.leading;
  }
}

}  // namespace

Pair pair_of(const JointGaussian& joint, const ObjectState& object, std::size_t h) {
  if (object.index && h == object.leading) return joint.pair(*object.index);
  const ObjectHypothesis& hypothesis = object.hypotheses[h];
  Pair pair{joint.pose(kCamera), hypothesis.pose, {}};
  pair.covariance.topLeftCorner<6, 6>() = joint.covariance(kCamera, kCamera);
  pair.covariance.bottomLeftCorner<6, 6>() = hypothesis.cross_covariance;
  pair.covariance.topRightCorner<6, 6>() = hypothesis.cross_covariance.transpose();
  pair.covariance.bottomRightCorner<6, 6>() = hypothesis.covariance;
  return pair;
}

void follow_camera(ObjectHypothesis& hypothesis, const Vector6d& mean, const Matrix6d& covariance,
                   const Vector6d& new_mean, const Matrix6d& new_covariance) {
  // G = P_OC P_CC^-1, O <- Exp(G (m' - m)) O, P_OO += G (P_CC' - P_CC) G^T, P_OC <- G P_CC'.
  const Eigen::LLT<Matrix6d> camera(covariance);
  const Matrix6d g = camera.solve(hypothesis.cross_covariance.transpose()).transpose();
  const Vector6d shift = g * (new_mean - mean);
  hypothesis.pose = SE3d::exp(shift) * hypothesis.pose;
  hypothesis.covariance += g * (new_covariance - covariance) * g.transpose();
  symmetrize(hypothesis.covariance);
  hypothesis.cross_covariance.noalias() = g * new_covariance;
}

std::size_t merge_hypotheses(JointGaussian& joint, ObjectState& object, const MergeBounds& bounds) {
  std::size_t merges = 0;
  auto& list = object.hypotheses;
  for (std::size_t a = 0; a < list.size(); ++a) {
    for (std::size_t b = a + 1; b < list.size();) {
      const ObjectHypothesis at_a = current(joint, object, a);
      ObjectHypothesis at_b = current(joint, object, b);
      if (agree(joint, object, at_a, at_b, bounds)) {
        merge_two(joint, object, a, b, at_a, at_b);
        ++merges;
      } else {
        ++b;
      }
    }
  }
  return merges;
}

void keep_best(ObjectState& object, std::size_t most, std::size_t protected_hypotheses) {
  auto& list = object.hypotheses;
  if (list.size() <= most) return;
  std::vector<std::size_t> order(list.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return list[a].log_weight > list[b].log_weight;
  });
  const auto heaviest =
      order.begin() + static_cast<std::ptrdiff_t>(most - std::min(protected_hypotheses, most - 1));
  std::stable_sort(heaviest, order.end(), [&](std::size_t a, std::size_t b) {
    return list[a].score != list[b].score ? list[a].score > list[b].score : list[a].id > list[b].id;
  });
  order.resize(most);
  // The leader stays whatever happens: the joint Gaussian speaks of it.
  if (std::find(order.begin(), order.end(), object.leading) == order.end())
    order.back() = object.leading;
  std::sort(order.begin(), order.end());
  std::vector<ObjectHypothesis> kept;
  kept.reserve(most);
  const std::size_t leader = object.leading;
  for (const std::size_t h : order) {
    if (h == leader) object.leading = kept.size();
    kept.push_back(list[h]);
  }
  list = std::move(kept);
}

void normalise(ObjectState& object) {
  std::vector<double> weights{object.log_absent};
  for (const ObjectHypothesis& hypothesis : object.hypotheses)
    weights.push_back(hypothesis.log_weight);
  const double total = log_sum_exp(weights);
  object.log_absent -= total;
  for (ObjectHypothesis& hypothesis : object.hypotheses) hypothesis.log_weight -= total;
}

bool choose_leader(JointGaussian& joint, ObjectState& object, double margin) {
  auto& list = object.hypotheses;
  const auto heaviest = std::max_element(list.begin(), list.end(),
                                         [](const ObjectHypothesis& a, const ObjectHypothesis& b) {
                                           return a.log_weight < b.log_weight;
                                         });
  const auto h = static_cast<std::size_t>(heaviest - list.begin());
  if (h == object.leading || heaviest->log_weight <= list[object.leading].log_weight + margin)
    return false;
  list[object.leading] = current(joint, object, object.leading);
  joint.replace(*object.index, heaviest->pose, heaviest->covariance, heaviest->cross_covariance);
  object.leading = h;
  return true;
}

}  // namespace posemix::internal
