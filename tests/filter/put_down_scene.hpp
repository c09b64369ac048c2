// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cmath>
#include <utility>
#include <vector>

#include "moving_object_scene.hpp"
#include "multi_object_scene.hpp"

/// A camera that circles objects, some of which are put down elsewhere, for the tests of the filter
/// of many objects.
namespace posemix::testing {

/// How a detector is wrong beyond its noise model: in runs, at a pose that is turned by `flip`, or
/// at another place in the world.
struct Runs {
  int length = 0;     ///< of a run in detections; none where zero
  double part = 0.0;  ///< of all detections
  SE3d flip = kFlipOfObject;
  bool elsewhere = false;  ///< the run is at truth * flip whatever the object does
};

class PutDownScene {
 public:
  PutDownScene(std::uint64_t seed, std::size_t objects, DetectorNoise noise, Runs runs = {},
               const Matrix6d& odometry = isotropic(0.3, 3e-3))
      : stream(seed, 23),
        q(odometry),
        camera(OrbitScene::camera_at(0)),
        in_run(objects, 0),
        noise_(std::move(noise)),
        runs_(runs) {
    for (std::size_t j = 0; j < objects; ++j) truth.push_back(anywhere(0.6));
  }

  /// Moves the camera and returns the odometry.
  SE3d advance() {
    const SE3d next = OrbitScene::camera_at(++frame);
    const SE3d motion = camera.inverse() * next;
    camera = next;
    return motion * SE3d::exp(draw(q, stream));
  }

  /// Puts an object down in a cube of 0.6 m about the origin, in any orientation, at least 0.1 m
  /// from where it was.
  void put_down(std::size_t j) {
    const SE3d before = truth[j];
    do {
      truth[j] = anywhere(0.6);
    } while ((truth[j].translation() - before.translation()).norm() < 0.1);
  }

  /// A detection of an object by the noise model, each independent of the others, or of a run.
  SE3d detect(std::size_t j, bool may_run = true) {
    const NoiseComponent& first = noise_.components().front();
    if (runs_.length > 0 && in_run[j] == 0 && may_run &&
        stream.uniform() < runs_.part / ((1.0 - runs_.part) * runs_.length))
      in_run[j] = runs_.length;
    if (in_run[j] > 0) {
      --in_run[j];
      return erring(truth[j] * runs_.flip, first);
    }
    double chance = stream.uniform();
    for (const NoiseComponent& component : noise_.components()) {
      // Modes beyond the first come in runs alone.
      const bool is_mode = component.offset.log().norm() > 1e-9;
      if (chance < component.weight) return erring(truth[j], is_mode ? first : component);
      chance -= component.weight;
    }
    return runs_.length > 0 && stream.uniform() > 0.02 ? erring(truth[j], first)
                                                       : camera.inverse() * anywhere(1.0);
  }

  RandomStream stream;
  Matrix6d q;
  SE3d camera;
  std::vector<SE3d> truth;
  std::vector<int> in_run;
  int frame = 0;

 private:
  SE3d anywhere(double side) {
    Eigen::VectorXd white(4);
    stream.fill_normal(white);
    const Eigen::Quaterniond turn(white[0], white[1], white[2], white[3]);
    const Eigen::Vector3d place = point_in_cube(stream);
    return {SO3d::from_matrix(turn.normalized().toRotationMatrix()), side * place};
  }

  SE3d erring(const SE3d& object, const NoiseComponent& component) {
    const SE3d seen = camera.inverse() * object;
    const NoiseAtPose at = noise_at(component, seen);
    return at.axes * SE3d::exp(draw(at.covariance, stream)) * at.axes.inverse() * seen;
  }

  DetectorNoise noise_;
  Runs runs_;
};

}  // namespace posemix::testing
