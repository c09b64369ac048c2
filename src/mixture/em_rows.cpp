// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/mixture/em_rows.hpp"

#include <fmt/format.h>

#include "posemix/base/error.hpp"

namespace posemix {
namespace {

constexpr std::size_t kQuaternion = 4;

std::size_t blocks(std::size_t samples) { return (samples + kEmBlock - 1) / kEmBlock; }

void put(const SO3d& rotation, EmRow* rows, std::size_t lane) {
  const Eigen::Vector4d q = rotation.quaternion().coeffs();
  for (std::size_t j = 0; j < kQuaternion; ++j) rows[j][lane] = q[static_cast<Eigen::Index>(j)];
}

void put(const SE3d& pose, EmRow* rows, std::size_t lane) {
  put(pose.rotation(), rows, lane);
  const Eigen::Vector3d& t = pose.translation();
  for (std::size_t j = 0; j < 3; ++j) rows[kQuaternion + j][lane] = t[static_cast<Eigen::Index>(j)];
}

template <class G>
std::vector<EmRow> rows_of(std::span<const G> elements, std::size_t dimensions) {
  std::vector<EmRow> rows(blocks(elements.size()) * dimensions);
  for (std::size_t block = 0; block < blocks(elements.size()); ++block) {
    for (std::size_t lane = 0; lane < kEmBlock; ++lane) {
      const std::size_t i = block * kEmBlock + lane;
      put(i < elements.size() ? elements[i] : G(), &rows[block * dimensions], lane);
    }
  }
  return rows;
}

}  // namespace

EmCoordinates::EmCoordinates(std::span<const SO3d> elements)
    : dimensions_(kQuaternion), size_(elements.size()), rows_(rows_of(elements, dimensions_)) {}

EmCoordinates::EmCoordinates(std::span<const SE3d> elements)
    : dimensions_(kQuaternion + 3), size_(elements.size()), rows_(rows_of(elements, dimensions_)) {}

EmCoordinates::EmCoordinates(std::size_t size, Eigen::Index dimensions)
    : dimensions_(static_cast<std::size_t>(dimensions)),
      size_(size),
      rows_(blocks(size) * dimensions_) {}

void EmCoordinates::check_dimensions(std::size_t index, Eigen::Index dimensions) const {
  if (static_cast<std::size_t>(dimensions) == dimensions_) return;
  throw InvalidInput(
      fmt::format("EM: sample {} has {} dimensions, the first {}", index, dimensions, dimensions_));
}

}  // namespace posemix
