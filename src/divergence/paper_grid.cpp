// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/divergence/paper_grid.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "posemix/base/range.hpp"
#include "rotation_ray.hpp"

namespace posemix {
namespace {

using Eigen::Vector3d;

/// The log of a density that is too small to change the digits of a sum.
constexpr double kNegligible = -100.0;

/// Of a grid whose points can still be visited.
constexpr double kSmallestStep = 1e-3;

/// One peak relative to the first mean of p.
struct GridPeak {
  Vector3d step;  ///< Delta x = ln(X_j X_1^-1)
  Eigen::Matrix3d whiten;
  double log_scale;
};

/// A point of the grid and the quantities there that all peaks share.
struct GridPoint {
  Vector3d xi = Vector3d::Zero();
  double half_cot = 0.0;
  double d = 0.0;
  double log_det = 0.0;  ///< log |J_l(xi)|
};

/// ln(exp(Delta x) exp(xi)) by eq. 28.
Vector3d combined(const GridPoint& point, const Vector3d& d) {
  const Vector3d& x = point.xi;
  const Vector3d jacobian_part = point.half_cot * d + (point.d * x.dot(d)) * x - 0.5 * x.cross(d);
  const Vector3d dx = d.cross(x);
  const Vector3d ddx = d.cross(dx);
  const Vector3d xdx = x.cross(dx);
  const Vector3d dxd = -ddx;
  const Vector3d dxdxd = d.cross(x.cross(dxd));
  const Vector3d xdxdx = x.cross(d.cross(xdx));
  return jacobian_part + x + ddx / 12.0 - x.cross(ddx) / 24.0 + (dxdxd + xdxdx) / 120.0;
}

/// Log of the sum of the peaks at the point with respect to dxi, eq. 26 and 27; minus infinity if
/// every peak is below exp(floor).
double log_density(const std::vector<GridPeak>& peaks, const GridPoint& point, double floor) {
  double largest = -std::numeric_limits<double>::infinity();
  double sum = 0.0;
  for (const GridPeak& peak : peaks) {
    const Vector3d xi = combined(point, peak.step);
    const double bound = peak.log_scale - 0.5 * (peak.whiten * xi).squaredNorm();
    if (bound < floor) continue;
    const double exponent = bound - SO3d::log_abs_det_left_jacobian(xi);
    if (exponent > largest) {
      sum = sum * std::exp(largest - exponent) + 1.0;
      largest = exponent;
    } else {
      sum += std::exp(exponent - largest);
    }
  }
  return sum == 0.0 ? largest : largest + std::log(sum) + point.log_det;
}

std::vector<GridPeak> grid_peaks(const RotationDensity& density, const Eigen::Quaterniond& first) {
  std::vector<GridPeak> peaks;
  for (const internal::RotationPeak& peak : internal::rotation_peaks(density)) {
    const SO3d step = SO3d::from_quaternion(peak.mean * first.conjugate());
    peaks.push_back({step.log(), peak.whiten, peak.log_scale});
  }
  return peaks;
}

/// The quantities that depend on |xi| alone, for |xi|^2 = n step^2.
std::vector<GridPoint> grid_shells(int reach, double step) {
  std::vector<GridPoint> shells(static_cast<std::size_t>(3 * reach * reach + 1));
  for (std::size_t n = 0; n < shells.size(); ++n) {
    const double length = step * std::sqrt(static_cast<double>(n));
    const auto c = small_angle::inverse_jacobian_coefficients(length * length);
    shells[n] = {Vector3d::Zero(), c.half_cot, c.d,
                 SO3d::log_abs_det_left_jacobian({length, 0.0, 0.0})};
  }
  return shells;
}

/// Adds one point to the three sums.
void add_point(const std::vector<GridPeak>& p, const std::vector<GridPeak>& q,
               const GridPoint& point, PaperGridDivergence& sum) {
  const double none = -std::numeric_limits<double>::infinity();
  const double log_p = log_density(p, point, kNegligible);
  const double log_q = log_density(q, point, log_p > none ? none : kNegligible);
  const double at_p = std::exp(log_p);
  const double gap = at_p - std::exp(log_q);
  sum.mass += at_p;
  if (at_p > 0.0) sum.kl += at_p * (log_p - log_q);
  if (gap != 0.0) sum.isd += gap * gap * std::exp(-point.log_det);
  ++sum.evaluations;
}

}  // namespace

PaperGridDivergence paper_grid_divergence(const RotationDensity& p, const RotationDensity& q,
                                          double step) {
  NumberRange{.lowest = kSmallestStep, .highest = std::numbers::pi}.check(step, "step");
  const Eigen::Quaterniond first = internal::rotation_peaks(p).front().mean;
  const auto p_peaks = grid_peaks(p, first);
  const auto q_peaks = grid_peaks(q, first);
  const int reach = static_cast<int>(std::floor(std::numbers::pi / step * (1.0 + 1e-12)));
  const std::vector<GridPoint> shells = grid_shells(reach, step);
  PaperGridDivergence sum{};
  for (int i = -reach; i <= reach; ++i) {
    for (int j = -reach; j <= reach; ++j) {
      for (int k = -reach; k <= reach; ++k) {
        const int squared_radius = i * i + j * j + k * k;
        GridPoint point = shells[static_cast<std::size_t>(squared_radius)];
        point.xi = step * Vector3d(i, j, k);
        add_point(p_peaks, q_peaks, point, sum);
      }
    }
  }
  const double volume = step * step * step;
  sum.mass *= volume;
  sum.kl *= volume;
  sum.isd *= volume;
  return sum;
}

}  // namespace posemix
