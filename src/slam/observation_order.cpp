// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "observation_order.hpp"

#include <algorithm>
#include <limits>
#include <tuple>
#include <vector>

namespace posemix::internal {
namespace {

void append_numbers(const ObservationComponent& c, std::vector<double>& numbers) {
  numbers.push_back(-c.weight);
  const Eigen::Vector4d q = c.pose.rotation().quaternion().coeffs();
  numbers.insert(numbers.end(), q.begin(), q.end());
  const Eigen::Vector3d t = c.pose.translation();
  numbers.insert(numbers.end(), t.begin(), t.end());
  if (c.covariance) {
    const auto all = c.covariance->reshaped();
    numbers.insert(numbers.end(), all.begin(), all.end());
  }
}

std::vector<double> numbers_of(const ObservationComponent& c) {
  std::vector<double> numbers;
  append_numbers(c, numbers);
  return numbers;
}

/// The numbers of an observation, for an order that does not depend on when it came.
std::vector<double> numbers_of(const Observation& o) {
  const double none = -std::numeric_limits<double>::infinity();
  std::vector<double> numbers{o.clutter.value_or(none), o.score.value_or(none)};
  for (const ObservationComponent& c : o.components) append_numbers(c, numbers);
  return numbers;
}

}  // namespace

bool comes_before(const Observation& a, const Observation& b) {
  const auto names = [](const Observation& o) {
    return std::tie(o.detector, o.camera, o.object, o.class_id);
  };
  if (names(a) != names(b)) return names(a) < names(b);
  return numbers_of(a) < numbers_of(b);
}

Observation with_ordered_components(Observation observation) {
  std::stable_sort(observation.components.begin(), observation.components.end(),
                   [](const ObservationComponent& a, const ObservationComponent& b) {
                     return a.weight != b.weight ? a.weight > b.weight
                                                 : numbers_of(a) < numbers_of(b);
                   });
  return observation;
}

}  // namespace posemix::internal
