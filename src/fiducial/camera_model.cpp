// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/fiducial/camera_model.hpp"

#include <array>
#include <cmath>

#include <fmt/format.h>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include "posemix/base/error.hpp"

namespace posemix {
namespace {

constexpr int kUndistortSteps = 50;
constexpr double kUndistorted = 1e-12;  ///< of a normalised coordinate or an angle [rad]
/// Below, sin(theta) is theta to rounding.
constexpr double kSmallSine = 1e-9;

/// Distorted normalised coordinates and their derivative with respect to undistorted ones.
struct Distorted {
  Eigen::Vector2d point;
  Eigen::Matrix2d jacobian;
};

/// OpenCV's model of k1 k2 p1 p2 k3 at x/z, y/z.
Distorted distort_radtan(const std::vector<double>& k, const Eigen::Vector2d& p) {
  const double k3 = k.size() > 4 ? k[4] : 0.0;
  const double x = p.x();
  const double y = p.y();
  const double r2 = p.squaredNorm();
  const double radial = 1.0 + r2 * (k[0] + r2 * (k[1] + r2 * k3));
  const double slope = k[0] + r2 * (2.0 * k[1] + 3.0 * k3 * r2);  // d radial / d r2
  Distorted out;
  out.point = {x * radial + 2.0 * k[2] * x * y + k[3] * (r2 + 2.0 * x * x),
               y * radial + k[2] * (r2 + 2.0 * y * y) + 2.0 * k[3] * x * y};
  const double mixed = 2.0 * x * y * slope + 2.0 * (k[2] * x + k[3] * y);
  out.jacobian << radial + 2.0 * x * x * slope + 2.0 * k[2] * y + 6.0 * k[3] * x, mixed,  //
      mixed, radial + 2.0 * y * y * slope + 6.0 * k[2] * y + 2.0 * k[3] * x;
  return out;
}

/// OpenCV's fisheye model: theta (1 + k1 theta^2 + ... + k4 theta^8) and its derivative.
std::array<double, 2> distort_angle(const std::vector<double>& k, double theta) {
  const double u = theta * theta;
  return {theta * (1.0 + u * (k[0] + u * (k[1] + u * (k[2] + u * k[3])))),
          1.0 + u * (3.0 * k[0] + u * (5.0 * k[1] + u * (7.0 * k[2] + u * 9.0 * k[3])))};
}

std::optional<Projection> project_equidistant(const std::vector<double>& k,
                                              const Eigen::Vector3d& p) {
  const double r = p.head<2>().norm();
  const double norm2 = p.squaredNorm();
  if (!(norm2 > 0.0)) return std::nullopt;
  Projection out;
  if (r < kSmallSine * p.z()) {
    out.pixel = p.head<2>() / p.z();
    out.jacobian << 1.0 / p.z(), 0.0, -out.pixel.x() / p.z(), 0.0, 1.0 / p.z(),
        -out.pixel.y() / p.z();
    return out;
  }
  if (!(r > 0.0)) return std::nullopt;  // straight behind
  const auto [d, slope] = distort_angle(k, std::atan2(r, p.z()));
  const Eigen::Vector2d u = p.head<2>() / r;
  // d theta / d r = z / |p|^2, d theta / d z = -r / |p|^2
  out.pixel = d * u;
  const Eigen::Matrix2d across = (Eigen::Matrix2d::Identity() - u * u.transpose()) * (d / r);
  out.jacobian.leftCols<2>() = across + u * u.transpose() * (slope * p.z() / norm2);
  out.jacobian.col(2) = u * (-slope * r / norm2);
  return out;
}

std::optional<Projection> project_pinhole(const CameraModel& camera, const Eigen::Vector3d& p) {
  if (!(p.z() > 0.0)) return std::nullopt;
  Projection out;
  out.pixel = p.head<2>() / p.z();
  out.jacobian << 1.0 / p.z(), 0.0, -out.pixel.x() / p.z(), 0.0, 1.0 / p.z(),
      -out.pixel.y() / p.z();
  if (camera.distortion == DistortionModel::radtan) {
    const Distorted bent = distort_radtan(camera.coefficients, out.pixel);
    out.pixel = bent.point;
    out.jacobian = bent.jacobian * out.jacobian;
  }
  return out;
}

std::optional<Eigen::Vector2d> undistort_radtan(const std::vector<double>& k,
                                                const Eigen::Vector2d& point) {
  Eigen::Vector2d p = point;
  for (int i = 0; i < kUndistortSteps; ++i) {
    const Distorted bent = distort_radtan(k, p);
    // Beyond the fold of the distortion lie other points with the same image.
    if (!(bent.jacobian.determinant() > 0.0)) return std::nullopt;
    const Eigen::Vector2d step = bent.jacobian.inverse() * (point - bent.point);
    p += step;
    if (step.norm() <= kUndistorted * (1.0 + p.norm())) return p;
  }
  return std::nullopt;
}

std::optional<double> undistort_angle(const std::vector<double>& k, double distorted) {
  double theta = distorted;
  for (int i = 0; i < kUndistortSteps; ++i) {
    const auto [d, slope] = distort_angle(k, theta);
    if (!(slope > 0.0)) return std::nullopt;
    const double step = (distorted - d) / slope;
    theta += step;
    if (std::abs(step) <= kUndistorted) {
      return theta >= 0.0 && theta < M_PI ? std::optional(theta) : std::nullopt;
    }
  }
  return std::nullopt;
}

void check_coefficients(const CameraModel& camera) {
  const std::size_t count = camera.coefficients.size();
  const bool fits = camera.distortion == DistortionModel::none     ? count == 0
                    : camera.distortion == DistortionModel::radtan ? count == 4 || count == 5
                                                                   : count == 4;
  if (!fits) {
    throw InvalidInput(
        fmt::format("got {} coefficients of the distortion, expected {} for {}", count,
                    camera.distortion == DistortionModel::none     ? "none"
                    : camera.distortion == DistortionModel::radtan ? "4 or 5 (k1 k2 p1 p2 k3)"
                                                                   : "4 (k1 k2 k3 k4)",
                    word_of(camera.distortion)));
  }
}

}  // namespace

void validate(const CameraModel& camera) {
  const Eigen::Vector4d& k = camera.intrinsics;
  if (!k.allFinite() || !(k[0] > 0.0 && k[1] > 0.0)) {
    throw InvalidInput(fmt::format(
        "the intrinsics are {} {} {} {}, expected fx, fy, cx, cy [px] with positive focal lengths",
        k[0], k[1], k[2], k[3]));
  }
  check_coefficients(camera);
  for (const double coefficient : camera.coefficients) {
    if (!std::isfinite(coefficient))
      throw InvalidInput("a coefficient of the distortion is not finite");
  }
}

std::optional<Projection> project(const CameraModel& camera, const Eigen::Vector3d& point) {
  check_coefficients(camera);
  std::optional<Projection> out = camera.distortion == DistortionModel::equidistant
                                      ? project_equidistant(camera.coefficients, point)
                                      : project_pinhole(camera, point);
  if (!out) return out;
  const auto focal = camera.intrinsics.head<2>().array();
  out->pixel = (focal * out->pixel.array()).matrix() + camera.intrinsics.tail<2>();
  out->jacobian.array().colwise() *= focal;
  return out;
}

std::optional<Eigen::Vector3d> ray(const CameraModel& camera, const Eigen::Vector2d& pixel) {
  check_coefficients(camera);
  const Eigen::Vector2d point =
      ((pixel - camera.intrinsics.tail<2>()).array() / camera.intrinsics.head<2>().array())
          .matrix();
  if (camera.distortion == DistortionModel::equidistant) {
    const double distorted = point.norm();
    const std::optional<double> theta = undistort_angle(camera.coefficients, distorted);
    if (!theta) return std::nullopt;
    const double sinc = distorted > kSmallSine ? std::sin(*theta) / distorted : 1.0;
    return Eigen::Vector3d(point.x() * sinc, point.y() * sinc, std::cos(*theta)).normalized();
  }
  const std::optional<Eigen::Vector2d> straight = camera.distortion == DistortionModel::radtan
                                                      ? undistort_radtan(camera.coefficients, point)
                                                      : std::optional(point);
  if (!straight) return std::nullopt;
  return straight->homogeneous().normalized();
}

double angle_of_pixels(const CameraModel& camera, double pixels) {
  return pixels / std::sqrt(camera.intrinsics[0] * camera.intrinsics[1]);
}

}  // namespace posemix
