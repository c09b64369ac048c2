// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <Eigen/Eigenvalues>

#include "posemix/base/error.hpp"
#include "posemix/density/projected_operations.hpp"

namespace posemix {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Mean and covariance of the first three of six Gaussian coordinates given the last three, or the
/// other way round.
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

/// A standard normal density as three narrower ones: weights 1/6, 2/3, 1/6 at -a, 0, a keep mean,
/// variance and fourth moment when a^2 = 3 (1 - s^2), s their standard deviation.
constexpr double kNarrower = 0.7;
const double kAway = std::sqrt(3.0 * (1.0 - kNarrower * kNarrower));

struct TangentPiece {
  double weight;
  Eigen::VectorXd mean;
  Eigen::MatrixXd covariance;
};

/// The piece split along the direction a of u in which its standard deviation is `spread`.
std::array<TangentPiece, 3> split_along(const TangentPiece& piece, const Vector3d& a,
                                        double spread) {
  // Every coordinate moves with a^T u by regression.
  const Eigen::VectorXd along = piece.covariance.leftCols(3) * a / spread;
  const Eigen::MatrixXd narrower =
      piece.covariance - (1.0 - kNarrower * kNarrower) * along * along.transpose();
  return {TangentPiece{piece.weight / 6.0, piece.mean - kAway * along, narrower},
          TangentPiece{piece.weight / 1.5, piece.mean, narrower},
          TangentPiece{piece.weight / 6.0, piece.mean + kAway * along, narrower}};
}

constexpr std::size_t kMostPieces = 1000;

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
  require(max_spread > 0.0, "split: max_spread must be positive");
  std::vector<TangentPiece> open{{1.0, density.tangent_mean(), density.covariance()}};
  std::vector<SplitPiece<G>> pieces;
  while (!open.empty()) {
    if (open.size() + pieces.size() > kMostPieces) {
      throw InvalidInput(fmt::format("split: more than {} pieces for a max_spread of {}",
                                     kMostPieces, max_spread));
    }
    const TangentPiece piece = std::move(open.back());
    open.pop_back();
    const Eigen::SelfAdjointEigenSolver<Matrix3d> eigen(
        Matrix3d(piece.covariance.topLeftCorner<3, 3>()));
    const double spread = std::sqrt(eigen.eigenvalues()[2]);
    if (spread > max_spread) {
      for (auto& part : split_along(piece, eigen.eigenvectors().col(2), spread)) {
        open.push_back(std::move(part));
      }
      continue;
    }
    const auto in_chart =
        ProjectedGaussian<G>::trusted(density.tangent_point(), typename G::Tangent(piece.mean),
                                      typename G::TangentMatrix(piece.covariance));
    // N / C is the sum of w_i C_i / C times N_i / C_i.
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
