// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "sphere_cubature.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "quadrature_rules.hpp"

namespace posemix::internal {
namespace {

constexpr double kQuarter = 0.25 * std::numbers::pi;
constexpr int kMaxSeedDepth = 12;
/// Factor on the errors, because ridges and kinks can make two rules agree by accident.
constexpr double kSafety = 4.0;

/// A face of the cube: the coordinate that is +-1, and the axes of the other two.
struct Face {
  int normal;
  double sign;
};
constexpr std::array<Face, 6> kFaces{{{0, 1}, {0, -1}, {1, 1}, {1, -1}, {2, 1}, {2, -1}}};

/// The direction at the angles (a, b) of a face.
Eigen::Vector3d direction_at(int face, double a, double b) {
  const Face& f = kFaces[static_cast<std::size_t>(face)];
  Eigen::Vector3d direction;
  direction[f.normal] = f.sign;
  direction[(f.normal + 1) % 3] = std::tan(a);
  direction[(f.normal + 2) % 3] = std::tan(b);
  return direction.normalized();
}

/// The solid angle per da db.
double solid_angle(double a, double b) {
  const double x = std::tan(a);
  const double y = std::tan(b);
  return (1.0 + x * x) * (1.0 + y * y) * std::pow(1.0 + x * x + y * y, -1.5);
}

double larger_error(const RayIntegral& x, const RayIntegral& y) { return x.error < y.error; }

}  // namespace

void SphereCubature::add_sphere(std::size_t sphere, std::span<const SphereFeature> features) {
  if (axisymmetric_) {
    add_cell({sphere, -1, -1.0, 0.0, 0.0, 1.0, {}}, features, 0);
    add_cell({sphere, -1, 0.0, 1.0, 0.0, 1.0, {}}, features, 0);
    return;
  }
  for (int face = 0; face < 6; ++face) {
    add_cell({sphere, face, -kQuarter, kQuarter, -kQuarter, kQuarter, {}}, features, 0);
  }
}

bool SphereCubature::is_coarse(const Cell& cell, const SphereFeature& feature) const {
  const Eigen::Vector3d& u = feature.direction;
  if (axisymmetric_) {
    const double low = std::acos(cell.a_high);
    const double high = std::acos(cell.a_low);
    const double polar = std::acos(std::clamp(u.z(), -1.0, 1.0));
    return high - low > feature.angle && polar >= low - feature.angle &&
           polar <= high + feature.angle;
  }
  const Face& f = kFaces[static_cast<std::size_t>(cell.face)];
  const double depth = f.sign * u[f.normal];
  if (depth <= 0.0) return false;
  const double a = std::atan(u[(f.normal + 1) % 3] / depth);
  const double b = std::atan(u[(f.normal + 2) % 3] / depth);
  const bool inside = a >= cell.a_low - feature.angle && a <= cell.a_high + feature.angle &&
                      b >= cell.b_low - feature.angle && b <= cell.b_high + feature.angle;
  return inside && cell.a_high - cell.a_low > feature.angle;
}

void SphereCubature::add_cell(Cell cell, std::span<const SphereFeature> features, int depth) {
  const bool split = depth < kMaxSeedDepth && std::ranges::any_of(features, [&](const auto& f) {
                       return is_coarse(cell, f);
                     });
  if (!split) {
    evaluate(cell);
    keep(cell);
    return;
  }
  for (const Cell& half : halves(cell, true)) {
    if (axisymmetric_) {
      add_cell(half, features, depth + 1);
    } else {
      for (const Cell& quarter : halves(half, false)) add_cell(quarter, features, depth + 1);
    }
  }
}

void SphereCubature::keep(const Cell& cell) {
  total_.add(cell.integral, 1.0);
  cells_.push_back(cell);
  std::ranges::push_heap(cells_, larger_error, &Cell::integral);
}

std::vector<SphereCubature::Cell> SphereCubature::halves(const Cell& cell, bool along_a) const {
  std::vector<Cell> parts{cell, cell};
  if (along_a) {
    parts[0].a_high = parts[1].a_low = 0.5 * (cell.a_low + cell.a_high);
  } else {
    parts[0].b_high = parts[1].b_low = 0.5 * (cell.b_low + cell.b_high);
  }
  return parts;
}

void SphereCubature::refine() {
  std::ranges::pop_heap(cells_, larger_error, &Cell::integral);
  const Cell worst = cells_.back();
  cells_.pop_back();
  const std::size_t evaluations = total_.evaluations;
  total_.add(worst.integral, -1.0);
  total_.evaluations = evaluations;
  std::vector<Cell> parts = halves(worst, worst.a_roughness >= worst.b_roughness);
  double surprise = worst.integral.value;
  double error = 0.0;
  for (Cell& part : parts) {
    evaluate(part);
    surprise -= part.integral.value;
    error += part.integral.error;
  }
  // If the halves disagree with the whole by more than their errors, their errors are raised
  // (Cuhre, \cite berntsen1991adaptive and its implementation in Cuba).
  surprise = 0.5 * std::abs(surprise);
  for (Cell& part : parts) {
    if (error > 0.0) part.integral.error *= 1.0 + 2.0 * surprise / error;
    part.integral.error += surprise;
    keep(part);
  }
}

void SphereCubature::evaluate(Cell& cell) const {
  if (axisymmetric_) {
    evaluate_band(cell);
  } else {
    evaluate_patch(cell);
  }
}

void SphereCubature::evaluate_band(Cell& cell) const {
  const KronrodRule& rule = KronrodRule::instance();
  const double centre = 0.5 * (cell.a_low + cell.a_high);
  const double half = 0.5 * (cell.a_high - cell.a_low);
  RayIntegral sum;
  double difference = 0.0;
  for (const auto& node : rule.nodes) {
    const double cosine = centre + half * node.at;
    const double sine = std::sqrt((1.0 - cosine) * (1.0 + cosine));
    const RayIntegral ray = function_(cell.sphere, {sine, 0.0, cosine});
    sum.add(ray, 2.0 * std::numbers::pi * half * node.weight);
    difference += 2.0 * std::numbers::pi * half * node.difference * ray.value;
  }
  sum.error += std::abs(difference);
  cell.integral = sum;
  cell.a_roughness = 1.0;
}

void SphereCubature::evaluate_patch(Cell& cell) const {
  const double a_centre = 0.5 * (cell.a_low + cell.a_high);
  const double b_centre = 0.5 * (cell.b_low + cell.b_high);
  const double a_half = 0.5 * (cell.a_high - cell.a_low);
  const double b_half = 0.5 * (cell.b_high - cell.b_low);
  RayIntegral sum;
  const auto apply = [&](const auto& rule, auto&& visit) {
    for (std::size_t i = 0; i < rule.size(); ++i) {
      for (std::size_t j = 0; j < rule.size(); ++j) {
        const double a = a_centre + a_half * rule[i].at;
        const double b = b_centre + b_half * rule[j].at;
        const double weight = a_half * b_half * rule[i].weight * rule[j].weight * solid_angle(a, b);
        const RayIntegral ray = function_(cell.sphere, direction_at(cell.face, a, b));
        visit(ray, weight, i, j);
      }
    }
  };
  const PatchRules& rules = PatchRules::instance();
  std::array<double, PatchRules::kFine> a_modes{};
  std::array<double, PatchRules::kFine> b_modes{};
  apply(rules.fine, [&](const RayIntegral& ray, double weight, std::size_t i, std::size_t j) {
    sum.add(ray, weight);
    a_modes[j] += weight * ray.value * rules.top_mode[i];
    b_modes[i] += weight * ray.value * rules.top_mode[j];
  });
  double coarse = 0.0;
  apply(rules.coarse, [&](const RayIntegral& ray, double weight, std::size_t, std::size_t) {
    coarse += weight * ray.value;
    sum.evaluations += ray.evaluations;
  });
  sum.error += kSafety * std::abs(sum.value - coarse);
  cell.integral = sum;
  cell.a_roughness = cell.b_roughness = 0.0;
  for (const double mode : a_modes) cell.a_roughness += std::abs(mode);
  for (const double mode : b_modes) cell.b_roughness += std::abs(mode);
}

}  // namespace posemix::internal
