// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors

// MRPT: the product of two poses, and of two uncertain poses, whose covariances are those of x, y,
// z, yaw, pitch and roll. Its exponential on SE(3) leaves the translation as it is, another
// function than Exp: it is not compared.
#include <vector>

#include <mrpt/poses/CPose3DPDFGaussian.h>

#include "dense_lie.hpp"
#include "jobs.hpp"

namespace {

using mrpt::math::CMatrixDouble44;
using mrpt::math::CMatrixDouble66;
using mrpt::poses::CPose3D;
using mrpt::poses::CPose3DPDFGaussian;

template <class Matrix>
Matrix matrix_of(const double* numbers) {
  Matrix m;
  for (int i = 0; i < m.rows(); ++i) {
    for (int j = 0; j < m.cols(); ++j) m(i, j) = *numbers++;
  }
  return m;
}

template <class Matrix>
void append(std::vector<double>& numbers, const Matrix& m) {
  for (int i = 0; i < m.rows(); ++i) {
    for (int j = 0; j < m.cols(); ++j) numbers.push_back(m(i, j));
  }
}

std::vector<double> matrices(const std::vector<CPose3D>& poses) {
  std::vector<double> numbers;
  for (const CPose3D& pose : poses)
    append(numbers, pose.getHomogeneousMatrixVal<CMatrixDouble44>());
  return numbers;
}

void all(bench::Jobs& jobs) {
  const auto numbers = jobs.input("poses");
  const auto covariances = jobs.input("covariances_xyz_ypr");
  std::vector<CPose3D> poses;
  std::vector<CPose3DPDFGaussian> densities;
  for (std::size_t i = 0; i < numbers.size() / 16; ++i) {
    poses.emplace_back(matrix_of<CMatrixDouble44>(&numbers[16 * i]));
    densities.emplace_back(poses.back(), matrix_of<CMatrixDouble66>(&covariances[36 * i]));
  }
  std::vector<CPose3D> moved(poses.size());
  jobs.run(
      "se3_compose", poses.size(),
      [&] {
        for (std::size_t i = 0; i < poses.size(); ++i)
          moved[i].composeFrom(poses[i], poses[poses.size() - 1 - i]);
        bench::keep(moved);
      },
      [&] { return matrices(moved); });
  std::vector<CPose3DPDFGaussian> composed = densities;
  jobs.run(
      "compose_covariances", densities.size(),
      [&] {
        for (std::size_t i = 0; i < densities.size(); ++i) {
          composed[i] = densities[i];
          composed[i] += densities[densities.size() - 1 - i];
        }
        bench::keep(composed);
      },
      [&] {
        std::vector<double> result;
        for (const auto& density : composed) {
          const auto numbers = matrices({density.mean});
          const auto jacobian = dense::angles_to_tangent(dense::poses_of<double>(numbers)[0]);
          result.insert(result.end(), numbers.begin(), numbers.end());
          append(result,
                 dense::Matrix6<double>(jacobian * density.cov.asEigen() * jacobian.transpose()));
        }
        return result;
      });
}

}  // namespace

int main(int count, char** arguments) { return bench::jobs_main(count, arguments, all); }
