// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace posemix::internal {

/// An integral along one ray, or over a part of a sphere.
struct RayIntegral {
  double value = 0.0;
  double error = 0.0;
  double absolute = 0.0;  ///< integral of the absolute value
  std::size_t evaluations = 0;

  RayIntegral& add(const RayIntegral& other, double weight) {
    value += weight * other.value;
    error += weight * other.error;
    absolute += weight * other.absolute;
    evaluations += other.evaluations;
    return *this;
  }
};

/// A direction near which the function changes within the given angle [rad].
struct SphereFeature {
  Eigen::Vector3d direction;
  double angle;
};

/// Adaptive cubature of a sum of functions over the unit sphere, sphere by sphere: the six faces of
/// a cube in equiangular coordinates with tensor Gauss-Legendre rules, or, for functions of the
/// third coordinate only, Gauss-Kronrod in it. The cell with the largest error is split first.
class SphereCubature {
 public:
  using Function = std::function<RayIntegral(std::size_t sphere, const Eigen::Vector3d& direction)>;

  SphereCubature(Function function, bool axisymmetric)
      : function_(std::move(function)), axisymmetric_(axisymmetric) {}

  /// Adds the integral over one more sphere, with first cells that are small near the features.
  void add_sphere(std::size_t sphere, std::span<const SphereFeature> features);

  /// The sum of the integrals over all spheres, weighted by solid angle.
  const RayIntegral& total() const { return total_; }

  /// Splits the cell with the largest error.
  void refine();

 private:
  struct Cell {
    std::size_t sphere;
    int face;
    double a_low, a_high, b_low, b_high;
    RayIntegral integral;
    double a_roughness = 0.0;
    double b_roughness = 0.0;
  };

  bool is_coarse(const Cell& cell, const SphereFeature& feature) const;
  void add_cell(Cell cell, std::span<const SphereFeature> features, int depth);
  void keep(const Cell& cell);
  void evaluate(Cell& cell) const;
  void evaluate_band(Cell& cell) const;
  void evaluate_patch(Cell& cell) const;
  std::vector<Cell> halves(const Cell& cell, bool along_a) const;

  Function function_;
  bool axisymmetric_;
  std::vector<Cell> cells_;  ///< a heap, largest error first
  RayIntegral total_;
};

}  // namespace posemix::internal
