// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors

// Sophus: Exp, Log and the product of its poses, whose tangent vectors have the translation first.
#include <vector>

#include <Eigen/Dense>
#include <se3.hpp>

#include "jobs.hpp"

namespace {

using Pose = Sophus::SE3<double>;
using Rotation = Sophus::SO3<double>;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

template <class Element>
std::vector<double> matrices(const std::vector<Element>& elements) {
  std::vector<double> numbers;
  for (const Element& element : elements) {
    const RowMajor m = element.matrix();
    numbers.insert(numbers.end(), m.data(), m.data() + m.size());
  }
  return numbers;
}

void all(bench::Jobs& jobs) {
  const auto numbers = jobs.input("tangents");
  const auto given = jobs.input("poses");
  const std::size_t count = numbers.size() / 6;
  std::vector<Pose::Tangent> xi(count);
  std::vector<Pose> poses;
  for (std::size_t i = 0; i < count; ++i) {
    xi[i] << Eigen::Vector3d(&numbers[6 * i + 3]), Eigen::Vector3d(&numbers[6 * i]);
    const Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>> m(&given[16 * i]);
    const Eigen::Matrix3d r = m.topLeftCorner<3, 3>();
    poses.emplace_back(Eigen::Quaterniond(r).normalized(), m.topRightCorner<3, 1>());
  }
  std::vector<Rotation> turned(count);
  std::vector<Eigen::Vector3d> turns(count);
  std::vector<Pose> moved(count);
  std::vector<Pose::Tangent> logs(count);
  const auto as_matrices = [](const auto& found) { return matrices(found); };
  bench::run_each(
      jobs, "so3_exp", turned, [&](std::size_t i) { return Rotation::exp(xi[i].tail<3>()); },
      as_matrices);
  bench::run_each(
      jobs, "so3_log", turns, [&](std::size_t i) { return poses[i].so3().log(); },
      [](const auto& found) {
        std::vector<double> result;
        for (const auto& turn : found) result.insert(result.end(), turn.begin(), turn.end());
        return result;
      });
  bench::run_each(
      jobs, "se3_exp", moved, [&](std::size_t i) { return Pose::exp(xi[i]); }, as_matrices);
  bench::run_each(
      jobs, "se3_log", logs, [&](std::size_t i) { return poses[i].log(); },
      [](const auto& found) {
        std::vector<double> result;
        for (const auto& log : found) {
          for (int k = 0; k < 6; ++k) result.push_back(log[(k + 3) % 6]);
        }
        return result;
      });
  bench::run_each(
      jobs, "se3_compose", moved, [&](std::size_t i) { return poses[i] * poses[count - 1 - i]; },
      as_matrices);
}

}  // namespace

int main(int count, char** arguments) { return bench::jobs_main(count, arguments, all); }
