// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
//
// Values of object SLAM, recordings and results, and of files.
#pragma once

#include "filters.hpp"

namespace posemix::arguments {

inline ObjectModel good(Type<ObjectModel>) { return {.id = "cup"}; }

/// Sequences whose entries have names of their own: two, none, one, and one bad one beside the
/// first.
template <class T, auto Name>
struct NamedSequence {
  static std::size_t count() { return 2 + Samples<T>::count(); }
  static std::vector<T> make(std::size_t i) {
    if (i == 1) return {};
    std::vector<T> values{fine<T>()};
    if (i != 2) values.push_back(Samples<T>::make(i < 3 ? 0 : i - 2));
    if (i == 0) values.back().*Name = "mug";
    return values;
  }
  static std::string word(std::size_t i) {
    return i == 0   ? "two"
           : i == 1 ? "none"
           : i == 2 ? "one"
                    : "two, of which one is " + word_of_sample<T>(i - 2);
  }
};

/// Sequences of stamps that increase: two, none, one, and one bad one behind the first.
template <class T, auto Stamp>
struct StampedSequence {
  static std::size_t count() { return 2 + Samples<T>::count(); }
  static std::vector<T> make(std::size_t i) {
    if (i == 1) return {};
    std::vector<T> values{fine<T>()};
    values.front().*Stamp = 0.0;
    if (i != 2) values.push_back(Samples<T>::make(i < 3 ? 0 : i - 2));
    return values;
  }
  static std::string word(std::size_t i) {
    return i < 3 ? std::array{"two", "none", "one"}[i]
                 : "two, of which one is " + word_of_sample<T>(i - 2);
  }
};

template <>
struct Samples<std::vector<EstimateWithTruth>>
    : StampedSequence<EstimateWithTruth, &EstimateWithTruth::stamp_s> {};

template <>
struct Samples<std::vector<StampedEstimate>>
    : StampedSequence<StampedEstimate, &StampedEstimate::stamp_s> {};

template <>
struct Samples<std::vector<StampedTruth>> : StampedSequence<StampedTruth, &StampedTruth::stamp_s> {
};

template <>
struct Samples<std::vector<ObjectModel>> : NamedSequence<ObjectModel, &ObjectModel::id> {};

template <>
struct Samples<std::vector<BodyCamera>> : NamedSequence<BodyCamera, &BodyCamera::name> {};

inline FrameInput good(Type<FrameInput>) {
  return {.dt = 0.1, .observations = {good<Observation>()}};
}

inline BodyCamera good(Type<BodyCamera>) {
  return {.name = "left", .covariance = 1e-4 * Matrix6d::Identity()};
}

/// Two, of which the second was seen.
inline MovingObjects good(Type<MovingObjects>) {
  return once([] {
    MovingObjects objects({}, {"gripper"});
    const ObjectModel hand{.id = "hand", .motion = calm_and_agile()};
    objects.add(0, hand);
    objects.add(1, hand);
    objects.update(1, good<Observation>(), good<KnownCamera>());
    return objects;
  });
}

inline InstanceTracks good(Type<InstanceTracks>) {
  InstanceTracks tracks({}, {}, 3, 0.04);
  tracks.add(false, "cup");
  tracks.add(true, "mug");
  return tracks;
}

/// One for each of two objects.
template <>
struct Samples<std::vector<std::optional<std::size_t>>> {
  static std::size_t count() { return 4; }
  static std::vector<std::optional<std::size_t>> make(std::size_t i) {
    if (i == 1) return {};
    return {i == 2 ? 77U : 0U, i == 3 ? std::optional<std::size_t>(0) : std::nullopt};
  }
};

/// Two objects and two that are none, and one bad one beside them.
template <>
struct Samples<std::vector<InstanceCounts>> {
  static std::size_t count() { return 1 + Samples<InstanceCounts>::count(); }
  static std::vector<InstanceCounts> make(std::size_t i) {
    std::vector<InstanceCounts> counts{
        {9.0, 8.0, true}, {9.0, 7.0, true}, {9.0, 1.0, false}, {9.0, 2.0, false}};
    if (i > 0) counts.push_back(Samples<InstanceCounts>::make(i - 1));
    return counts;
  }
};

/// Of the two instances.
template <>
struct Samples<std::vector<TrackedPlace>> {
  static std::size_t count() { return 2 + Samples<TrackedPlace>::count(); }
  static std::vector<TrackedPlace> make(std::size_t i) {
    if (i == 1) return {};
    return {fine<TrackedPlace>(), Samples<TrackedPlace>::make(i == 0 ? 0 : i - 2)};
  }
};

inline Existence good(Type<Existence>) { return Existence(ExistenceSettings{}); }

inline TrackedObjects good(Type<TrackedObjects>) {
  return TrackedObjects(fine<std::vector<ObjectModel>>());
}

inline MultiObjectSlam good(Type<MultiObjectSlam>) {
  return once([] {
    MultiObjectSlam slam(fine<PoseDensity>(), fine<std::vector<ObjectModel>>());
    slam.step(good<FrameInput>());
    return slam;
  });
}

inline GaussianSumSlam good(Type<GaussianSumSlam>) {
  return {fine<PoseDensity>(), fine<std::vector<ObjectModel>>()};
}

inline ParticleSlam good(Type<ParticleSlam>) {
  return {fine<PoseDensity>(), fine<std::vector<ObjectModel>>()};
}

inline ObjectSlam good(Type<ObjectSlam>) { return ObjectSlam(good<MultiObjectSlam>()); }

inline StampedSlam good(Type<StampedSlam>) {
  return once([] {
    StampedSlam slam(fine<PoseDensity>(), fine<std::vector<ObjectModel>>());
    slam.add(good<Observation>());
    return slam;
  });
}

inline FixedLagSmoother good(Type<FixedLagSmoother>) {
  return {fine<PoseDensity>(), fine<std::vector<ObjectModel>>(), {}, {}};
}

inline LineReader good(Type<LineReader>) { return {"one 2 3\n\n4 5\n", "numbers.txt"}; }

inline TomlDocument good(Type<TomlDocument>) {
  return TomlDocument::parse("a = 1\nb = [1.5, 2]\nc = \"word\"\n[cup]\nd = true\n",
                             "settings.toml");
}

inline TomlTable good(Type<TomlTable>) { return good<TomlDocument>().root(); }

inline SlamMethod good(Type<SlamMethod>) { return slam_methods().front(); }

inline Sequence good(Type<Sequence>) {
  const std::optional<SE3d> pose = fine<SE3d>();
  return {.stamps = {0.0, 0.1, 0.2},
          .odometry = {},
          .camera_truth = {pose, pose, pose},
          .objects = {{"cup", {pose, {}, pose}, {pose, pose, pose}, {}}}};
}

inline SlamJob good(Type<SlamJob>) {
  SlamJob job{.sequence = good<Sequence>(), .camera_prior = fine<PoseDensity>(), .settings = {}};
  job.name = "recording";
  job.method = "multi_object";
  job.models = {good<ObjectModel>()};
  return job;
}

inline SlamRun good(Type<SlamRun>) {
  return once([] {
    const SlamJob job = good<SlamJob>();
    return run(job.sequence, job.camera_prior, job.models, job.settings);
  });
}

inline Metrics good(Type<Metrics>) {
  return once([] { return evaluate(good<SlamJob>(), good<SlamRun>()); });
}

inline FrameEstimate good(Type<FrameEstimate>) { return good<SlamRun>().frames.back(); }

inline EstimateAtStamp good(Type<EstimateAtStamp>) { return {1.0, good<FrameEstimate>()}; }

inline StampedDensity good(Type<StampedDensity>) {
  return {1.0, fine<ConcentratedGaussian<SE3d>>()};
}

inline MixtureFile good(Type<MixtureFile>) {
  return {{"camera", "cup"}, fine<ConcentratedPoses>(), {}};
}

inline PosteriorFile good(Type<PosteriorFile>) {
  return once([] { return last_posterior(good<SlamJob>(), good<SlamRun>()); });
}

inline EstimateWithTruth good(Type<EstimateWithTruth>) {
  return {1.0, fine<PoseDensity>(), fine<SE3d>()};
}

inline ErrorReduction good(Type<ErrorReduction>) { return ErrorReduction(); }

inline ConsistencySum good(Type<ConsistencySum>) { return ConsistencySum(); }

inline PoseErrorSum good(Type<PoseErrorSum>) { return {}; }

inline StampedEstimate good(Type<StampedEstimate>) { return {1.0, fine<PoseDensity>()}; }

inline FieldOfView good(Type<FieldOfView>) { return {}; }

inline SimulatedPose good(Type<SimulatedPose>) {
  return {{100'000'000, 0, 800'000'000, 0, 0, 0, 1'000'000'000}};
}

/// Of two frames and one object.
inline SimulationConfig good(Type<SimulationConfig>) {
  SimulationConfig config;
  config.path.frames = 2;
  config.objects.emplace_back();
  config.objects.back().id = "cup";
  return config;
}

inline SimulatedSequence good(Type<SimulatedSequence>) {
  return once([] { return simulate(good<SimulationConfig>(), 1); });
}

inline TagMinimum good(Type<TagMinimum>) {
  return {.pose = fine<SE3d>(), .squared_error = 1.0, .information = Matrix6d::Identity()};
}

inline SimulationFile good(Type<SimulationFile>) { return {.config = good<SimulationConfig>()}; }

inline ConsistencyReport good(Type<ConsistencyReport>) {
  return once([] { return consistency_of(fine<std::vector<EstimateWithTruth>>()); });
}

inline NamedConsistency good(Type<NamedConsistency>) {
  return {"camera", good<ConsistencyReport>()};
}

inline ConsistencyResults good(Type<ConsistencyResults>) {
  return {.title = "run", .poses = {good<NamedConsistency>()}};
}

/// Straight on, a centimetre in a tenth of a second.
inline OdometryRecording good(Type<OdometryRecording>) {
  OdometryRecording recording{.name = "straight"};
  for (int frame = 0; frame < 30; ++frame) {
    const double x = 0.01 * frame;
    recording.stamps.push_back(0.1 * frame);
    recording.odometry.emplace_back(SE3d(SO3d(), {x, 1e-4 * (frame % 3), 0.0}));
    recording.camera_truth.emplace_back(SE3d(SO3d(), {x, 0.0, 0.0}));
  }
  return recording;
}

inline OdometryNoise good(Type<OdometryNoise>) {
  OdometryNoise noise{};
  noise.windows.emplace_back();
  return noise;
}

}  // namespace posemix::arguments
