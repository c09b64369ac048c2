// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "filter/scenario.hpp"
#include "posemix/slam/stamped_slam.hpp"

/// A recording with everything that a state may hold, for the tests of saved states: a rig with a
/// camera that is calibrated on the way, flips, symmetries, classes with wrong sightings, an object
/// of a known place, one that is put down elsewhere, moving ones of which a gripper holds one, two
/// detectors, objects that were not declared, objects that are forgotten, empty images, and input
/// that comes late.
namespace posemix::testing {

struct StampedOdometry {
  double stamp_s;
  SE3d odom_body;
};
struct StampedGripper {
  double stamp_s;
  SE3d world_gripper;
};
struct StampedImage {
  double stamp_s;
  std::string camera;
};
struct StampedForget {
  double stamp_s;
  std::string id;
};
using StampedInput =
    std::variant<Observation, StampedOdometry, StampedGripper, StampedImage, StampedForget>;

inline double stamp_of(const StampedInput& input) {
  return std::visit([](const auto& one) { return one.stamp_s; }, input);
}

inline StampAdmission give(StampedSlam& slam, const StampedInput& input) {
  if (const auto* odometry = std::get_if<StampedOdometry>(&input))
    return slam.add_odometry(odometry->stamp_s, odometry->odom_body);
  if (const auto* gripper = std::get_if<StampedGripper>(&input))
    return slam.add_frame("gripper", gripper->stamp_s, {.pose = gripper->world_gripper});
  if (const auto* image = std::get_if<StampedImage>(&input))
    return slam.add_image(image->stamp_s, image->camera);
  if (const auto* forget = std::get_if<StampedForget>(&input))
    return slam.forget(forget->id, forget->stamp_s);
  return slam.add(std::get<Observation>(input));
}

class RichScene {
 public:
  static SE3d body_at(double t) {
    return SE3d(SO3d::exp({-2.2, 0.0, 0.0}), {0.0, -0.65, 0.45}) *
           SE3d::exp(t * (Vector6d() << 0.0, 0.02, 0.03, 0.02, 0.0, 0.01).finished());
  }
  static SE3d body_camera(const std::string& camera) {
    return camera == "left" ? SE3d() : pose(0.0, 0.05, 0.0, 0.1, 0.0, 0.0);
  }
  static SE3d gripper_at(double t) {
    return pose(0.1, 0.2, 0.3 * t, 0.1 * std::sin(t), 0.1, 0.1 + 0.02 * t);
  }

  static std::vector<ObjectModel> models() {
    const ConstantVelocityMotion calm{.break_rate = 0.01};
    std::vector<ObjectModel> all;
    all.push_back({.id = "mug"});
    all.push_back({.id = "bottle", .symmetries = SymmetryGroup::turns({0.0, 0.0, 1.0}, 0)});
    all.push_back({.id = "box",
                   .symmetries = SymmetryGroup::turns({1.0, 0.0, 0.0}, 2),
                   .detectors = {{"coarse", gaussian_noise(8.0, 0.03)}}});
    for (const char* id : {"nut-1", "nut-2", "nut-3"}) all.push_back({.id = id, .class_id = "nut"});
    ObjectModel shelf{.id = "shelf"};
    shelf.prior = ObjectPrior{PoseDensity(place("shelf"), isotropic(2.0, 0.02)), 0.9};
    all.push_back(shelf);
    ObjectModel tray{.id = "tray"};
    tray.motion.models = {PutDownMotion{.jump_rate = 0.05}};
    all.push_back(tray);
    ObjectModel tool{.id = "tool"};
    tool.motion.models = {StaticMotion{}, AttachedMotion{.frame = 0}, calm};
    tool.motion.rates = Eigen::MatrixXd::Constant(3, 3, 0.3);
    all.push_back(tool);
    all.push_back({.id = "hand", .motion = calm_and_agile(calm)});
    return all;
  }

  static MultiObjectSlamSettings settings() {
    MultiObjectSlamSettings all;
    all.cameras = {{"left", body_camera("left")},
                   {"right", body_camera("right"), isotropic(1.0, 0.01)}};
    all.frames = {"gripper"};
    all.on_sight = ObjectModel{.id = ""};
    all.existence.hidden_time_s = 1.0;
    all.existence.deleted_probability = 0.2;
    return all;
  }

  static StampedSlam slam(const StampedSlamSettings& stamped = {.on_jump_back = StampJump::reset}) {
    return {
        PoseDensity(body_at(0.0), isotropic(0.1, 0.001)), models(), settings(), {}, stamped, true};
  }

  explicit RichScene(std::uint64_t seed) : stream_(seed, 3) {}

  /// Inputs of some seconds, every one up to 0.8 s late.
  std::vector<StampedInput> session(double seconds) {
    std::vector<StampedInput> inputs;
    for (double t = 0.0; t < seconds; t += 0.05) inputs.push_back(StampedOdometry{t, body_at(t)});
    for (double t = 0.0; t < seconds; t += 0.11)
      inputs.push_back(StampedGripper{t + 0.003, gripper_at(t)});
    for (int k = 0; 0.02 + 0.1 * k < seconds; ++k) {
      const double t = 0.02 + 0.1 * k;
      const std::string camera = k % 3 == 2 ? "right" : "left";
      if (k % 7 == 6) {
        inputs.push_back(StampedImage{t, camera});
        continue;
      }
      for (const char* id : {"mug", "bottle", "box", "shelf", "tray", "tool", "hand", "lid"})
        if (stream_.uniform() < 0.8) inputs.emplace_back(sighting(id, t, camera));
      for (const char* id : {"nut-1", "nut-2"})
        if (stream_.uniform() < 0.8) inputs.emplace_back(of_class(sighting(id, t, camera)));
      // What the detector takes for a nut, for a short time.
      if (k % 9 == 4) inputs.emplace_back(of_class(sighting("ghost", t, camera)));
    }
    const std::pair<double, const char*> forgotten[] = {{4.01, "mug"},  {5.22, "hand"},
                                                        {6.3, "nut-2"}, {7.52, "box"},
                                                        {8.0, "tray"},  {9.0, "shelf"}};
    for (const auto& [t, id] : forgotten)
      if (t < seconds) inputs.push_back(StampedForget{t, id});
    std::vector<std::pair<double, StampedInput>> arrivals;
    for (const StampedInput& input : inputs)
      arrivals.emplace_back(testing::stamp_of(input) + 0.8 * stream_.uniform(), input);
    std::stable_sort(arrivals.begin(), arrivals.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    inputs.clear();
    for (auto& [arrival, input] : arrivals) inputs.push_back(std::move(input));
    return inputs;
  }

 private:
  static SE3d place(const std::string& id) {
    static const std::map<std::string, SE3d> kPlaces{
        {"mug", pose(0.3, 0.2, 0.5, -0.1, 0.1, 0.05)},
        {"bottle", pose(0.1, 0.0, 0.2, 0.15, 0.05, 0.0)},
        {"box", pose(0.0, 0.3, -0.4, 0.0, 0.2, 0.0)},
        {"shelf", pose(0.2, -0.3, 1.0, -0.2, 0.25, 0.1)},
        {"tray", pose(0.0, 0.0, 0.7, 0.2, 0.2, 0.02)},
        {"lid", pose(0.5, 0.0, 0.0, -0.05, -0.05, 0.0)},
        {"nut-1", pose(0.0, 0.0, 0.2, 0.05, 0.0, 0.0)},
        {"nut-2", pose(0.0, 0.4, 0.0, -0.15, 0.0, 0.0)},
        {"ghost", pose(1.0, 0.4, 0.0, 0.1, 0.3, 0.1)}};
    return kPlaces.at(id);
  }
  static SE3d truth(const std::string& id, double t) {
    if (id == "tool") return gripper_at(t) * pose(0.2, 0.0, 0.0, 0.0, 0.0, 0.05);
    if (id == "hand") return pose(0.1, 0.2, 0.3, 0.15 * std::cos(t), 0.15 * std::sin(2.0 * t), 0.1);
    if (id == "tray" && t > 2.5) return pose(0.0, 0.0, -0.7, -0.1, 0.25, 0.02);
    return place(id);
  }
  static Observation of_class(Observation seen) {
    seen.object.clear();
    seen.class_id = "nut";
    return seen;
  }

  Observation sighting(const std::string& id, double t, const std::string& camera) {
    const SE3d flip = pose(0.0, 0.0, std::numbers::pi, 0.0, 0.0, 0.0);
    const Matrix6d error = isotropic(2.0, 0.005);
    SE3d seen = (body_at(t) * body_camera(camera)).inverse() * truth(id, t) *
                SE3d::exp(draw(error, stream_));
    if (stream_.uniform() < 0.15) seen = seen * pose(2.0, 0.3, 0.0, 0.1, 0.05, 0.0);
    Observation observation{.object = id, .camera = camera, .stamp_s = t};
    if (id == "mug" || id == "tray") {
      observation.components = {{.weight = 0.55, .pose = seen},
                                {.weight = 0.45, .pose = seen * flip}};
    } else {
      observation.components = {{.pose = seen}};
    }
    if (id == "box" && stream_.uniform() < 0.5) observation.detector = "coarse";
    if (id == "bottle") observation.components[0].covariance = error;
    if (id == "shelf") observation.clutter = 0.1;
    if (id == "lid") observation.score = 0.8;
    return observation;
  }

  RandomStream stream_;
};

}  // namespace posemix::testing
