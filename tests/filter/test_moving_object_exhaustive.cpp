// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The posterior of the filter of one moving object against that of all histories: every sequence of
// motion models, jumps, and what the detector shows has a Gaussian of its own, none of which is
// ever merged or dropped. Only the groups, the motion models and the noise model are shared.
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "moving_object_scene.hpp"
#include "posemix/divergence/monte_carlo.hpp"
#include "posemix/mixture/log_weights.hpp"

namespace posemix {
namespace {

using testing::MovingScene;
using testing::plain_moving_settings;
using testing::pose;
using testing::SceneNoise;
using testing::sds;

using PoseMixture = Mixture<ConcentratedGaussian<SE3d>>;

using testing::kFramePeriod_s;

/// A history: the object, if its place is known, the place of a run, if the detector is in one, and
/// whether the detector is right.
struct History {
  double log_weight = 0.0;
  std::size_t model = 0;
  std::optional<MotionState> object = {};
  bool in_run = false;
  std::optional<MotionState> run = {};  ///< the place of the run once it was seen; it stands still
};

class AllHistories {
 public:
  AllHistories(DetectorNoise noise, MotionModels models, const MovingObjectSettings& settings)
      : noise_(std::move(noise)), models_(std::move(models)), settings_(settings) {
    for (std::size_t k = 0; k < models_.models.size(); ++k)
      histories_.push_back({.log_weight = std::log(models_.start[k]), .model = k});
  }

  void update(const SE3d& camera, const SE3d& seen, bool first) {
    if (!first) advance();
    draw_modes(first);
    camera_ = camera;
    seen_ = seen;
    const double clutter = noise_.clutter().weight;
    const double alone = settings_.isolated_clutter * clutter;
    std::vector<History> next;
    for (const History& history : histories_) {
      // A detection that stands alone.
      next.push_back(history);
      next.back().log_weight += std::log(alone) - log_space();
      if (!history.in_run) {
        see(history, history.object, std::log1p(-alone), false, next);
      } else {
        see(history, history.run, std::log1p(-alone), true, next);
      }
    }
    histories_ = std::move(next);
    std::vector<double> weights;
    for (const History& history : histories_) weights.push_back(history.log_weight);
    const double total = log_sum_exp(weights);
    for (History& history : histories_) history.log_weight -= total;
    std::erase_if(histories_, [](const History& history) { return history.log_weight < -18.0; });
  }

  std::size_t size() const { return histories_.size(); }

  PoseMixture object() const {
    std::vector<Component<ConcentratedGaussian<SE3d>>> components;
    for (const History& history : histories_) {
      // What is left out has less than a ten-thousandth of the weight.
      if (!history.object || history.log_weight < -13.0) continue;
      components.push_back(
          {history.log_weight,
           {history.object->pose, Matrix6d(history.object->covariance.topLeftCorner<6, 6>())}});
    }
    return PoseMixture(std::move(components));
  }

  double model_probability(std::size_t model) const {
    double sum = 0.0;
    for (const History& history : histories_)
      if (history.model == model) sum += std::exp(history.log_weight);
    return sum;
  }

 private:
  static double log_space() { return std::log(8.0 * std::numbers::pi * std::numbers::pi); }

  void advance() {
    std::vector<History> next;
    const double r01 = models_.rates(0, 1);
    const double r10 = models_.rates(1, 0);
    const double mixed = -std::expm1(-(r01 + r10) * kFramePeriod_s) / (r01 + r10);
    const double change[2] = {r01 * mixed, r10 * mixed};
    for (const History& history : histories_) {
      for (const std::size_t to : {std::size_t{0}, std::size_t{1}}) {
        History moved = history;
        moved.model = to;
        moved.log_weight += to == history.model ? std::log1p(-change[history.model])
                                                : std::log(change[history.model]);
        if (!history.object) {
          next.push_back(moved);
          continue;
        }
        const MotionState state =
            as_state_of(*history.object, models_.models[history.model], models_.models[to]);
        moved.object = predict(state, models_.models[to], kFramePeriod_s).state;
        const auto* put_down = std::get_if<PutDownMotion>(&models_.models[to]);
        const double stays = put_down ? std::exp(-put_down->jump_rate * kFramePeriod_s) : 1.0;
        if (put_down) {
          History gone = moved;
          gone.object.reset();
          gone.log_weight += std::log1p(-stays);
          next.push_back(gone);
        }
        moved.log_weight += std::log(stays);
        next.push_back(moved);
      }
    }
    histories_ = std::move(next);
  }

  void draw_modes(bool first) {
    const double clutter = noise_.clutter().weight;
    const double alone = settings_.isolated_clutter * clutter;
    const double in_run = (clutter - alone) / (1.0 - alone);
    const double time = noise_.dependence().mode_time_s;
    const double stay = first || time == 0.0 ? 0.0 : std::exp(-kFramePeriod_s / time);
    std::vector<History> next;
    for (const History& history : histories_) {
      const auto add = [&](double weight, bool run, bool keep) {
        if (weight == 0.0) return;
        next.push_back(history);
        next.back().log_weight += std::log(weight);
        next.back().in_run = run;
        if (!keep) next.back().run.reset();
      };
      add(stay, history.in_run, true);
      add((1.0 - stay) * in_run, true, false);
      add((1.0 - stay) * (1.0 - in_run), false, false);
    }
    histories_ = std::move(next);
  }

  Matrix6d world_noise(const Matrix6d& covariance, const SE3d& object) const {
    NoiseComponent component = noise_.components().front();
    component.covariance = covariance;
    const NoiseComponent along = along_camera(component, camera_.inverse() * object);
    const Matrix6d adjoint = SE3d(camera_.rotation(), object.translation()).adjoint();
    return adjoint * along.covariance * adjoint.transpose();
  }

  /// Mean and covariance move, the latter to the tangent space at the new mean.
  static MotionState moved(MotionState state, const Vector12d& by) {
    state.pose = SE3d::exp(Vector6d(by.head<6>())) * state.pose;
    state.twist += by.tail<6>();
    Eigen::Matrix<double, 12, 12> f = Eigen::Matrix<double, 12, 12>::Identity();
    f.topLeftCorner<6, 6>() = SE3d::left_jacobian(Vector6d(by.head<6>()));
    state.covariance = (f * state.covariance * f.transpose()).eval();
    return state;
  }

  /// The correction of a state whose mean has been moved by `way`.
  void correct(MotionState& state, const Matrix6d& covariance, const Vector6d& way) const {
    const Vector6d z = (camera_ * seen_ * state.pose.inverse()).log();
    const Eigen::Matrix<double, 12, 6> d = state.covariance.leftCols<6>();
    const Matrix6d s = Matrix6d(d.topRows<6>()) + world_noise(covariance, state.pose);
    const Eigen::Matrix<double, 12, 6> gain =
        Eigen::LLT<Matrix6d>(s).solve(d.transpose()).transpose();
    Vector12d by = gain * (z + way);
    by.head<6>() -= way;
    state.covariance -= gain * d.transpose();
    symmetrize(state.covariance);
    state = moved(state, by);
  }

  /// The detection shows the object, or the place of a run, under every component of the noise.
  void see(const History& history, const std::optional<MotionState>& place, double log_weight,
           bool of_run, std::vector<History>& next) const {
    double right = 0.0;
    for (const NoiseComponent& component : noise_.components()) right += component.weight;
    for (const NoiseComponent& component : noise_.components()) {
      History child = history;
      child.log_weight += log_weight + std::log(component.weight / right);
      MotionState state;
      if (!place) {
        child.log_weight -= log_space();
        state.pose = camera_ * seen_;
        state.covariance.topLeftCorner<6, 6>() = world_noise(component.covariance, state.pose);
        if (const auto* velocity =
                std::get_if<ConstantVelocityMotion>(&models_.models[child.model]))
          if (!of_run)
            state.covariance.bottomRightCorner<6, 6>() =
                velocity->start_sds.cwiseAbs2().asDiagonal();
      } else {
        state = *place;
        const Vector6d z = (camera_ * seen_ * state.pose.inverse()).log();
        const Matrix6d s = Matrix6d(state.covariance.topLeftCorner<6, 6>()) +
                           world_noise(component.covariance, state.pose);
        child.log_weight += log_normal(Eigen::LLT<Matrix6d>(s), z);
        // Linearised where a first correction takes the pose.
        const Vector6d way = state.covariance.topLeftCorner<6, 6>() * s.inverse() * z;
        state = moved(state, (Vector12d() << way, Vector6d::Zero()).finished());
        correct(state, component.covariance, way);
      }
      (of_run ? child.run : child.object) = state;
      next.push_back(child);
    }
  }

  DetectorNoise noise_;
  MotionModels models_;
  MovingObjectSettings settings_;
  SE3d camera_;
  SE3d seen_;
  std::vector<History> histories_;
};

double mixture_kl(const PoseMixture& p, const PoseMixture& q) {
  RandomStream stream(3, 1);
  return kl_monte_carlo(p, q, stream, {.samples = 500}).value;
}

struct Loss {
  double kl = 0.0;
  double model = 0.0;  ///< largest error of the probability of a model
  std::size_t histories = 0;
};

/// Mean over seeds after the last detection of a short sequence in which the object is still, and
/// detections alternate between its place and others as `show` says.
template <class Show>
Loss mean_loss(const DetectorNoise& noise, const MotionModels& models, int seeds, int frames,
               const Show& show) {
  MovingObjectSettings settings = plain_moving_settings();
  settings.turned_clutter = 0.0;
  settings.recurring_clutter = 0.0;
  settings.lost_rate = 0.0;
  Loss result;
  for (int seed = 0; seed < seeds; ++seed) {
    MovingScene scene(static_cast<std::uint64_t>(seed), noise);
    MovingObjectFilter filter({noise}, models, settings);
    AllHistories exact(noise, models, settings);
    for (int k = 0; k < frames; ++k) {
      if (k > 0) scene.time_s += kFramePeriod_s;
      const SE3d seen = show(scene, k);
      filter.update(scene.observed(seen), exact_camera(scene.camera));
      exact.update(scene.camera, seen, k == 0);
      result.histories = std::max(result.histories, exact.size());
      if (k + 1 == frames) result.kl += mixture_kl(exact.object(), filter.object_mixture()) / seeds;
      result.model = std::max(result.model,
                              std::abs(exact.model_probability(1) - filter.estimate().models[1]));
    }
  }
  ::testing::Test::RecordProperty("loss", fmt::format("KL {:.4f}, model {:.4f}, histories {}",
                                                      result.kl, result.model, result.histories));
  return result;
}

MotionModels still_or_moving() {
  ConstantVelocityMotion moving{sds(0.5, 0.1), MotionFrame::object, sds(0.5, 0.1)};
  moving.break_rate = 0.0;
  return {.models = {PutDownMotion{.jump_rate = 0.05}, moving},
          .rates = (Eigen::MatrixXd(2, 2) << 0.0, 0.5, 0.5, 0.0).finished(),
          .start = {0.7, 0.3}};
}

SE3d shown_elsewhere(MovingScene& scene, int k) {
  const SE3d elsewhere = scene.truth * pose(0.5, 1.0, 0.4, 0.2, 0.1, 0.1);
  return k < 2 ? scene.inlier()
               : scene.erring(elsewhere, NoiseComponent{.covariance = SceneNoise::inlier(),
                                                        .frame = NoiseFrame::ray});
}

// With one model and one component of the noise nothing is mixed: jumps, runs and detections that
// stand alone have their exact weights.
TEST(MovingObjectExhaustive, IsExactForOneModelAndOneComponent) {
  MotionModels models = still_or_moving();
  models.rates *= 1e-12;
  models.start = {1.0 - 1e-12, 1e-12};
  const Loss loss = mean_loss(SceneNoise{.gross = 0.0, .clutter = 0.1, .mode_time_s = 1.0}.noise(),
                              models, 4, 6, shown_elsewhere);
  EXPECT_LT(loss.kl, 1e-3);
  EXPECT_LT(loss.model, 1e-6);
}

// Every detection shows the object, with inliers and gross errors.
TEST(MovingObjectExhaustive, LosesLittleByMixingModels) {
  const Loss loss = mean_loss(SceneNoise{.gross = 0.1, .clutter = 0.05}.noise(), still_or_moving(),
                              4, 5, [](MovingScene& scene, int) { return scene.inlier(); });
  EXPECT_GT(loss.histories, 100U);
  EXPECT_LT(loss.kl, 0.2);
  EXPECT_LT(loss.model, 0.2);
}

// The object moves between the detections.
TEST(MovingObjectExhaustive, LosesLittleWhileTheObjectMoves) {
  const Loss loss = mean_loss(SceneNoise{.gross = 0.1, .clutter = 0.05}.noise(), still_or_moving(),
                              4, 5, [](MovingScene& scene, int k) {
                                if (k == 0) scene.twist << 0.4, -0.5, 0.3, 0.1, 0.1, -0.05;
                                const double now = scene.time_s;
                                if (k > 0)
                                  scene.advance(ConstantVelocityMotion{sds(0, 0)}, kFramePeriod_s);
                                scene.time_s = now;
                                return scene.inlier();
                              });
  EXPECT_LT(loss.kl, 0.2);
  EXPECT_LT(loss.model, 0.2);
}

// Two detections of another place, alone or the beginning of a run, or the object was put there.
TEST(MovingObjectExhaustive, LosesLittleWhereAJumpAndARunAreBothProbable) {
  const Loss loss = mean_loss(SceneNoise{.gross = 0.0, .clutter = 0.1, .mode_time_s = 1.0}.noise(),
                              still_or_moving(), 4, 5, shown_elsewhere);
  EXPECT_LT(loss.kl, 0.2);
  EXPECT_LT(loss.model, 0.2);
}

}  // namespace
}  // namespace posemix
