// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>

#include "base/every_instruction_set.hpp"
#include "filter/multi_object/joint_gaussian.hpp"
#include "posemix/base/random.hpp"
#include "posemix/base/units.hpp"

/// The update of a joint Gaussian in the columns of what a detection sees. Oracle: the same by
/// dense products and factors, JointGaussian::update_densely.
namespace posemix::internal {
namespace {

Matrix6d random_covariance(double rotation_sd, double translation_sd, RandomStream& stream) {
  Matrix6d root;
  for (double& x : root.reshaped()) x = stream.normal();
  Matrix6d p = root * root.transpose() / 6.0 + 0.2 * Matrix6d::Identity();
  Vector6d sd;
  sd << Eigen::Vector3d::Constant(rotation_sd), Eigen::Vector3d::Constant(translation_sd);
  return sd.asDiagonal() * p * sd.asDiagonal();
}

Vector6d random_vector(double scale, RandomStream& stream) {
  Vector6d v;
  for (double& x : v) x = scale * stream.normal();
  return v;
}

struct Scene {
  JointGaussian joint;
  std::vector<std::size_t> objects;
};

/// A detection of the object at `index` under two components of the noise and clutter.
Explanation explanation(const JointGaussian& joint, std::size_t index, RandomStream& stream) {
  Explanation result;
  result.noise_components = 2;
  const bool slow = joint.blocks_of(index) > 1;
  for (const double weight : {0.6, 0.3}) {
    Innovation seen;
    seen.weight = weight;
    seen.residual = random_vector(0.02, stream);
    seen.noise = random_covariance(0.05 / weight, 0.01 / weight, stream);
    seen.slow_map = SE3d::exp(random_vector(0.3, stream)).adjoint();
    Eigen::Matrix<double, 6, 18> h;
    h << -Matrix6d::Identity(), Matrix6d::Identity(), seen.slow_map;
    Eigen::Matrix<double, 18, 18> p = Eigen::Matrix<double, 18, 18>::Zero();
    const std::size_t blocks[] = {kCamera, index, index + 1};
    for (std::size_t i = 0; i < (slow ? 3u : 2u); ++i) {
      for (std::size_t k = 0; k < (slow ? 3u : 2u); ++k)
        p.block<6, 6>(offset(i), offset(k)) = joint.covariance(blocks[i], blocks[k]);
    }
    seen.covariance = h * p * h.transpose() + seen.noise;
    result.innovations.push_back(seen);
  }
  result.clutter_probability = 0.1;
  return result;
}

/// Objects with and without a slow error, correlated by detections, and odometry between them.
Scene scene(std::size_t objects, RandomStream& stream) {
  Scene result{JointGaussian(ConcentratedGaussian<SE3d>(SE3d::exp(random_vector(0.5, stream)),
                                                        random_covariance(0.3, 1.0, stream))),
               {}};
  JointGaussian& joint = result.joint;
  for (std::size_t k = 0; k < objects; ++k) {
    ConditionalPose object{
        SE3d::exp(random_vector(0.7, stream)), {}, Matrix12d::Zero(), Matrix12x6d::Zero()};
    const Matrix6d camera = joint.covariance(kCamera, kCamera);
    object.covariance.topLeftCorner<6, 6>() = camera + random_covariance(0.1, 0.03, stream);
    object.cross_covariance.topRows<6>() = camera;
    if (k % 2 == 1) {
      object.slow = random_vector(0.01, stream);
      object.covariance.bottomRightCorner<6, 6>() = random_covariance(0.02, 0.01, stream);
    }
    result.objects.push_back(joint.append(object));
  }
  for (int round = 0; round < 3; ++round) {
    joint.add_noise(kCamera, random_covariance(0.01, 0.005, stream));
    for (const std::size_t index : result.objects)
      joint.update_densely(index, explanation(joint, index, stream), {}, {});
  }
  return result;
}

/// Relative to the standard deviations, which differ by decades between coordinates.
double worst_difference(const JointGaussian& a, const JointGaussian& b) {
  const Eigen::MatrixXd expected = b.covariance();
  const Eigen::VectorXd sd = expected.diagonal().cwiseSqrt();
  const Eigen::MatrixXd difference =
      sd.asDiagonal().inverse() * (a.covariance() - expected) * sd.asDiagonal().inverse();
  double worst = difference.cwiseAbs().maxCoeff();
  for (std::size_t k = 0; k < a.size(); ++k) {
    const Vector6d apart =
        a.is_pose(k) ? (a.pose(k) * b.pose(k).inverse()).log() : Vector6d(a.slow(k) - b.slow(k));
    worst = std::max(worst, apart.cwiseQuotient(sd.segment<6>(offset(k))).cwiseAbs().maxCoeff());
  }
  return worst;
}

void expect_the_same(const Scene& scene, std::size_t index, double weight,
                     const GainFactors& factors, RandomStream& stream) {
  SCOPED_TRACE(fmt::format("{} objects, block {}, weight {}, gains {} and {}", scene.objects.size(),
                           index, weight, factors.camera, factors.slow));
  const Explanation leading = explanation(scene.joint, index, stream);
  const Matrix6d camera = scene.joint.covariance(kCamera, kCamera);
  CameraAlternative alternative;
  alternative.weight = weight;
  alternative.mean = camera.llt().matrixL() * random_vector(0.3, stream);
  alternative.covariance = 0.7 * camera;
  JointGaussian found = scene.joint;
  JointGaussian expected = scene.joint;
  const CameraChange change = found.update(index, leading, alternative, factors);
  const CameraChange reference = expected.update_densely(index, leading, alternative, factors);
  EXPECT_LT(worst_difference(found, expected), 1e-11);
  EXPECT_EQ(found.covariance(), found.covariance().transpose());
  EXPECT_LT((change.mean - reference.mean).norm(), 1e-12);
  EXPECT_LT((change.covariance - reference.covariance).norm(),
            1e-11 * (reference.covariance.norm() + camera.norm()));
  EXPECT_LT((change.error_covariance - reference.error_covariance).norm(), 1e-11 * camera.norm());
}

TEST(PairColumns, TheUpdateIsThatByDenseProducts) {
  by_every_instruction_set([] {
    RandomStream stream(21);
    for (const std::size_t objects : {1u, 2u, 5u, 10u}) {
      const Scene scene = internal::scene(objects, stream);
      for (const std::size_t index : {scene.objects.front(), scene.objects.back()}) {
        for (const double weight : {0.0, 1e-3, 0.4, 0.9}) {
          expect_the_same(scene, index, weight, {}, stream);
          expect_the_same(scene, index, weight, {.camera = 0.2, .slow = 0.3}, stream);
          expect_the_same(scene, index, weight, {.camera = 0.0, .slow = 1.0}, stream);
        }
      }
    }
  });
}

TEST(PairColumns, ANearlySingularCovarianceIsLeftToDenseProducts) {
  RandomStream stream(22);
  Scene scene = internal::scene(2, stream);
  // Of the second object hardly anything is left, given the first.
  scene.joint.transform(scene.objects.back(), 1e-9 * Eigen::MatrixXd::Identity(12, 12));
  const std::size_t index = scene.objects.front();
  const Explanation leading = explanation(scene.joint, index, stream);
  const CameraAlternative alternative{0.4, Vector6d::Zero(),
                                      0.7 * scene.joint.covariance(kCamera, kCamera)};
  JointGaussian found = scene.joint;
  JointGaussian expected = scene.joint;
  found.update(index, leading, alternative, {});
  expected.update_densely(index, leading, alternative, {});
  EXPECT_EQ(found.covariance(), expected.covariance());
  for (std::size_t k = 0; k < found.size(); ++k) {
    if (!found.is_pose(k)) continue;
    EXPECT_EQ(found.pose(k).matrix(), expected.pose(k).matrix());
  }
}

}  // namespace
}  // namespace posemix::internal
