// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cmath>

#include "posemix/base/error.hpp"
#include "posemix/density/projected_operations.hpp"
#include "split_gaussian.hpp"

namespace posemix {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Mean and covariance of the first three of six Gaussian coordinates given the last three, or of
/// the last three given the first.
TranslationMoments given(const Vector6d& mean, const Matrix6d& covariance, Eigen::Index wanted,
                         const Vector3d& value) {
  const Eigen::Index known = 3 - wanted;
  const Matrix3d cross = covariance.block<3, 3>(wanted, known);
  const Eigen::LLT<Matrix3d> factor(Matrix3d(covariance.block<3, 3>(known, known)));
  const Matrix3d gain = factor.solve(cross.transpose()).transpose();
  Matrix3d left = covariance.block<3, 3>(wanted, wanted) - gain * cross.transpose();
  symmetrize(left);
  return {mean.segment<3>(wanted) + gain * (value - mean.segment<3>(known)), left};
}

}  // namespace

ProjectedGaussian<SO3d> rotation_marginal(const ProjectedGaussian<SE3d>& density) {
  return ProjectedGaussian<SO3d>::trusted(density.tangent_point(), density.tangent_mean().head<3>(),
                                          density.covariance().topLeftCorner<3, 3>());
}

TranslationMoments translation_marginal(const ProjectedGaussian<SE3d>& density) {
  const DistributionMoments<SE3d> distribution = moments_of(density);
  return {distribution.mean.tail<3>(), distribution.covariance.bottomRightCorner<3, 3>()};
}

ProjectedGaussian<SO3d> rotation_given_translation(const ProjectedGaussian<SE3d>& density,
                                                   const Vector3d& translation) {
  const TranslationMoments u = given(density.tangent_mean(), density.covariance(), 0, translation);
  return ProjectedGaussian<SO3d>::trusted(density.tangent_point(), u.mean, u.covariance);
}

TranslationMoments translation_given_rotation(const ProjectedGaussian<SE3d>& density,
                                              const SO3d& rotation) {
  const Vector3d u = gnomonic::lift(density.tangent_point(), rotation);
  require(u.allFinite(),
          "translation_given_rotation: the rotation lies by pi from the tangent point");
  return given(density.tangent_mean(), density.covariance(), 3, u);
}

template <RotationOrPose G>
std::vector<SplitPiece<G>> split(const ProjectedGaussian<G>& density, double max_spread) {
  std::vector<SplitPiece<G>> pieces;
  for (const auto& piece : internal::split_gaussian<Eigen::VectorXd, Eigen::MatrixXd>(
           density.tangent_mean(), density.covariance(), max_spread)) {
    const auto in_chart =
        ProjectedGaussian<G>::trusted(density.tangent_point(), typename G::Tangent(piece.mean),
                                      typename G::TangentMatrix(piece.covariance));
    // The density N / C is the sum of the parts' N_i / C_i with the weights w_i C_i / C.
    const double weight =
        piece.weight * std::exp(in_chart.log_normalizer() - density.log_normalizer());
    pieces.push_back({weight, change_chart_to_mode(in_chart)});
  }
  double total = 0.0;
  for (const auto& piece : pieces) total += piece.weight;
  for (auto& piece : pieces) piece.weight /= total;
  return pieces;
}

template std::vector<SplitPiece<SO3d>> split(const ProjectedGaussian<SO3d>&, double);
template std::vector<SplitPiece<SE3d>> split(const ProjectedGaussian<SE3d>&, double);

}  // namespace posemix
