// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/object_model.hpp"

#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "posemix/base/error.hpp"

namespace posemix {
namespace {

bool same(const SE3d& a, const SE3d& b) {
  return a.translation() == b.translation() &&
         a.rotation().quaternion().coeffs() == b.rotation().quaternion().coeffs();
}

bool same(const NoiseComponent& a, const NoiseComponent& b) {
  return a.weight == b.weight && a.covariance == b.covariance && a.frame == b.frame &&
         same(a.offset, b.offset) && a.run_length == b.run_length;
}

bool same(const SymmetryAxis& a, const SymmetryAxis& b) {
  return a.direction == b.direction && a.point == b.point;
}

template <class Value>
bool same(const std::vector<Value>& a, const std::vector<Value>& b) {
  return std::ranges::equal(a, b, [](const Value& x, const Value& y) { return same(x, y); });
}

bool same(const std::optional<SlowError>& a, const std::optional<SlowError>& b) {
  if (!a || !b) return a.has_value() == b.has_value();
  return a->covariance == b->covariance && a->correlation_time_s == b->correlation_time_s &&
         a->correlation_angle_rad == b->correlation_angle_rad;
}

bool same(const NoiseDependence& a, const NoiseDependence& b) {
  return same(a.slow, b.slow) && a.common == b.common && a.mode_time_s == b.mode_time_s &&
         a.is_typical == b.is_typical && a.given_covariance == b.given_covariance;
}

bool same(const DetectorNoise& a, const DetectorNoise& b) {
  return same(a.components(), b.components()) && a.clutter().weight == b.clutter().weight &&
         a.clutter().volume_m3 == b.clutter().volume_m3 && same(a.dependence(), b.dependence());
}

bool same(const SymmetryGroup& a, const SymmetryGroup& b) {
  return same(a.elements(), b.elements()) && same(a.axes(), b.axes());
}

using NamedNoises = std::map<std::string, DetectorNoise>;

bool same(const NamedNoises& a, const NamedNoises& b) {
  return std::ranges::equal(a, b, [](const auto& x, const auto& y) {
    return x.first == y.first && same(x.second, y.second);
  });
}

}  // namespace

const std::string& class_of(const ObjectModel& model) {
  return model.class_id.empty() ? model.id : model.class_id;
}

void require_alike_in_class(std::span<const ObjectModel> models) {
  std::map<std::string, const ObjectModel*> first_of;
  for (const ObjectModel& model : models) {
    const ObjectModel& first = *first_of.try_emplace(class_of(model), &model).first->second;
    const bool noise_differs =
        !same(first.noise, model.noise) || !same(first.detectors, model.detectors);
    if (!noise_differs && same(first.symmetries, model.symmetries)) continue;
    throw InvalidInput(fmt::format(
        "objects '{}' and '{}' are of class '{}', but their {} differ; expected the same", first.id,
        model.id, class_of(model), noise_differs ? "noise models" : "symmetries"));
  }
}

}  // namespace posemix
