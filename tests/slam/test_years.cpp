// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// A filter that runs on and on: objects that stay, one that moves and pauses, instances of a class
// that come and go. 20,000 frames here; POSEMIX_YEARS_FRAMES=10000000 for as many as one likes.
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Cholesky>

#include "moving_orbit.hpp"
#include "posemix/slam/state.hpp"

namespace posemix {
namespace {

using testing::isotropic;
using testing::nees_of;
using testing::pose;

constexpr double kPeriod_s = 0.1;
constexpr std::size_t kMovingObject = 2;
constexpr double kBeyond = 10.0;  ///< NEES per degree of freedom that none of a million should have

long frames() {
  const char* text = std::getenv("POSEMIX_YEARS_FRAMES");
  return text == nullptr ? 20000 : std::atol(text);
}

/// Memory of the process that is in use [MB].
double resident_mb() {
  std::ifstream file("/proc/self/statm");
  double all = 0.0;
  double resident = 0.0;
  file >> all >> resident;
  return resident * 4096e-6;
}

/// A tenth of the run.
struct Part {
  long frames = 0;
  double seconds = 0.0;
  std::size_t state_bytes = 0;  ///< the most
  double resident_mb = 0.0;
  long looks = 0;
  std::size_t cameras = 0;  ///< global hypotheses at all looks
  std::size_t most_cameras = 0;
  double world_nees = 0.0;                     ///< of the camera in the world, at all looks
  double world_variance_m2 = 0.0;              ///< of its position, a sum over all looks
  std::vector<double> nees = {0.0, 0.0, 0.0};  ///< sums, of the objects that stay and the hand
  std::vector<long> counts = {0, 0, 0};
  double worst_hand = 0.0;  ///< NEES per degree of freedom of the hand
  long worst_hand_at = 0;   ///< the frame of it
  long hand_beyond = 0;     ///< frames with more than kBeyond
  long cups_seen = 0;
  long cups_there = 0;

  double anees(std::size_t object) const {
    return nees[object] / (6.0 * static_cast<double>(counts[object]));
  }
};

/// How a hand moves when it moves. It begins slowly, and mostly towards the middle of the scene.
const ConstantVelocityMotion kSlow{.acceleration_sds = testing::sds(0.05, 0.02),
                                   .start_sds = testing::sds(0.2, 0.05),
                                   .break_rate = 0.0};
constexpr double kRate = 0.2;  ///< of its starts and stops [1/s]

/// A camera that goes round the scene, a hand that moves for five seconds on average and rests for
/// as long, and two cups that somebody takes away after some minutes and puts elsewhere.
class Kitchen {
 public:
  explicit Kitchen(std::uint64_t seed)
      : orbit_(seed, 2, 0.05, 1e-3), stream_(seed, 23), hand_(seed, noise()) {
    for (SE3d& cup : cups_) cup = anywhere();
  }

  static DetectorNoise noise() { return testing::SceneNoise{}.noise(); }

  static MultiObjectSlam slam(const Kitchen& kitchen) {
    std::vector<ObjectModel> models = {{.id = "box", .noise = noise()},
                                       {.id = "mug", .noise = noise()}};
    MotionModels moves{.models = {StaticMotion{}, kSlow}};
    moves.rates = Eigen::MatrixXd::Constant(2, 2, kRate);
    models.push_back({.id = "hand", .noise = noise(), .motion = moves});
    for (const char* id : {"cup-1", "cup-2", "cup-3"})
      models.push_back({.id = id, .noise = noise(), .class_id = "cup"});
    MultiObjectSlamSettings settings = testing::plain_slam();
    settings.moving = testing::plain_moving_settings();
    settings.existence.lifetime_s = 150.0;
    MotionSettings motion;
    motion.noise = {kitchen.orbit_.q, NoisePer::frame};
    return {testing::start_near(kitchen.orbit_.camera), models, settings, motion};
  }

  FrameInput next() {
    FrameInput input{.dt = kPeriod_s, .motion = orbit_.advance()};
    if (++frame_ == 1) first_ = orbit_.camera;
    move_hand();
    if (frame_ % 1500 == 0) cups_[static_cast<std::size_t>(frame_ / 1500 % 2)] = anywhere();
    see(input, orbit_.truth[0], "box", "");
    see(input, orbit_.truth[1], "mug", "");
    see(input, hand_.truth, "hand", "");
    for (const SE3d& cup : cups_)
      if (stream_.uniform() < 0.8) see(input, cup, "", "cup");
    return input;
  }

  const SE3d& camera() const { return orbit_.camera; }
  /// The same in the world of the filter, which is at its start in the first frame.
  SE3d camera_in_map() const { return start_ * first_.inverse() * orbit_.camera; }
  SE3d truth(std::size_t object) const {
    return object == kMovingObject ? hand_.truth : orbit_.truth[object];
  }
  const std::vector<SE3d>& cups() const { return cups_; }

 private:
  void move_hand() {
    if (stream_.uniform() < 1.0 - std::exp(-kRate * kPeriod_s)) {
      moves_ = !moves_;
      hand_.twist.setZero();
      for (Eigen::Index i = 0; moves_ && i < 6; ++i)
        hand_.twist[i] = kSlow.start_sds[i] * stream_.normal();
      const Eigen::Vector3d along = hand_.truth.rotation() * Eigen::Vector3d(hand_.twist.tail<3>());
      if (along.dot(hand_.truth.translation()) > 0.0) hand_.twist.tail<3>() *= -1.0;
    }
    if (moves_) hand_.advance(kSlow, kPeriod_s);
  }

  SE3d anywhere() {
    const double angle = 2.0 * std::numbers::pi * stream_.uniform();
    return pose(0.0, 0.0, 6.0 * stream_.uniform(), 0.3 * std::cos(angle), 0.3 * std::sin(angle),
                0.0);
  }

  /// A detection by the noise model: one of its components, or something else.
  void see(FrameInput& input, const SE3d& object, const char* id, const char* class_id) {
    const SE3d seen = orbit_.camera.inverse() * object;
    double chance = stream_.uniform();
    SE3d detected =
        orbit_.camera.inverse() * pose(6.0 * stream_.uniform(), 1.0, 2.0, stream_.uniform() - 0.5,
                                       stream_.uniform() - 0.5, stream_.uniform() - 0.5);
    for (const NoiseComponent& component : noise_.components()) {
      if (chance < component.weight && chance >= 0.0) {
        const NoiseAtPose at = noise_at(component, seen);
        detected =
            at.axes * SE3d::exp(testing::draw(at.covariance, stream_)) * at.axes.inverse() * seen;
      }
      chance -= component.weight;
    }
    Observation observation = observation_of(detected);
    observation.object = id;
    observation.class_id = class_id;
    input.observations.push_back(observation);
  }

  testing::OrbitScene orbit_;
  RandomStream stream_;
  DetectorNoise noise_ = noise();
  SE3d start_ = orbit_.camera;
  SE3d first_;
  long frame_ = 0;
  testing::MovingScene hand_;
  bool moves_ = false;
  std::vector<SE3d> cups_ = std::vector<SE3d>(2);
};

/// Symmetric, positive definite, and probabilities that are some.
void expect_sound(const MultiObjectSlam& slam, const FrameEstimate& estimate, long frame) {
  const Eigen::MatrixXd covariance = slam.estimate().covariance();
  ASSERT_TRUE(covariance.allFinite()) << frame;
  ASSERT_EQ(covariance, covariance.transpose().eval()) << frame;
  ASSERT_EQ(Eigen::LLT<Eigen::MatrixXd>(covariance).info(), Eigen::Success) << frame;
  const Mixture<PoseDensity> camera = slam.filter().camera_mixture();
  double sum = 0.0;
  for (std::size_t k = 0; k < camera.size(); ++k) sum += camera.weight(k);
  ASSERT_NEAR(sum, 1.0, 1e-12) << frame;
  for (std::size_t object = 0; object < slam.objects().size(); ++object) {
    double all = 0.0;
    for (const ObjectHypothesis& h : slam.hypotheses(object)) {
      ASSERT_EQ(Eigen::LLT<Matrix6d>(h.covariance).info(), Eigen::Success) << frame;
      all += h.probability;
    }
    ASSERT_LE(all, 1.0 + 1e-9) << frame;
    const auto exists = estimate.existences[object];
    ASSERT_TRUE(!exists || (*exists >= 0.0 && *exists <= 1.0)) << frame;
  }
}

void score(const MultiObjectSlam& slam, const FrameEstimate& estimate, const Kitchen& kitchen,
           long frame, Part& part) {
  for (std::size_t object = 0; object <= kMovingObject; ++object) {
    if (!estimate.relative[object]) continue;
    const SE3d seen = kitchen.camera().inverse() * kitchen.truth(object);
    const double nees = nees_of(seen, *estimate.relative[object]);
    part.nees[object] += nees;
    ++part.counts[object];
    if (object != kMovingObject) continue;
    part.hand_beyond += nees / 6.0 > kBeyond ? 1 : 0;
    if (!(nees / 6.0 > part.worst_hand)) continue;
    part.worst_hand = nees / 6.0;
    part.worst_hand_at = frame;
  }
  for (const SE3d& cup : kitchen.cups()) {
    bool found = false;
    for (std::size_t k = kMovingObject + 1; k < slam.objects().size(); ++k) {
      found =
          found || (slam.is_confirmed(k) && estimate.objects[k] &&
                    (estimate.objects[k]->mean().translation() - cup.translation()).norm() < 0.05);
    }
    part.cups_seen += found ? 1 : 0;
    ++part.cups_there;
  }
}

void look(const MultiObjectSlam& slam, const FrameEstimate& estimate, const Kitchen& kitchen,
          long frame, Part& part) {
  expect_sound(slam, estimate, frame);
  part.state_bytes = std::max(part.state_bytes, state_bytes(slam).size());
  part.resident_mb = resident_mb();
  const std::size_t cameras = slam.filter().camera_mixture().size();
  part.cameras += cameras;
  part.most_cameras = std::max(part.most_cameras, cameras);
  part.world_nees += nees_of(kitchen.camera_in_map(), slam.filter().camera());
  part.world_variance_m2 += slam.filter().camera().covariance().bottomRightCorner<3, 3>().trace();
  ++part.looks;
}

/// A line for a tenth, as soon as it is over.
void print(const Part& part) {
  std::cout << part.frames << " frames, " << 1e6 * part.seconds / static_cast<double>(part.frames)
            << " us each, " << static_cast<double>(part.cameras) / static_cast<double>(part.looks)
            << " global hypotheses, " << part.most_cameras << " at most, state of "
            << part.state_bytes << " bytes, " << part.resident_mb << " MB, ANEES " << part.anees(0)
            << ' ' << part.anees(1) << ' ' << part.anees(kMovingObject) << " (the worst "
            << part.worst_hand << " in frame " << part.worst_hand_at << ", " << part.hand_beyond
            << " beyond " << kBeyond << "; of the camera in the world "
            << part.world_nees / (6.0 * static_cast<double>(part.looks)) << "), cups found "
            << static_cast<double>(part.cups_seen) / static_cast<double>(part.cups_there)
            << std::endl;
}

std::vector<Part> years(long count) {
  Kitchen kitchen(1);
  MultiObjectSlam slam = Kitchen::slam(kitchen);
  std::vector<Part> parts(10);
  for (long frame = 0; frame < count; ++frame) {
    Part& part = parts[static_cast<std::size_t>(10 * frame / count)];
    const FrameInput input = kitchen.next();
    const auto start = std::chrono::steady_clock::now();
    const FrameEstimate estimate = slam.step(input);
    part.seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    ++part.frames;
    score(slam, estimate, kitchen, frame, part);
    if (frame % 100 == 0) look(slam, estimate, kitchen, frame, part);
    if (::testing::Test::HasFatalFailure()) return parts;
    if (10 * (frame + 1) / count > 10 * frame / count) print(part);
  }
  return parts;
}

TEST(Years, NothingGrowsAndErrorsStayAsLargeAsTheCovariancesSay) {
  const std::vector<Part> parts = years(frames());
  if (HasFatalFailure()) return;
  const Part& first = parts[1];
  const Part& last = parts.back();
  // As many hypotheses as the caps allow, whenever they compete.
  EXPECT_LT(static_cast<double>(last.state_bytes), 1.5 * static_cast<double>(first.state_bytes));
  EXPECT_LT(last.resident_mb, first.resident_mb + 4.0);
  for (std::size_t object = 0; object <= kMovingObject; ++object) {
    EXPECT_GT(last.anees(object), 0.8) << object;
    EXPECT_LT(last.anees(object), 1.25) << object;
  }
  // Nothing tells where the world is. In 200,000 frames almost a third of the variance was lost
  // once.
  const auto world = [](const Part& part) {
    return part.world_variance_m2 / static_cast<double>(part.looks);
  };
  EXPECT_GT(world(last), 0.9 * world(first));
  // A cup that is put elsewhere has to be seen there some times, and its model to be free.
  double found = 0.0;
  for (const Part& part : parts)
    found += 0.1 * static_cast<double>(part.cups_seen) / static_cast<double>(part.cups_there);
  EXPECT_GT(found, 0.75);
}

}  // namespace
}  // namespace posemix
