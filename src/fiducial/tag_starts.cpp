// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "tag_starts.hpp"

#include <cmath>

#include <Eigen/Geometry>
#include <Eigen/SVD>

#include "posemix/fiducial/tag_pose.hpp"

namespace posemix::internal {

std::array<SE3d, 2> tag_starts(const std::array<Eigen::Vector2d, 4>& image, double size) {
  // From afar the image of (x, y, 0) is c + A (x, y), with the upper left block of R scaled in A.
  const std::array<Eigen::Vector3d, 4> points = tag_points(size);
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  Eigen::Matrix2d a = Eigen::Matrix2d::Zero();
  for (std::size_t i = 0; i < image.size(); ++i) {
    centre += image[i] / 4.0;
    a += image[i] * points[i].head<2>().transpose() / (size * size);
  }
  const Eigen::JacobiSVD<Eigen::Matrix2d> svd(a, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double scale = svd.singularValues()[0];
  const double cosine = svd.singularValues()[1] / scale;
  // Lengths along the first axis are not foreshortened; along the second, depth makes up for it.
  const Eigen::RowVector2d depth =
      std::sqrt(1.0 - cosine * cosine) * svd.matrixV().col(1).transpose();
  std::array<SE3d, 2> starts;
  for (std::size_t k = 0; k < starts.size(); ++k) {
    Eigen::Matrix3d r;
    r.topLeftCorner<2, 2>() = a / scale;
    r.bottomLeftCorner<1, 2>() = k == 0 ? depth : Eigen::RowVector2d(-depth);
    r.col(2) = r.col(0).cross(r.col(1));
    starts[k] = SE3d(SO3d::from_matrix(r), centre.homogeneous() / scale);
  }
  return starts;
}

}  // namespace posemix::internal
