// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/density/pose_stack.hpp"

#include <algorithm>
#include <vector>

#include "posemix/density/operations.hpp"
#include "posemix/lie/pose_blocks.hpp"

namespace posemix {
namespace {

void check_indices(std::span<const std::size_t> indices, std::size_t size) {
  for (auto it = indices.begin(); it != indices.end(); ++it) {
    if (*it >= size) {
      throw InvalidInput(
          fmt::format("pose index {} is out of range, the joint density has {} poses", *it, size));
    }
    if (std::find(indices.begin(), it, *it) != it) {
      throw InvalidInput(fmt::format("pose index {} occurs twice", *it));
    }
  }
}

/// The covariance blocks with the rows of `rows` and the columns of `columns`.
Eigen::MatrixXd blocks(const Eigen::MatrixXd& covariance, std::span<const std::size_t> rows,
                       std::span<const std::size_t> columns) {
  Eigen::MatrixXd result(offset(rows.size()), offset(columns.size()));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (std::size_t j = 0; j < columns.size(); ++j) {
      block(result, i, j) = block(covariance, rows[i], columns[j]);
    }
  }
  return result;
}

PoseStackd select(const PoseStackd& poses, std::span<const std::size_t> indices) {
  std::vector<SE3d> selected;
  selected.reserve(indices.size());
  for (const std::size_t index : indices) selected.push_back(poses[index]);
  return PoseStackd(std::move(selected));
}

std::vector<std::size_t> complement(std::span<const std::size_t> indices, std::size_t size) {
  std::vector<std::size_t> rest;
  for (std::size_t index = 0; index < size; ++index) {
    if (std::find(indices.begin(), indices.end(), index) == indices.end()) rest.push_back(index);
  }
  return rest;
}

}  // namespace

ConcentratedGaussian<PoseStackd> marginal(const ConcentratedGaussian<PoseStackd>& joint,
                                          std::span<const std::size_t> indices) {
  check_indices(indices, joint.mean().size());
  return ConcentratedGaussian<PoseStackd>::trusted(select(joint.mean(), indices),
                                                   blocks(joint.covariance(), indices, indices));
}

ConcentratedGaussian<SE3d> marginal(const ConcentratedGaussian<PoseStackd>& joint,
                                    std::size_t index) {
  check_indices(std::span(&index, 1), joint.mean().size());
  return ConcentratedGaussian<SE3d>::trusted(joint.mean()[index],
                                             block(joint.covariance(), index, index));
}

ConcentratedGaussian<PoseStackd> conditional(const ConcentratedGaussian<PoseStackd>& joint,
                                             std::span<const std::size_t> indices,
                                             std::span<const SE3d> values) {
  const PoseStackd& mean = joint.mean();
  check_indices(indices, mean.size());
  if (values.size() != indices.size()) {
    throw InvalidInput(fmt::format("{} values for {} pose indices", values.size(), indices.size()));
  }
  const std::vector<std::size_t> rest = complement(indices, mean.size());
  require(!rest.empty(), "conditional: every pose is given, none is left");

  Eigen::VectorXd deviation(offset(indices.size()));
  for (std::size_t i = 0; i < indices.size(); ++i) {
    segment(deviation, i) = (values[i] * mean[indices[i]].inverse()).log();
  }
  const Eigen::MatrixXd cross = blocks(joint.covariance(), rest, indices);
  const Eigen::LLT<Eigen::MatrixXd> given(blocks(joint.covariance(), indices, indices));
  const Eigen::MatrixXd gain = given.solve(cross.transpose()).transpose();
  Eigen::MatrixXd covariance = blocks(joint.covariance(), rest, rest) - gain * cross.transpose();
  symmetrize(covariance);
  return back_project(
      TangentGaussian<PoseStackd>{select(mean, rest), gain * deviation, covariance});
}

ConcentratedGaussian<SE3d> relative_pose(const ConcentratedGaussian<PoseStackd>& joint,
                                         std::size_t from, std::size_t to) {
  const std::size_t pair[] = {from, to};
  check_indices(pair, joint.mean().size());
  const Eigen::MatrixXd& p = joint.covariance();
  const Matrix6d difference =
      block(p, from, from) - block(p, from, to) - block(p, to, from) + block(p, to, to);
  const SE3d from_inverse = joint.mean()[from].inverse();
  Matrix6d covariance = from_inverse.adjoint_congruence(difference);
  symmetrize(covariance);
  return ConcentratedGaussian<SE3d>::trusted(from_inverse * joint.mean()[to], covariance);
}

}  // namespace posemix
