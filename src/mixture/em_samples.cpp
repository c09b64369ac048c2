// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/mixture/em_samples.hpp"

#include <array>
#include <cmath>

/// Plain loops over coordinates that compilers turn into vector instructions. Every lane does what
/// one sample alone would do, without contraction, so that all variants give the same bits.
#if defined(__GNUC__) && defined(__x86_64__) && defined(__linux__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define POSEMIX_VECTOR_VARIANTS __attribute__((target_clones("default", "avx2")))
#else
#define POSEMIX_VECTOR_VARIANTS
#endif

namespace posemix {
namespace {

/// Terms of atan(z) = z - z^3/3 + z^5/5 - ... that matter for z <= tan(pi / 8).
constexpr int kArctangentTerms = 21;

/// Below this squared angle the coefficients of the Jacobian are taken from their series.
constexpr double kSeriesBelow = 1e-2;

/// t = 2 a, n = sin a = |v|, w = cos a >= 0: tan(a/2) = n / (1 + w), and once more halved.
inline double half_angle_over_sine(double n, double w) {
  const double half_tangent = n / (1.0 + w);
  const double divisor = 1.0 + std::sqrt(1.0 + half_tangent * half_tangent);
  const double quarter_tangent = half_tangent / divisor;
  const double z = -quarter_tangent * quarter_tangent;
  double sum = 1.0 / (2 * kArctangentTerms - 1);
#pragma GCC unroll 32
  for (int k = kArctangentTerms - 2; k >= 0; --k) sum = sum * z + 1.0 / (2 * k + 1);
  return 4.0 * sum / (divisor * (1.0 + w));
}

inline double rest_series(double u) {
  return 1.0 / 12.0 +
         u * (1.0 / 720.0 + u * (1.0 / 30240.0 + u * (1.0 / 1209600.0 + u / 47900160.0)));
}

inline double slope_series(double u) {
  return 1.0 / 720.0 + u * (2.0 / 30240.0 + u * (3.0 / 1209600.0 + u * (4.0 / 47900160.0)));
}

/// Rows of the result of log_of_products, one value per sample in each.
enum LogRow { kXi = 0, kSinc = 6, kRest = 7, kSlope = 8, kLogRows = 9 };

/// Log of sample * m for `count` samples whose coordinate j lies at sample + j * stride; row j of
/// the result begins at out + j * kEmBlock, a constant so that rows are seen not to overlap.
/// In one piece, because a loop is turned into vector instructions as a whole or not at all.
// NOLINTNEXTLINE(readability-function-size)
POSEMIX_VECTOR_VARIANTS void log_of_products(const double* __restrict sample, Eigen::Index stride,
                                             const double* m, Eigen::Index count,
                                             double* __restrict out) {
  constexpr Eigen::Index kStride = kEmBlock;
  const double mx = m[0], my = m[1], mz = m[2], mw = m[3], cx = m[4], cy = m[5], cz = m[6];
  for (Eigen::Index i = 0; i < count; ++i) {
    const double qx = sample[i];
    const double qy = sample[stride + i];
    const double qz = sample[2 * stride + i];
    const double qw = sample[3 * stride + i];
    const double product = qw * mw - qx * mx - qy * my - qz * mz;
    const double sign = product < 0.0 ? -1.0 : 1.0;
    const double w = sign * product;
    const double vx = sign * (qw * mx + qx * mw + qy * mz - qz * my);
    const double vy = sign * (qw * my - qx * mz + qy * mw + qz * mx);
    const double vz = sign * (qw * mz + qx * my - qy * mx + qz * mw);
    const double n2 = vx * vx + vy * vy + vz * vz;
    const double ratio = half_angle_over_sine(std::sqrt(n2), w);
    const double px = 2.0 * ratio * vx;
    const double py = 2.0 * ratio * vy;
    const double pz = 2.0 * ratio * vz;
    const double u = 4.0 * ratio * ratio * n2;
    const double half_cot = ratio * w;
    const double divisor = 1.0 / (u + 1e-300);
    const double rest_closed = (1.0 - half_cot) * divisor;
    const double slope_closed = 0.5 * (ratio * ratio + half_cot - 2.0) * divisor * divisor;
    const double rest_small = rest_series(u);
    const double slope_small = slope_series(u);
    const double rest = u < kSeriesBelow ? rest_small : rest_closed;
    // The centre's inverse translation, rotated by the sample, plus the sample's translation.
    const double ax = 2.0 * (qy * cz - qz * cy);
    const double ay = 2.0 * (qz * cx - qx * cz);
    const double az = 2.0 * (qx * cy - qy * cx);
    const double sx = sample[4 * stride + i] + cx + qw * ax + qy * az - qz * ay;
    const double sy = sample[5 * stride + i] + cy + qw * ay + qz * ax - qx * az;
    const double sz = sample[6 * stride + i] + cz + qw * az + qx * ay - qy * ax;
    const double bx = py * sz - pz * sy;
    const double by = pz * sx - px * sz;
    const double bz = px * sy - py * sx;
    out[i] = px;
    out[kStride + i] = py;
    out[2 * kStride + i] = pz;
    out[3 * kStride + i] = sx - 0.5 * bx + rest * (py * bz - pz * by);
    out[4 * kStride + i] = sy - 0.5 * by + rest * (pz * bx - px * bz);
    out[5 * kStride + i] = sz - 0.5 * bz + rest * (px * by - py * bx);
    out[kSinc * kStride + i] = 1.0 / ratio;
    out[kRest * kStride + i] = rest;
    out[kSlope * kStride + i] = u < kSeriesBelow ? slope_small : slope_closed;
  }
}

}  // namespace

EmSamples<SE3d>::EmSamples(std::span<const SE3d> elements)
    : coordinates_(static_cast<Eigen::Index>(elements.size()), 7) {
  for (std::size_t i = 0; i < elements.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    coordinates_.row(row).head<4>() = elements[i].rotation().quaternion().coeffs();
    coordinates_.row(row).tail<3>() = elements[i].translation();
  }
}

void EmSamples<SE3d>::log(std::size_t begin, std::size_t count, const SE3d& inverse_centre,
                          Block& block) const {
  const auto columns = static_cast<Eigen::Index>(count);
  block.values.resize(kLogRows, kEmBlock);
  block.count = columns;
  Eigen::Matrix<double, 7, 1> centre;
  centre << inverse_centre.rotation().quaternion().coeffs(), inverse_centre.translation();
  log_of_products(coordinates_.data() + static_cast<Eigen::Index>(begin), coordinates_.rows(),
                  centre.data(), columns, block.values.data());
  block.log_volume = 4.0 * block.values.row(kSinc).head(columns).array().log().transpose();
}

/// J_r^-1 = [a 0; b a] with a = I + phi^ / 2 + rest phi^ phi^ and b the derivative of a along rho.
void EmSamples<SE3d>::add_gradient(const Block& block, const TangentRows<SE3d>& y,
                                   const Eigen::ArrayXd& shares, SE3d::Tangent& gradient) {
  using Row = Eigen::Array<double, 1, Eigen::Dynamic, Eigen::RowMajor, 1, kEmBlock>;
  using Rows = std::array<Row, 3>;
  const auto rows = [](const auto& matrix, Eigen::Index first) {
    return Rows{matrix.row(first), matrix.row(first + 1), matrix.row(first + 2)};
  };
  const auto cross = [](const Rows& a, const Rows& b) {
    return Rows{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  };
  const Rows phi = rows(block.xi(), 0);
  const Rows rho = rows(block.xi(), 3);
  const Rows y_1 = rows(y, 0);
  const Rows y_2 = rows(y, 3);
  const Rows phi_1 = cross(phi, y_1);
  const Rows phi_2 = cross(phi, y_2);
  const Rows rho_2 = cross(rho, y_2);
  const Rows phi_phi_1 = cross(phi, phi_1);
  const Rows phi_phi_2 = cross(phi, phi_2);
  const Rows phi_rho_2 = cross(phi, rho_2);
  const Rows rho_phi_2 = cross(rho, phi_2);
  const Row share = shares.transpose();
  const Row rest = share * block.values.row(kRest).head(block.count).array();
  const Row slope = 2.0 * share * block.values.row(kSlope).head(block.count).array() *
                    (phi[0] * rho[0] + phi[1] * rho[1] + phi[2] * rho[2]);
  for (std::size_t i = 0; i < 3; ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    gradient[at] +=
        (share * (y_1[i] - 0.5 * (phi_1[i] + rho_2[i])) +
         rest * (phi_phi_1[i] + phi_rho_2[i] + rho_phi_2[i] - 4.0 * phi[i]) + slope * phi_phi_2[i])
            .sum();
    gradient[at + 3] += (share * (y_2[i] - 0.5 * phi_2[i]) + rest * phi_phi_2[i]).sum();
  }
}

}  // namespace posemix
