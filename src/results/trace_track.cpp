// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "trace_track.hpp"

#include "draw/position_covariance.hpp"

namespace posemix::internal {
namespace {

/// [xx, xy, xz, yy, yz, zz] of the position's covariance.
Json position_covariance_of(const PoseDensity& density) {
  const Eigen::Matrix3d covariance = position_covariance(density);
  Eigen::Matrix<double, 6, 1> upper;
  upper << covariance(0, 0), covariance(0, 1), covariance(0, 2), covariance(1, 1), covariance(1, 2),
      covariance(2, 2);
  return json_vector(upper, kCompactDigits);
}

/// The upper triangle of a covariance, row by row.
Json upper_triangle_of(const Matrix6d& covariance) {
  Eigen::Matrix<double, 21, 1> upper;
  Eigen::Index next = 0;
  for (Eigen::Index i = 0; i < 6; ++i) {
    for (Eigen::Index j = i; j < 6; ++j) upper[next++] = covariance(i, j);
  }
  return json_vector(upper, kPoseDigits);
}

}  // namespace

Json compact_number(const std::optional<double>& number) {
  return number ? json_number(rounded(*number, kCompactDigits)) : Json(nullptr);
}

void TraceTrackWriter::compare(const ErrorReduction& reduction) {
  truths_.resize(densities_.size());
  nees_.resize(densities_.size());
  for (std::size_t k = 0; k < densities_.size(); ++k) {
    if (!truths_[k]) continue;
    has_truth_ = true;
    if (densities_[k] == nullptr) continue;
    nees_[k] = reduction.nees(*densities_[k], *truths_[k]);
    truths_[k] = reduction.nearest(*truths_[k], densities_[k]->mean());
  }
}

void TraceTrackWriter::write(JsonWriter& out) const {
  const std::size_t frames = densities_.size();
  const auto each = [&](const char* key, const auto& json) {
    out.array(key, frames, [&](std::size_t k) {
      return densities_[k] == nullptr ? Json(nullptr) : json(*densities_[k]);
    });
  };
  each("pose", [](const PoseDensity& x) { return json_pose(x.mean(), kPoseDigits); });
  each("sd", [](const PoseDensity& x) {
    return json_vector(x.covariance().diagonal().cwiseSqrt(), kCompactDigits);
  });
  each("position_covariance", position_covariance_of);
  each("covariance", [](const PoseDensity& x) { return upper_triangle_of(x.covariance()); });
  if (!has_truth_) return out.entry("truth", nullptr);
  out.array("truth", frames, [&](std::size_t k) { return json_pose(truths_[k], kPoseDigits); });
  out.array("nees", frames, [&](std::size_t k) { return compact_number(nees_[k]); });
}

}  // namespace posemix::internal
