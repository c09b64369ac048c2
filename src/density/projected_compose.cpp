// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <optional>
#include <vector>

#include "posemix/base/error.hpp"
#include "posemix/base/gaussian_cubature.hpp"
#include "posemix/density/operations.hpp"
#include "posemix/density/projected_operations.hpp"
#include "posemix/lie/rotation_of.hpp"

namespace posemix {
namespace {

/// Weighted elements of a group.
template <RotationOrPose G>
struct WeightedElements {
  std::vector<G> elements;
  const Eigen::VectorXd* weights;
};

/// Maps points z of a standard Gaussian to elements: with the third-degree rule through the
/// Gaussian in the tangent space, otherwise through the Gaussian with the moments of the
/// distribution.
template <RotationOrPose G>
class PointMap {
 public:
  PointMap(const ProjectedGaussian<G>& density, CompositionRule rule)
      : density_(&density), mean_(density.tangent_mean()), factor_(density.covariance().llt()) {
    if (rule == CompositionRule::third_degree_cubature) return;
    const DistributionMoments<G> distribution = moments_of(density);
    mean_ = distribution.mean;
    factor_.compute(distribution.covariance);
  }

  template <class Z>
  G operator()(const Z& z) const {
    return density_->element(mean_ + typename G::Tangent(factor_.matrixL() * z));
  }

 private:
  const ProjectedGaussian<G>* density_;
  typename G::Tangent mean_;
  Eigen::LLT<typename G::TangentMatrix> factor_;
};

template <int N>
const GaussianCubature<N>& cubature(CompositionRule rule) {
  static const auto third = GaussianCubature<N>::third_degree();
  static const auto fifth = GaussianCubature<N>::fifth_degree();
  return rule == CompositionRule::third_degree_cubature ? third : fifth;
}

/// The values of f at the cubature points of one density.
template <RotationOrPose G, class F>
WeightedElements<G> evaluate(const ProjectedGaussian<G>& x, CompositionRule rule, const F& f) {
  const auto& points = cubature<G::Dof>(rule);
  const PointMap<G> map(x, rule);
  WeightedElements<G> values{{}, &points.weights};
  for (const auto& z : points.points.colwise()) values.elements.push_back(f(map(z)));
  return values;
}

/// The values of f at the cubature points of two independent densities.
template <RotationOrPose G, class F>
WeightedElements<G> evaluate(const ProjectedGaussian<G>& x, const ProjectedGaussian<G>& y,
                             CompositionRule rule, const F& f) {
  constexpr int n = G::Dof;
  const auto& points = cubature<2 * n>(rule);
  const PointMap<G> of_x(x, rule), of_y(y, rule);
  WeightedElements<G> values{{}, &points.weights};
  for (const auto& z : points.points.colwise()) {
    values.elements.push_back(f(of_x(z.template head<n>()), of_y(z.template tail<n>())));
  }
  return values;
}

template <RotationOrPose G>
struct ChartMoments {
  SO3d tangent_point;
  typename G::Tangent mean;
  typename G::TangentMatrix covariance;
};

/// Mean and covariance of y = [u; t] in the chart at a rotation.
template <RotationOrPose G>
ChartMoments<G> moments_in_chart(const WeightedElements<G>& values, const SO3d& tangent_point) {
  using Tangent = typename G::Tangent;
  const auto chart =
      ProjectedGaussian<G>::trusted(tangent_point, Tangent::Zero(), G::TangentMatrix::Identity());
  Eigen::Matrix<double, G::Dof, Eigen::Dynamic> y(G::Dof, values.weights->size());
  for (Eigen::Index i = 0; i < y.cols(); ++i) {
    y.col(i) = chart.coordinates(values.elements[static_cast<std::size_t>(i)]);
  }
  ChartMoments<G> moments{tangent_point, y * *values.weights, {}};
  y.colwise() -= moments.mean;
  moments.covariance = y * values.weights->asDiagonal() * y.transpose();
  symmetrize(moments.covariance);
  return moments;
}

/// The moments in the chart in which the mean of u is zero, by iteration from the chart at `start`.
template <RotationOrPose G>
ChartMoments<G> centred_moments(const WeightedElements<G>& values, const SO3d& start) {
  ChartMoments<G> moments = moments_in_chart(values, start);
  for (int iteration = 0; iteration < 50; ++iteration) {
    const Eigen::Vector3d u = moments.mean.template head<3>();
    if (!(u.norm() > 1e-13)) break;
    moments = moments_in_chart(values, gnomonic::project(moments.tangent_point, u));
  }
  return moments;
}

/// The density PG_0 with these moments; empty if negative cubature weights have made the covariance
/// indefinite.
template <RotationOrPose G>
std::optional<ProjectedGaussian<G>> density_of(const ChartMoments<G>& moments,
                                               CompositionRule rule) {
  const auto is_definite = [](const auto& covariance) {
    return covariance.allFinite() && covariance.llt().info() == Eigen::Success;
  };
  if (!is_definite(moments.covariance)) return std::nullopt;
  if (rule == CompositionRule::third_degree_cubature) {
    typename G::Tangent mean = moments.mean;
    mean.template head<3>().setZero();
    return ProjectedGaussian<G>::trusted(moments.tangent_point, mean, moments.covariance);
  }
  const auto density = with_moments<G>(moments.tangent_point, moments.mean, moments.covariance);
  return is_definite(density.covariance()) ? std::optional(density) : std::nullopt;
}

/// The density of a function by the given rule, or if that gives an indefinite covariance, by the
/// rule of degree three, whose weights are positive.
template <RotationOrPose G, class Evaluate>
ProjectedGaussian<G> by_cubature(const SO3d& start, CompositionRule rule,
                                 const Evaluate& evaluate_at) {
  for (const CompositionRule by : {rule, CompositionRule::third_degree_cubature}) {
    const auto density = density_of(centred_moments<G>(evaluate_at(by), start), by);
    if (density) return *density;
  }
  throw InvalidInput(
      "compose: the densities are too wide for one projected Gaussian of their composition, split "
      "them first");
}

/// Eq. 17 at the modes, with X = 2 and Y = 1: u3 = R1^T u2 + u1 and t3 = R2 t1 + t2, where R2 turns
/// by 2 u2.
ProjectedGaussian<SO3d> compose_by_jacobian(const ProjectedGaussian<SO3d>& x,
                                            const ProjectedGaussian<SO3d>& y) {
  const Eigen::Matrix3d r1 = y.tangent_point().matrix();
  Eigen::Matrix3d covariance = r1.transpose() * x.covariance() * r1 + y.covariance();
  symmetrize(covariance);
  return ProjectedGaussian<SO3d>::trusted(x.mean() * y.mean(), covariance);
}
ProjectedGaussian<SE3d> compose_by_jacobian(const ProjectedGaussian<SE3d>& x,
                                            const ProjectedGaussian<SE3d>& y) {
  const Eigen::Matrix3d r1 = y.tangent_point().matrix();
  const Eigen::Matrix3d r2 = x.tangent_point().matrix();
  Matrix6d j2 = Matrix6d::Identity(), j1 = Matrix6d::Identity();
  j2.topLeftCorner<3, 3>() = r1.transpose();
  j2.bottomLeftCorner<3, 3>() = -2.0 * r2 * SO3d::hat(y.mean().translation());
  j1.bottomRightCorner<3, 3>() = r2;
  Matrix6d covariance = j2 * x.covariance() * j2.transpose() + j1 * y.covariance() * j1.transpose();
  symmetrize(covariance);
  auto result = ProjectedGaussian<SE3d>::trusted(x.mean() * y.mean(), covariance);
  internal::require_no_overflow(result, "composition");
  return result;
}

/// The inverse of q0 (1, u) is q0^-1 (1, -R0 u), and t' = -R^-1 t, where R turns by 2 u.
ProjectedGaussian<SO3d> inverse_by_jacobian(const ProjectedGaussian<SO3d>& x) {
  const Eigen::Matrix3d r = x.tangent_point().matrix();
  Eigen::Matrix3d covariance = r * x.covariance() * r.transpose();
  symmetrize(covariance);
  return ProjectedGaussian<SO3d>::trusted(x.tangent_point().inverse(), -r * x.tangent_mean(),
                                          covariance);
}
ProjectedGaussian<SE3d> inverse_by_jacobian(const ProjectedGaussian<SE3d>& x) {
  const Eigen::Matrix3d r = x.tangent_point().matrix();
  const SE3d inverse = x.mean().inverse();
  Matrix6d j = Matrix6d::Zero();
  j.topLeftCorner<3, 3>() = -r;
  j.bottomLeftCorner<3, 3>() = -2.0 * SO3d::hat(-inverse.translation());
  j.bottomRightCorner<3, 3>() = -r.transpose();
  Matrix6d covariance = j * x.covariance() * j.transpose();
  symmetrize(covariance);
  auto result = ProjectedGaussian<SE3d>::trusted(inverse, covariance);
  internal::require_no_overflow(result, "inverse");
  return result;
}

/// u' = Rb^T u and t' = R tb + t, where R turns by 2 u.
ProjectedGaussian<SE3d> moved_by_jacobian(const ProjectedGaussian<SE3d>& x, const SE3d& b) {
  Matrix6d j = Matrix6d::Identity();
  j.topLeftCorner<3, 3>() = b.rotation().inverse().matrix();
  j.bottomLeftCorner<3, 3>() = -2.0 * x.tangent_point().matrix() * SO3d::hat(b.translation());
  Matrix6d covariance = j * x.covariance() * j.transpose();
  symmetrize(covariance);
  auto result = ProjectedGaussian<SE3d>::trusted(x.mean() * b, covariance);
  internal::require_no_overflow(result, "composition");
  return result;
}

}  // namespace

template <RotationOrPose G>
ProjectedGaussian<G> compose(const ProjectedGaussian<G>& x, const ProjectedGaussian<G>& y,
                             CompositionRule rule) {
  if (rule == CompositionRule::jacobian) {
    return compose_by_jacobian(change_chart_to_mode(x), change_chart_to_mode(y));
  }
  const auto product = [](const G& a, const G& b) { return a * b; };
  return by_cubature<G>(rotation_of(x.mean() * y.mean()), rule,
                        [&](CompositionRule by) { return evaluate(x, y, by, product); });
}

template <RotationOrPose G>
ProjectedGaussian<G> inverse(const ProjectedGaussian<G>& x, CompositionRule rule) {
  if constexpr (std::same_as<G, SO3d>) {
    return inverse_by_jacobian(x);
  } else {
    if (rule == CompositionRule::jacobian) return inverse_by_jacobian(change_chart_to_mode(x));
    const auto inverted = [](const G& a) { return a.inverse(); };
    return by_cubature<G>(x.mean().rotation().inverse(), rule,
                          [&](CompositionRule by) { return evaluate(x, by, inverted); });
  }
}

template <RotationOrPose G>
ProjectedGaussian<G> between(const ProjectedGaussian<G>& x, const ProjectedGaussian<G>& y,
                             CompositionRule rule) {
  if (rule == CompositionRule::jacobian) return compose(inverse(x, rule), y, rule);
  const auto relative = [](const G& a, const G& b) { return a.inverse() * b; };
  return by_cubature<G>(rotation_of(x.mean().inverse() * y.mean()), rule,
                        [&](CompositionRule by) { return evaluate(x, y, by, relative); });
}

template <RotationOrPose G>
ProjectedGaussian<G> transform(const G& a, const ProjectedGaussian<G>& x) {
  if constexpr (std::same_as<G, SO3d>) {
    return ProjectedGaussian<G>::trusted(a * x.tangent_point(), x.tangent_mean(), x.covariance());
  } else {
    typename G::Tangent mean = x.tangent_mean();
    typename G::TangentMatrix covariance = x.covariance();
    const Eigen::Matrix3d r = a.rotation().matrix();
    mean.template tail<3>() = a * Eigen::Vector3d(mean.template tail<3>());
    covariance.template bottomRows<3>() = (r * covariance.template bottomRows<3>()).eval();
    covariance.template rightCols<3>() =
        (covariance.template rightCols<3>() * r.transpose()).eval();
    symmetrize(covariance);
    return ProjectedGaussian<G>::trusted(a.rotation() * x.tangent_point(), mean, covariance);
  }
}

template <RotationOrPose G>
ProjectedGaussian<G> transform(const ProjectedGaussian<G>& x, const G& b, CompositionRule rule) {
  if constexpr (std::same_as<G, SE3d>) {
    if (b.translation() != Eigen::Vector3d::Zero()) {
      if (rule == CompositionRule::jacobian) return moved_by_jacobian(change_chart_to_mode(x), b);
      const auto moved = [&](const G& a) { return a * b; };
      return by_cubature<G>(x.mean().rotation() * b.rotation(), rule,
                            [&](CompositionRule by) { return evaluate(x, by, moved); });
    }
  }
  // q0 (1, u) b = q0 b (1, Rb^T u).
  const Eigen::Matrix3d back = rotation_of(b).inverse().matrix();
  typename G::TangentMatrix j = G::TangentMatrix::Identity();
  j.template topLeftCorner<3, 3>() = back;
  typename G::TangentMatrix covariance = j * x.covariance() * j.transpose();
  symmetrize(covariance);
  return ProjectedGaussian<G>::trusted(x.tangent_point() * rotation_of(b), j * x.tangent_mean(),
                                       covariance);
}

template ProjectedGaussian<SO3d> compose(const ProjectedGaussian<SO3d>&,
                                         const ProjectedGaussian<SO3d>&, CompositionRule);
template ProjectedGaussian<SE3d> compose(const ProjectedGaussian<SE3d>&,
                                         const ProjectedGaussian<SE3d>&, CompositionRule);
template ProjectedGaussian<SO3d> inverse(const ProjectedGaussian<SO3d>&, CompositionRule);
template ProjectedGaussian<SE3d> inverse(const ProjectedGaussian<SE3d>&, CompositionRule);
template ProjectedGaussian<SO3d> between(const ProjectedGaussian<SO3d>&,
                                         const ProjectedGaussian<SO3d>&, CompositionRule);
template ProjectedGaussian<SE3d> between(const ProjectedGaussian<SE3d>&,
                                         const ProjectedGaussian<SE3d>&, CompositionRule);
template ProjectedGaussian<SO3d> transform(const SO3d&, const ProjectedGaussian<SO3d>&);
template ProjectedGaussian<SE3d> transform(const SE3d&, const ProjectedGaussian<SE3d>&);
template ProjectedGaussian<SO3d> transform(const ProjectedGaussian<SO3d>&, const SO3d&,
                                           CompositionRule);
template ProjectedGaussian<SE3d> transform(const ProjectedGaussian<SE3d>&, const SE3d&,
                                           CompositionRule);

}  // namespace posemix
