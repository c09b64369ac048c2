// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
//
// Values of the types of the library that have no default, and of those whose default says nothing.
#pragma once

#include <cmath>
#include <numbers>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "public_headers.hpp"
#include "samples.hpp"

namespace posemix::arguments {

/// Rotations: with half a turn, and of a detection that is missing (NaN).
template <>
struct Samples<SO3d> {
  static std::size_t count() { return 4; }
  static SO3d make(std::size_t i) {
    const std::array<Eigen::Vector3d, 4> values{
        Eigen::Vector3d(0.1, -0.2, 0.3), Eigen::Vector3d::Zero(),
        Eigen::Vector3d(0, 0, std::numbers::pi), Eigen::Vector3d::Constant(kNaN)};
    return SO3d::exp(values[i]);
  }
};

template <>
struct Samples<SE3d> {
  static std::size_t count() { return 8; }
  static SE3d make(std::size_t i) {
    const std::array<Eigen::Vector3d, 8> positions{
        Eigen::Vector3d(0.1, 0.05, 0.8),  Eigen::Vector3d::Zero(),      Eigen::Vector3d(kNaN, 0, 1),
        Eigen::Vector3d(0, kInfinity, 1), Eigen::Vector3d(0, 0, 1e300), Eigen::Vector3d(0, 0, 1e9),
        Eigen::Vector3d(0.1, 0.05, 0.8),  Eigen::Vector3d(0, 0, 1)};
    return SE3d(i < 6 ? fine<SO3d>() : Samples<SO3d>::make(i - 4), positions[i]);
  }
};

template <int N>
struct Samples<Rn<N, double>> {
  using Vector = Eigen::Matrix<double, N, 1>;
  static std::size_t count() { return Samples<Vector>::count(); }
  static Rn<N, double> make(std::size_t i) { return Rn<N, double>(Samples<Vector>::make(i)); }
};

template <>
struct Samples<Eigen::Quaterniond> {
  static std::size_t count() { return 4; }
  static Eigen::Quaterniond make(std::size_t i) {
    const std::array<Eigen::Quaterniond, 4> values{
        Eigen::Quaterniond::Identity(), Eigen::Quaterniond(0, 0, 0, 0),
        Eigen::Quaterniond(kNaN, 0, 0, 1), Eigen::Quaterniond(1e300, 0, 1e300, 0)};
    return values[i];
  }
};

/// Two poses, so that tangent vectors of twelve numbers fit.
template <>
struct Samples<PoseStackd> {
  static std::size_t count() { return 4; }
  static PoseStackd make(std::size_t i) {
    const SE3d pose = fine<SE3d>();
    const std::array<std::vector<SE3d>, 4> values{std::vector{pose, pose}, std::vector<SE3d>{},
                                                  std::vector{pose},
                                                  std::vector{pose, Samples<SE3d>::make(2)}};
    return PoseStackd(values[i]);
  }
};

template <>
struct Samples<TwistMatrix<double>> {
  static std::size_t count() { return 2; }
  static TwistMatrix<double> make(std::size_t i) {
    return {Eigen::Matrix3d::Constant(i == 0 ? 0.1 : kNaN), Eigen::Matrix3d::Identity()};
  }
};

/// A density of positive definite covariance, from sharp to wide; of stacks also with one pose.
template <class G>
struct Samples<ConcentratedGaussian<G>> {
  static std::size_t count() { return 5; }
  static ConcentratedGaussian<G> make(std::size_t i) {
    G mean = fine<G>();
    if constexpr (std::same_as<G, PoseStackd>) {
      if (i == 4) mean = PoseStackd(std::vector{fine<SE3d>()});
    }
    const std::array variances{1e-4, 1e-24, 1e6, 1e300, 1e-4};
    return {mean, G::TangentMatrix::Identity(mean.dof(), mean.dof()) * variances[i]};
  }
};

template <class G>
struct Samples<ProjectedGaussian<G>> {
  static std::size_t count() { return 4; }
  static ProjectedGaussian<G> make(std::size_t i) {
    const std::array variances{1e-3, 1e-24, 1e6, 1e300};
    return {fine<G>(), G::TangentMatrix::Identity() * variances[i]};
  }
};

template <class D>
struct Samples<Component<D>> {
  static std::size_t count() { return Samples<D>::count() + Samples<double>::count() - 1; }
  static Component<D> make(std::size_t i) {
    const std::size_t densities = Samples<D>::count();
    return i < densities ? Component<D>{-0.7, Samples<D>::make(i)}
                         : Component<D>{Samples<double>::make(i - densities + 1), fine<D>()};
  }
};

template <class D>
struct Samples<Mixture<D>> {
  static std::size_t count() { return Samples<D>::count(); }
  static Mixture<D> make(std::size_t i) {
    if constexpr (std::same_as<D, ConcentratedGaussian<PoseStackd>>) {
      if (i == 4) return Mixture<D>({{0.0, Samples<D>::make(4)}});
    }
    return Mixture<D>({{std::log(0.25), fine<D>()}, {std::log(0.75), Samples<D>::make(i)}});
  }
};

template <>
struct Good<RandomStream> {
  static RandomStream make() { return RandomStream(1); }
};

template <>
struct Good<DetectorNoise> {
  static DetectorNoise make() { return default_detector_noise(); }
};

template <>
struct Good<NoiseComponent> {
  static NoiseComponent make() { return default_detector_noise().components().front(); }
};

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

template <>
struct Good<ErrorMixture> {
  static ErrorMixture make() {
    return ErrorMixture(
        Mixture<ErrorMixture::Gaussian>({{0.0, {Rnd<6>(), 0.01 * Matrix6d::Identity()}}}));
  }
};

template <>
struct Good<ObjectSensor> {
  static ObjectSensor make() { return {.noise = default_detector_noise()}; }
};

template <>
struct Good<ObjectModel> {
  static ObjectModel make() { return {.id = "cup"}; }
};

/// Sequences whose entries have names of their own: two, none, one, and one bad one beside the
/// first.
template <class T, auto Rename>
struct NamedSequence {
  static std::size_t count() { return 2 + Samples<T>::count(); }
  static std::vector<T> make(std::size_t i) {
    if (i == 1) return {};
    std::vector<T> values{fine<T>()};
    if (i != 2) values.push_back(Samples<T>::make(i < 3 ? 0 : i - 2));
    if (i == 0) Rename(values.back());
    return values;
  }
  static std::string word(std::size_t i) {
    return i == 0   ? "two"
           : i == 1 ? "none"
           : i == 2 ? "one"
                    : "two, of which one is " + word_of_sample<T>(i - 2);
  }
};

template <>
struct Samples<std::vector<ObjectModel>>
    : NamedSequence<ObjectModel, [](ObjectModel& model) { model.id = "mug"; }> {};

template <>
struct Samples<std::vector<BodyCamera>>
    : NamedSequence<BodyCamera, [](BodyCamera& camera) { camera.name = "cup"; }> {};

template <>
struct Good<ObservationComponent> {
  static ObservationComponent make() { return {.weight = 1.0, .pose = fine<SE3d>()}; }
};

template <>
struct Good<Observation> {
  static Observation make() {
    return {.object = "cup", .components = {Good<ObservationComponent>::make()}, .stamp_s = 1.0};
  }
};

template <>
struct Good<ObjectPrior> {
  static ObjectPrior make() { return {.world = fine<ConcentratedGaussian<SE3d>>()}; }
};

template <>
struct Good<KnownCamera> {
  static KnownCamera make() { return still_camera(fine<ConcentratedGaussian<SE3d>>()); }
};

template <>
struct Good<KnownFrame> {
  static KnownFrame make() { return {.pose = fine<SE3d>()}; }
};

template <>
struct Good<FrameInput> {
  static FrameInput make() { return {.dt = 0.1, .observations = {Good<Observation>::make()}}; }
};

template <>
struct Good<BodyCamera> {
  static BodyCamera make() { return {.name = "left"}; }
};

/// The camera and one object.
template <>
struct Good<MultiObjectFilter> {
  static MultiObjectFilter make() {
    static const MultiObjectFilter kept = [] {
      MultiObjectFilter filter(fine<ConcentratedGaussian<SE3d>>(),
                               {Good<ObjectSensor>::make(), Good<ObjectSensor>::make()}, {});
      filter.update(0, Good<Observation>::make());
      return filter;
    }();
    return kept;
  }
};

template <>
struct Good<MovingObjectFilter> {
  static MovingObjectFilter make() {
    static const MovingObjectFilter kept = [] {
      MovingObjectFilter filter(Good<ObjectSensor>::make(), calm_and_agile());
      filter.update(Good<Observation>::make(), Good<KnownCamera>::make());
      return filter;
    }();
    return kept;
  }
};

template <>
struct Good<MovingObjectSmoother> {
  static MovingObjectSmoother make() {
    static const MovingObjectSmoother kept = [] {
      MovingObjectSmoother smoother(Good<ObjectSensor>::make(), calm_and_agile());
      smoother.update(Good<Observation>::make(), Good<KnownCamera>::make());
      return smoother;
    }();
    return kept;
  }
};

template <>
struct Good<MovingObjects> {
  static MovingObjects make() { return MovingObjects({}, {"gripper"}); }
};

template <>
struct Good<GaussianSumFilter> {
  static GaussianSumFilter make() { return {fine<Posterior>(), {}}; }
};

template <>
struct Good<InstanceTracks> {
  static InstanceTracks make() {
    InstanceTracks tracks({}, {}, 3, 0.04);
    tracks.add(false, "cup");
    tracks.add(true, "mug");
    return tracks;
  }
};

template <>
struct Good<Existence> {
  static Existence make() { return Existence(ExistenceSettings{}); }
};

template <>
struct Good<TrackedObjects> {
  static TrackedObjects make() { return TrackedObjects(fine<std::vector<ObjectModel>>()); }
};

template <>
struct Good<MultiObjectSlam> {
  static MultiObjectSlam make() {
    static const MultiObjectSlam kept = [] {
      MultiObjectSlam slam(fine<PoseDensity>(), fine<std::vector<ObjectModel>>());
      slam.step(Good<FrameInput>::make());
      return slam;
    }();
    return kept;
  }
};

template <>
struct Good<GaussianSumSlam> {
  static GaussianSumSlam make() { return {fine<PoseDensity>(), fine<std::vector<ObjectModel>>()}; }
};

template <>
struct Good<ParticleSlam> {
  static ParticleSlam make() { return {fine<PoseDensity>(), fine<std::vector<ObjectModel>>()}; }
};

template <>
struct Good<ObjectSlam> {
  static ObjectSlam make() { return ObjectSlam(Good<MultiObjectSlam>::make()); }
};

template <>
struct Good<StampedSlam> {
  static StampedSlam make() {
    static const StampedSlam kept = [] {
      StampedSlam slam(fine<PoseDensity>(), fine<std::vector<ObjectModel>>());
      slam.add(Good<Observation>::make());
      return slam;
    }();
    return kept;
  }
};

template <>
struct Good<FixedLagSmoother> {
  static FixedLagSmoother make() {
    return {fine<PoseDensity>(), fine<std::vector<ObjectModel>>(), {}, {}};
  }
};

template <>
struct Good<LineReader> {
  static LineReader make() { return {"one 2 3\n\n4 5\n", "numbers.txt"}; }
};

template <>
struct Good<TomlDocument> {
  static TomlDocument make() {
    return TomlDocument::parse("a = 1\nb = [1.5, 2]\nc = \"word\"\n[cup]\nd = true\n",
                               "settings.toml");
  }
};

template <>
struct Good<TomlTable> {
  static TomlTable make() { return Good<TomlDocument>::make().root(); }
};

template <>
struct Good<SlamMethod> {
  static SlamMethod make() { return slam_methods().front(); }
};

template <>
struct Good<Sequence> {
  static Sequence make() {
    const std::optional<SE3d> pose = fine<SE3d>();
    return {.stamps = {0.0, 0.1, 0.2},
            .odometry = {},
            .camera_truth = {pose, pose, pose},
            .objects = {{"cup", {pose, {}, pose}, {pose, pose, pose}, {}}}};
  }
};

template <>
struct Good<SlamJob> {
  static SlamJob make() {
    SlamJob job{
        .sequence = Good<Sequence>::make(), .camera_prior = fine<PoseDensity>(), .settings = {}};
    job.name = "recording";
    job.method = "multi_object";
    job.models = {Good<ObjectModel>::make()};
    return job;
  }
};

template <>
struct Good<SlamRun> {
  static SlamRun make() {
    static const SlamRun kept = [] {
      const SlamJob job = Good<SlamJob>::make();
      return run(job.sequence, job.camera_prior, job.models, job.settings);
    }();
    return kept;
  }
};

template <>
struct Good<Metrics> {
  static Metrics make() {
    static const Metrics kept = evaluate(Good<SlamJob>::make(), Good<SlamRun>::make());
    return kept;
  }
};

template <>
struct Good<FrameEstimate> {
  static FrameEstimate make() { return Good<SlamRun>::make().frames.back(); }
};

template <>
struct Good<EstimateAtStamp> {
  static EstimateAtStamp make() { return {1.0, Good<FrameEstimate>::make()}; }
};

template <>
struct Good<StampedDensity> {
  static StampedDensity make() { return {1.0, fine<ConcentratedGaussian<SE3d>>()}; }
};

template <>
struct Good<MixtureFile> {
  static MixtureFile make() { return {{}, fine<ConcentratedPoses>(), {}}; }
};

template <>
struct Good<PosteriorFile> {
  static PosteriorFile make() {
    static const PosteriorFile kept = last_posterior(Good<SlamJob>::make(), Good<SlamRun>::make());
    return kept;
  }
};

template <>
struct Good<EstimateWithTruth> {
  static EstimateWithTruth make() { return {1.0, fine<PoseDensity>(), fine<SE3d>()}; }
};

template <>
struct Good<NoiseEmFit> {
  static NoiseEmFit make() {
    static const NoiseEmFit kept = [] {
      RandomStream stream(1);
      return fit_noise_components(fine<std::vector<NoiseObservation>>(), {}, stream);
    }();
    return kept;
  }
};

template <>
struct Samples<SymmetryGroup> {
  static std::size_t count() { return 3; }
  static SymmetryGroup make(std::size_t i) {
    if (i == 0) return SymmetryGroup();
    if (i == 1) return SymmetryGroup::turns(Eigen::Vector3d::UnitZ(), 4);
    return SymmetryGroup({}, {{Eigen::Vector3d::UnitZ(), Eigen::Vector3d::Zero()}});
  }
};

template <>
struct Good<ErrorReduction> {
  static ErrorReduction make() { return ErrorReduction(); }
};

template <>
struct Good<ConsistencySum> {
  static ConsistencySum make() { return ConsistencySum(); }
};

template <>
struct Good<PoseErrorSum> {
  static PoseErrorSum make() { return {}; }
};

template <>
struct Good<Stopwatch> {
  static Stopwatch make() { return {}; }
};

template <>
struct Good<StampedEstimate> {
  static StampedEstimate make() { return {1.0, fine<PoseDensity>()}; }
};

template <>
struct Good<FieldOfView> {
  static FieldOfView make() { return {}; }
};

template <class D>
struct Good<PairSelector<D>> {
  static PairSelector<D> make() {
    return PairSelector<D>(fine<std::vector<Component<D>>>(), PairRule::runnalls,
                           DistanceMetric::mahalanobis);
  }
};

template <>
struct Good<SimulatedPose> {
  static SimulatedPose make() { return {{100'000'000, 0, 800'000'000, 0, 0, 0, 1'000'000'000}}; }
};

/// Of two frames and one object.
template <>
struct Good<SimulationConfig> {
  static SimulationConfig make() {
    SimulationConfig config;
    config.path.frames = 2;
    config.objects.emplace_back();
    config.objects.back().id = "cup";
    return config;
  }
};

template <>
struct Good<SimulatedSequence> {
  static SimulatedSequence make() {
    static const SimulatedSequence kept = simulate(Good<SimulationConfig>::make(), 1);
    return kept;
  }
};

template <>
struct Good<TagMinimum> {
  static TagMinimum make() {
    return {.pose = fine<SE3d>(), .squared_error = 1.0, .information = Matrix6d::Identity()};
  }
};

template <>
struct Good<RotationDensity> {
  static RotationDensity make() { return RotationDensity(fine<ConcentratedGaussian<SO3d>>()); }
};

template <>
struct Good<gnomonic::ChartChange> {
  static gnomonic::ChartChange make() { return {fine<SO3d>(), Samples<SO3d>::make(1)}; }
};

template <class D>
struct Good<BatchEvaluator<D>> {
  static BatchEvaluator<D> make() { return BatchEvaluator<D>(fine<Mixture<D>>()); }
};

template <class G>
struct Samples<TangentGaussian<G>> {
  static std::size_t count() { return 1 + Samples<typename G::Tangent>::count(); }
  static TangentGaussian<G> make(std::size_t i) {
    const G anchor = fine<G>();
    return {anchor,
            i == 0 ? fine<typename G::Tangent>() : Samples<typename G::Tangent>::make(i - 1),
            0.01 * G::TangentMatrix::Identity(anchor.dof(), anchor.dof())};
  }
};

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
    static const NoiseComponent noise = Good<NoiseComponent>::make();
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

#include "samples_of_types.hpp"
