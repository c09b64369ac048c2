// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors

// What a frame of the multi-object filter asks the heap for once the filter runs: nothing. The
// functions of the C library that give memory are replaced in this program by ones that count.
#include <gtest/gtest.h>

#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "posemix/base/units.hpp"
#include "posemix/detector/default_noise.hpp"
#include "posemix/filter/multi_object_filter.hpp"
#include "scenario.hpp"

#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define POSEMIX_MEMORY_IS_WATCHED
#endif
#endif
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || !defined(__GLIBC__)
#define POSEMIX_MEMORY_IS_WATCHED
#endif

namespace {
std::atomic<long> allocations = 0;
}  // namespace

#ifndef POSEMIX_MEMORY_IS_WATCHED
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
void* __libc_realloc(void* memory, std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);

void* malloc(std::size_t size) {
  ++allocations;
  return __libc_malloc(size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  ++allocations;
  return __libc_memalign(alignment, size);
}
void* realloc(void* memory, std::size_t size) {
  ++allocations;
  return __libc_realloc(memory, size);
}
void* calloc(std::size_t count, std::size_t size) {
  ++allocations;
  return __libc_calloc(count, size);
}
int posix_memalign(void** memory, std::size_t alignment, std::size_t size) {
  ++allocations;
  *memory = __libc_memalign(alignment, size);
  return *memory == nullptr ? ENOMEM : 0;
}
}
#endif

namespace posemix {
namespace {

using testing::draw;

/// Detections of one frame, and the step of the camera, to a filter.
using Frame = std::function<void(MultiObjectFilter&, int)>;

Matrix6d noise_of(double rotation_deg, double translation_m) {
  return pose_covariance(Eigen::Vector3d::Constant(radians(rotation_deg)),
                         Eigen::Vector3d::Constant(translation_m));
}

const Matrix6d& step_noise() {
  static const Matrix6d q = noise_of(0.05, 6e-4);
  return q;
}

DetectorNoise plain_noise() {
  return DetectorNoise({{.weight = 0.95, .covariance = noise_of(1.0, 0.004)}},
                       {.weight = 0.05, .volume_m3 = 10.0});
}

/// Objects before a camera that stays, seen in one of so many modes by turns, with half of the
/// noise that is stated: no detection starts a hypothesis by chance.
class Scene {
 public:
  Scene(std::size_t objects, int modes) : modes_(modes) {
    for (std::size_t j = 0; j < objects; ++j) {
      const auto place = static_cast<double>(j);
      objects_.emplace_back(SO3d::exp({0.2 * place, 0.1, -0.3 * place}),
                            Eigen::Vector3d(0.15 * place - 0.3, 0.05, 0.9));
    }
  }

  std::size_t size() const { return objects_.size(); }
  SE3d seen(std::size_t j, int frame) {
    const double turn = 2.0 * std::numbers::pi / 3.0 * (frame % modes_);
    const SE3d mode(SO3d::exp({0.0, 0.0, turn}), Eigen::Vector3d::Zero());
    return objects_[j] * mode * SE3d::exp(draw(noise_of(0.5, 0.002), stream_));
  }

 private:
  int modes_;
  RandomStream stream_{3, 1};
  std::vector<SE3d> objects_;
};

MultiObjectFilter filter_with(const Scene& scene, const ObjectSensor& sensor,
                              const MultiObjectSettings& settings = {}) {
  return {ConcentratedGaussian<SE3d>(SE3d(), noise_of(0.1, 0.002)),
          std::vector<ObjectSensor>(scene.size(), sensor), settings};
}

/// Allocations of the last hundred of three hundred frames.
long allocations_of(MultiObjectFilter& filter, Scene& scene, const Frame& predict) {
  long sum = 0;
  for (int frame = 0; frame < 300; ++frame) {
    std::vector<SE3d> seen;
    for (std::size_t j = 0; j < scene.size(); ++j) seen.push_back(scene.seen(j, frame));
    const long before = allocations;
    predict(filter, frame);
    for (std::size_t j = 0; j < scene.size(); ++j) filter.update(j, seen[j]);
    if (frame >= 200) sum += allocations - before;
  }
  return sum;
}

void by_odometry(MultiObjectFilter& filter, int /*frame*/) {
  filter.predict_with_odometry(SE3d(), step_noise(), 0.1);
}

void by_random_walk(MultiObjectFilter& filter, int /*frame*/) {
  filter.predict_random_walk(step_noise(), 0.1);
}

void by_constant_velocity(MultiObjectFilter& filter, int /*frame*/) {
  filter.predict_constant_velocity(1.0, step_noise(), 1e-2 * step_noise(), noise_of(1.0, 0.01),
                                   0.1);
}

void by_given_camera(MultiObjectFilter& filter, int /*frame*/) {
  filter.set_camera({SE3d(), step_noise()}, 0.1);
}

class Allocations : public ::testing::Test {
 protected:
  void SetUp() override {
#ifdef POSEMIX_MEMORY_IS_WATCHED
    GTEST_SKIP() << "a sanitizer has functions of its own that give memory";
#endif
  }
};

TEST_F(Allocations, AreCounted) {
  const long before = allocations;
  const auto vector = std::vector<double>(static_cast<std::size_t>(before % 2 + 10));
  const Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(static_cast<long>(vector.size()), 3);
  EXPECT_EQ(allocations - before, 2) << matrix.sum();
}

TEST_F(Allocations, NoneWhereEveryObjectHasOneMode) {
  for (const std::size_t objects : {1, 5, 10}) {
    for (const Frame& predict : {Frame(by_odometry), Frame(by_random_walk)}) {
      Scene scene(objects, 1);
      MultiObjectFilter filter = filter_with(scene, {plain_noise()});
      EXPECT_EQ(allocations_of(filter, scene, predict), 0) << objects;
    }
  }
}

TEST_F(Allocations, NoneByTheNoiseThatNothingIsToldOf) {
  for (const std::size_t objects : {1, 5, 10}) {
    for (const Frame& predict : {Frame(by_odometry), Frame(by_random_walk),
                                 Frame(by_constant_velocity), Frame(by_given_camera)}) {
      Scene scene(objects, 1);
      MultiObjectFilter filter = filter_with(scene, {default_detector_noise()});
      EXPECT_EQ(allocations_of(filter, scene, predict), 0) << objects;
    }
  }
}

TEST_F(Allocations, NoneOfObjectsWithAnAxis) {
  Scene scene(5, 1);
  const SymmetryGroup cup({}, {{Eigen::Vector3d::UnitZ()}});
  MultiObjectFilter filter = filter_with(scene, {plain_noise(), cup});
  EXPECT_EQ(allocations_of(filter, scene, by_odometry), 0);
}

TEST_F(Allocations, NoneWhereThreeModesOfEveryObjectCompete) {
  for (const std::size_t objects : {1, 5, 10}) {
    Scene scene(objects, 3);
    MultiObjectFilter filter = filter_with(scene, {plain_noise()});
    EXPECT_EQ(allocations_of(filter, scene, by_odometry), 0) << objects;
  }
}

TEST_F(Allocations, NoneByConstantVelocity) {
  for (const std::size_t objects : {1, 5}) {
    Scene scene(objects, 1);
    MultiObjectFilter filter = filter_with(scene, {plain_noise()}, {.has_odometry = false});
    EXPECT_EQ(allocations_of(filter, scene, by_constant_velocity), 0) << objects;
  }
}

}  // namespace
}  // namespace posemix
