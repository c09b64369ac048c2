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

struct PairScene {
  JointGaussian joint;
  std::vector<std::size_t> objects;
  double noise = 1.0;  ///< of detections, a factor
};

/// A detection of the object at `index` under two components of the noise and clutter.
Explanation explanation(const JointGaussian& joint, std::size_t index, double noise,
                        RandomStream& stream) {
  Explanation result;
  result.noise_components = 2;
  const bool slow = joint.blocks_of(index) > 1;
  for (const double weight : {0.6, 0.3}) {
    Innovation seen;
    seen.weight = weight;
    seen.residual = random_vector(0.02 * noise, stream);
    seen.noise = random_covariance(0.05 * noise / weight, 0.01 * noise / weight, stream);
    seen.slow_map = SE3d::exp(random_vector(0.3 * noise, stream)).adjoint();
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
PairScene scene(std::size_t objects, RandomStream& stream, double noise = 1.0) {
  PairScene result{JointGaussian(ConcentratedGaussian<SE3d>(SE3d::exp(random_vector(0.5, stream)),
                                                            random_covariance(0.3, 1.0, stream))),
                   {},
                   noise};
  JointGaussian& joint = result.joint;
  for (std::size_t k = 0; k < objects; ++k) {
    ConditionalPose object{
        SE3d::exp(random_vector(0.7, stream)), {}, Matrix12d::Zero(), Matrix12x6d::Zero()};
    const Matrix6d camera = joint.covariance(kCamera, kCamera);
    object.covariance.topLeftCorner<6, 6>() =
        camera + random_covariance(0.1 * noise, 0.03 * noise, stream);
    object.cross_covariance.topRows<6>() = camera;
    if (k % 2 == 1) {
      object.slow = random_vector(0.01, stream);
      // Found by a detection with this slow error.
      const Matrix6d slow = random_covariance(0.02, 0.01, stream);
      object.covariance.topLeftCorner<6, 6>() += slow;
      object.covariance.topRightCorner<6, 6>() = -slow;
      object.covariance.bottomLeftCorner<6, 6>() = -slow;
      object.covariance.bottomRightCorner<6, 6>() = slow;
    }
    result.objects.push_back(joint.append(object));
  }
  for (int round = 0; round < 3; ++round) {
    joint.add_noise(kCamera, random_covariance(0.01, 0.005, stream));
    for (const std::size_t index : result.objects)
      joint.update_densely(index, explanation(joint, index, noise, stream), {}, {});
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

void expect_the_same(const PairScene& scene, std::size_t index, double weight,
                     const GainFactors& factors, RandomStream& stream, double bound = 1e-11) {
  SCOPED_TRACE(fmt::format("{} objects, block {}, weight {}, gains {} and {}", scene.objects.size(),
                           index, weight, factors.camera, factors.slow));
  const Explanation leading = explanation(scene.joint, index, scene.noise, stream);
  const Matrix6d camera = scene.joint.covariance(kCamera, kCamera);
  CameraAlternative alternative;
  alternative.weight = weight;
  alternative.mean = camera.llt().matrixL() * random_vector(0.3, stream);
  alternative.covariance = 0.7 * camera;
  JointGaussian found = scene.joint;
  JointGaussian expected = scene.joint;
  const CameraChange change = found.update(index, leading, alternative, factors);
  const CameraChange reference = expected.update_densely(index, leading, alternative, factors);
  EXPECT_LT(worst_difference(found, expected), bound);
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
      const PairScene scene = internal::scene(objects, stream);
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

/// The world is shifted by so much: rotations about its origin move everything.
PairScene seen_from(const SE3d& shift, const PairScene& scene) {
  PairScene result = scene;
  for (std::size_t k = 0; k < scene.joint.size(); ++k) {
    if (!scene.joint.is_pose(k)) continue;
    result.joint.set_pose(k, shift * scene.joint.pose(k));
    Eigen::MatrixXd by = Eigen::MatrixXd::Identity(6, 6);
    by = shift.adjoint();
    if (result.joint.blocks_of(k) > 1) {
      Eigen::MatrixXd both = Eigen::MatrixXd::Identity(12, 12);
      both.topLeftCorner<6, 6>() = by;
      by = both;
    }
    result.joint.transform(k, by);
  }
  return result;
}

// A detection where a slow error is known much worse than what is left of the pose.
TEST(PairColumns, ASmallNoiseLosesNoMoreThanWithDenseProducts) {
  RandomStream stream(23);
  for (const double noise : {1e-1, 1e-2, 1e-3, 1e-4}) {
    const PairScene scene = internal::scene(3, stream, noise);
    for (const std::size_t index : scene.objects) {
      expect_the_same(scene, index, 0.0, {}, stream, 1e-13);
      // The factor of a covariance in which `noise` is left of a variance loses digits of it.
      expect_the_same(scene, index, 0.4, {}, stream, 1e-11 / (noise * noise));
    }
  }
}

TEST(PairColumns, FarFromTheOriginTheUpdateIsWhatItIsThere) {
  RandomStream stream(24);
  const PairScene near = internal::scene(3, stream);
  for (const double distance : {1e2, 1e4, 1e5}) {
    const SE3d shift(SO3d(), {distance, 0.0, 0.0});
    for (const std::size_t index : near.objects) {
      SCOPED_TRACE(fmt::format("{} m, block {}", distance, index));
      const Explanation leading = explanation(near.joint, index, near.noise, stream);
      Explanation far_leading = leading;
      for (Innovation& seen : far_leading.innovations) {
        seen.residual = shift.adjoint() * seen.residual;
        seen.covariance = shift.adjoint_congruence(seen.covariance);
        seen.noise = shift.adjoint_congruence(seen.noise);
        seen.slow_map = shift.adjoint() * seen.slow_map;
      }
      PairScene expected = near;
      expected.joint.update_densely(index, leading, {}, {});
      PairScene far = seen_from(shift, near);
      far.joint.update(index, far_leading, {}, {});
      // A rotation of a third of a radian moves what is `distance` away by more than it is known,
      // to 3 mm: of sixteen digits twice that ratio's are lost.
      const double lost = distance * 0.3 / 0.003;
      const PairScene back = seen_from(shift.inverse(), far);
      EXPECT_LT(worst_difference(back.joint, expected.joint), 1e-16 * lost * lost);
    }
  }
}

TEST(PairColumns, ANearlySingularCovarianceIsLeftToDenseProducts) {
  RandomStream stream(22);
  PairScene scene = internal::scene(2, stream);
  // Of another object hardly anything is left, given the camera.
  ConditionalPose object{SE3d(), {}, Matrix12d::Zero(), Matrix12x6d::Zero()};
  const Matrix6d known = scene.joint.covariance(kCamera, kCamera);
  object.covariance.topLeftCorner<6, 6>() = known + 1e-10 * Matrix6d::Identity();
  object.cross_covariance.topRows<6>() = known;
  scene.joint.append(object);
  const std::size_t index = scene.objects.front();
  const Explanation leading = explanation(scene.joint, index, scene.noise, stream);
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
