// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
//
// Values of detectors, observations and filters.
#pragma once

#include "densities.hpp"

namespace posemix::arguments {

inline DetectorNoise good(Type<DetectorNoise>) { return default_detector_noise(); }

inline NoiseComponent good(Type<NoiseComponent>) {
  return default_detector_noise().components().front();
}

/// As many as rows of a matrix of unknown size.
template <>
struct Samples<std::vector<bool>> {
  static std::size_t count() { return 3; }
  static std::vector<bool> make(std::size_t i) {
    std::vector<bool> values(i == 0 ? 12 : i - 1);
    for (std::size_t k = 0; k < values.size(); k += 2) values[k] = true;
    return values;
  }
};

inline UpdateResult good(Type<UpdateResult>) {
  return {.posterior = fine<Hypothesis>(), .log_likelihood = -1.0, .ok = true};
}

inline ErrorMixture good(Type<ErrorMixture>) {
  return ErrorMixture(
      Mixture<ErrorMixture::Gaussian>({{0.0, {Rnd<6>(), 0.01 * Matrix6d::Identity()}}}));
}

inline ObjectSensor good(Type<ObjectSensor>) { return {.noise = default_detector_noise()}; }

inline ObservationComponent good(Type<ObservationComponent>) {
  return {.weight = 1.0, .pose = fine<SE3d>()};
}

inline Observation good(Type<Observation>) {
  return {.object = "cup", .components = {good<ObservationComponent>()}, .stamp_s = 1.0};
}

inline ObjectPrior good(Type<ObjectPrior>) { return {.world = fine<ConcentratedGaussian<SE3d>>()}; }

inline KnownCamera good(Type<KnownCamera>) {
  return still_camera(fine<ConcentratedGaussian<SE3d>>());
}

inline KnownFrame good(Type<KnownFrame>) { return {.pose = fine<SE3d>()}; }

/// The camera and one object.
inline MultiObjectFilter good(Type<MultiObjectFilter>) {
  return once([] {
    MultiObjectFilter filter(fine<ConcentratedGaussian<SE3d>>(),
                             {good<ObjectSensor>(), good<ObjectSensor>()}, {});
    filter.update(0, good<Observation>());
    return filter;
  });
}

inline MovingObjectFilter good(Type<MovingObjectFilter>) {
  return once([] {
    MovingObjectFilter filter(good<ObjectSensor>(), calm_and_agile());
    filter.update(good<Observation>(), good<KnownCamera>());
    return filter;
  });
}

inline MovingObjectSmoother good(Type<MovingObjectSmoother>) {
  return once([] {
    MovingObjectSmoother smoother(good<ObjectSensor>(), calm_and_agile());
    smoother.update(good<Observation>(), good<KnownCamera>());
    return smoother;
  });
}

inline GaussianSumFilter good(Type<GaussianSumFilter>) { return {fine<Posterior>(), {}}; }

inline MovingObjectEstimate good(Type<MovingObjectEstimate>) {
  return good<MovingObjectFilter>().estimate();
}

inline MovingObjectStep good(Type<MovingObjectStep>) {
  return {.observation = good<Observation>(), .camera = good<KnownCamera>()};
}

/// Twelve detections, and none.
template <>
struct Samples<NoiseTrack> {
  static std::size_t count() { return 2; }
  static NoiseTrack make(std::size_t i) {
    return NoiseTrack(i == 0 ? 12 : 0, fine<NoiseObservation>());
  }
};

inline NoiseEmFit good(Type<NoiseEmFit>) {
  return once([] {
    RandomStream stream(1);
    return fit_noise_components(fine<std::vector<NoiseObservation>>(), {}, stream);
  });
}

template <>
struct Samples<SymmetryGroup> {
  static std::size_t count() { return 3; }
  static SymmetryGroup make(std::size_t i) {
    if (i == 0) return SymmetryGroup();
    if (i == 1) return SymmetryGroup::turns(Eigen::Vector3d::UnitZ(), 4);
    return SymmetryGroup({}, {{Eigen::Vector3d::UnitZ(), Eigen::Vector3d::Zero()}});
  }
};

inline ToleranceBox good(Type<ToleranceBox>) {
  return {.rotation = Eigen::Vector3d::Constant(0.1),
          .translation = Eigen::Vector3d::Constant(0.01)};
}

/// Of outcomes that are not certain, with a wall that is not hard: all of its numbers are finite.
inline ToleranceRegion good(Type<ToleranceRegion>) {
  return {.half_width = Vector6d::Constant(0.1),
          .softness = 0.5,
          .success_inside = 0.9,
          .success_outside = 0.1};
}

inline PoseConsensus good(Type<PoseConsensus>) {
  return {.truths = fine<std::vector<SE3d>>(), .weights = Eigen::VectorXd::Constant(3, 1.0 / 3.0)};
}

inline LogisticModel good(Type<LogisticModel>) { return {Eigen::VectorXd::Ones(12), 0.0}; }

inline ConsensusMember good(Type<ConsensusMember>) {
  static const ErrorMixture errors = good<ErrorMixture>();
  return {fine<SE3d>(), &errors};
}

/// With noise that lives on.
template <>
struct Samples<Detection> {
  static std::size_t count() { return Samples<std::size_t>::count() + Samples<SE3d>::count(); }
  static Detection make(std::size_t i) {
    static const DetectorNoise noise = default_detector_noise();
    const std::size_t objects = Samples<std::size_t>::count();
    return {i < objects ? Samples<std::size_t>::make(i) : 1,
            i < objects ? fine<SE3d>() : Samples<SE3d>::make(i - objects), &noise};
  }
};

/// One of each object, of which there is one.
template <>
struct Samples<std::vector<Detection>> {
  static std::size_t count() { return 1 + Samples<Detection>::count(); }
  static std::vector<Detection> make(std::size_t i) {
    if (i == 1) return {};
    return {Samples<Detection>::make(i == 0 ? 0 : i - 1)};
  }
};

template <>
struct Samples<const NoiseComponent*> {
  static std::size_t count() { return 1; }
  static const NoiseComponent* make(std::size_t) {
    static const NoiseComponent noise = good<NoiseComponent>();
    return &noise;
  }
};

template <>
struct Samples<std::vector<const NoiseComponent*>> {
  static std::size_t count() { return 2; }
  static std::vector<const NoiseComponent*> make(std::size_t i) {
    return std::vector<const NoiseComponent*>(i == 0 ? 1 : 0,
                                              Samples<const NoiseComponent*>::make(0));
  }
};

}  // namespace posemix::arguments
