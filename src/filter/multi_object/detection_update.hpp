// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <optional>
#include <vector>

#include "base/cholesky6.hpp"
#include "base/kept_memory.hpp"
#include "posemix/base/linear.hpp"
#include "posemix/detector/object_sensor.hpp"
#include "posemix/detector/observation.hpp"
#include "posemix/filter/multi_object_filter.hpp"
#include "posemix/lie/lie.hpp"

/// The part of the state that a detection depends on, and its update.
namespace posemix::internal {

using Vector18d = Eigen::Matrix<double, 18, 1>;
using Matrix18d = Eigen::Matrix<double, 18, 18>;

using Matrix18x6d = Eigen::Matrix<double, 18, 6>;

/// Rows of the camera, the object and the slow error in the state of a detection.
inline constexpr Eigen::Index kCameraRow = 0;
inline constexpr Eigen::Index kObjectRow = 6;
inline constexpr Eigen::Index kSlowRow = 12;

/// The Gaussian of [xi_C; xi_O; b]: camera and object, both perturbed on the left in the world
/// frame, and the detector's slow error b, in the frame and the units of its noise.
struct DetectionState {
  SE3d camera;  ///< the one that sees the object; its error is that of the body that carries it
  SE3d object;
  Vector6d slow = Vector6d::Zero();  ///< mean of b
  Matrix18d covariance = Matrix18d::Zero();
  bool has_slow = true;  ///< false: the rows of b are zero

  SE3d camera_object() const { return camera.inverse() * object; }
  /// Covariance of xi_O - xi_C in the world frame.
  Matrix6d difference() const;
  /// H P H^T with H = [-I I A].
  Matrix6d seen_covariance(const Matrix6d& slow_map) const;
  /// G of eq. (33).
  Matrix6d common_part(const Matrix6d& noise) const;
};

/// P H^T with H = [-I I A].
Matrix18x6d times_ht(const Matrix18d& p, const Matrix6d& slow_map);

/// Moments of the state, in the tangent spaces at its means before the detection; those of b are
/// differences from its mean before.
struct DetectionMoments {
  Vector18d mean = Vector18d::Zero();
  Matrix18d covariance = Matrix18d::Zero();
};

/// Moments of the camera and of the cameras' poses on it that are estimated, [xi_C; xi_E ...], with
/// the extrinsics' perturbations on the left, in the frame of the body (docs/many-objects.md,
/// "Cameras of a rig"). Empty where all cameras are exact.
struct RigMoments {
  Eigen::VectorXd mean;
  Eigen::MatrixXd covariance;
  /// Made when it is first asked for; the covariance stays as it is from then on.
  mutable std::optional<Eigen::LLT<Eigen::MatrixXd>> made = {};

  bool empty() const { return covariance.size() == 0; }
  /// The Cholesky factor of the covariance, which all that follows the rig shares.
  const Eigen::LLT<Eigen::MatrixXd>& factor() const {
    if (!made) made.emplace(covariance);
    return *made;
  }
};

/// Moments of the camera, and of the rig where it has extrinsics, in the tangent space at the mean
/// before a detection.
struct CameraMoments {
  Vector6d mean = Vector6d::Zero();
  Matrix6d covariance = Matrix6d::Zero();
  RigMoments rig = {};
};

/// An observation as the filter weighs it.
struct WeighedObservation {
  /// With the part of their weights that no earlier observation told. The weights sum to one.
  KeptVector<ObservationComponent> components;
  double clutter = 0.0;        ///< probability that the observation is of something else
  double object_weight = 1.0;  ///< factor on the weights of the noise's components
  double log_clutter = 0.0;    ///< log weight times density of clutter [nats]
  double log_absence = 0.0;    ///< the same, for the case that no detection was the object
  ObservationSource source = {};
  double clarity = 0.0;  ///< log ratio of the two largest weights as they were given
};

/// `share` is the part of the weights that no earlier observation told: they count with that
/// exponent. The observation must be valid.
WeighedObservation weigh(const Observation& observation, const ObjectSensor& sensor, double share,
                         const ObservationSource& source);

/// One component of an observation under one noise component: eq. (2) of docs/many-objects.md. All
/// values are in the world frame.
struct Innovation {
  double weight = 0.0;  ///< probability of the component given the detection, a_c
  Vector6d residual;    ///< z = Log(T_C Y offset^-1 T_O^-1) - A b
  Matrix6d noise;     ///< covariance of the white error and of unobserved directions, R, times the
                      ///< run length of the component
  Matrix6d slow_map;  ///< A, from the frame and the units of the noise to the world
  Matrix6d covariance;  ///< S = H P H^T + R with H = [-I I A]
  SE3d axes;            ///< the axes in which the noise is stated, in the world
  /// Of the white error along these axes [rad, m], without unobserved directions.
  Matrix6d white;
};

/// A component of an observation under one of the noise, without its weight.
Innovation innovation_of(const DetectionState& state, const ObservationComponent& observed,
                         const NoiseComponent& component, const ObjectSensor& sensor);

/// Covariance of one component's white error in the world frame, without the directions that a
/// symmetry leaves unobserved, for the observation `seen`.
Matrix6d white_covariance(const DetectionState& state, const ObservationComponent& seen,
                          const NoiseComponent& component, const ObjectSensor& sensor);

/// A, the map from b to the world frame, for a detection of the mode of `component`.
Matrix6d slow_error_map(const DetectionState& state, const NoiseComponent& component,
                        const ObjectSensor& sensor);

/// An observation of an object under all components of the noise and clutter, eq. (3). The
/// probabilities are not numbers where the evidence is zero.
struct Explanation {
  /// For every component of the observation, one per component of the noise.
  KeptVector<Innovation> innovations;
  std::size_t noise_components = 1;
  double clutter_probability = 0.0;
  double log_evidence = 0.0;  ///< log sum_c exp e_c, clutter included [nats]
  /// The part of it that the weights of the observation's components tell: zero for equal ones.
  double log_weights = 0.0;
  /// Of every component of the observation, the least squared Mahalanobis distance over those of
  /// the noise.
  KeptVector<double> squared_distances;

  /// The most probable innovation under the first component of the noise.
  const Innovation& inlier() const;
  /// Probability of a component of the observation.
  double probability_of(std::size_t component) const;
  /// Probability of the first component of the noise.
  double inlier_probability() const;
};

Explanation explain(const DetectionState& state, const WeighedObservation& observation,
                    const ObjectSensor& sensor);

/// Eq. (34): every innovation with a weight is linearised where it takes camera and object.
void linearise_there(const DetectionState& state, const WeighedObservation& observation,
                     const ObjectSensor& sensor, Explanation& explanation);

/// The update of one hypothesis by a detection, eq. (4).
struct DetectionUpdate {
  Explanation explanation;
  DetectionMoments posterior;
  /// Moments of [xi_C; xi_E ...; xi_O; b] after the detection; empty where all cameras are exact.
  RigMoments with_extrinsics = {};

  /// Moments of the camera and of the extrinsics after the detection.
  CameraMoments camera() const;
  /// Cov([xi_O; b], [xi_E ...]) after the detection.
  Eigen::Matrix<double, 12, Eigen::Dynamic> extrinsics() const;

  double log_evidence() const { return explanation.log_evidence; }
  /// Probability of the first component.
  double inlier_probability() const { return explanation.inlier_probability(); }
  /// z^T S^-1 z of the first component of the noise; none where S is numerically not positive
  /// definite.
  std::optional<double> nis() const;
  /// Residual of the first component of the noise in standard deviations, along its axes.
  Vector6d white_residual() const;
};

/// By hypothesis.
using DetectionUpdates = KeptVector<DetectionUpdate>;

/// Factors on the gain: of the camera and all other objects, and of the slow error of the object
/// that is detected.
struct GainFactors {
  double camera = 1.0;
  double slow = 1.0;
  /// False where a part of the correction may be left out, or taken back by eq. (10): the poses do
  /// not go where the detection takes them, and it is not linearised there.
  bool are_whole = true;
};

/// Updates a state by an observation with this explanation.
DetectionUpdate moved_by(Explanation explanation, const DetectionState& state,
                         const GainFactors& factors);
/// The same with extrinsics, as observe().
DetectionUpdate moved_by(Explanation explanation, const Eigen::MatrixXd& seen_by,
                         const Eigen::MatrixXd& covariance, const GainFactors& factors);

/// Updates a state by an observation with the noise, clutter and symmetries of `sensor`.
DetectionUpdate observe(const DetectionState& state, const WeighedObservation& observation,
                        const ObjectSensor& sensor, const GainFactors& factors);

/// The same with extrinsics: `state` has the camera that sees the object, whose error is `seen_by`
/// times [xi_C; xi_E ...], and `covariance` is that of [xi_C; xi_E ...; xi_O; b].
DetectionUpdate observe(const DetectionState& state, const Eigen::MatrixXd& seen_by,
                        const Eigen::MatrixXd& covariance, const WeighedObservation& observation,
                        const ObjectSensor& sensor, const GainFactors& factors);

/// The update of a Gaussian over any coordinates by a detection: eq. (4) for all of them at once.
///
/// With P H^T = D_c, S_c = L_c L_c^T and a factor g on the gain of every row, K_c = diag(g) D_c
/// S_c^-1, the component c has the mean K_c z_c, and by Joseph's form the covariance
/// P_ik - (g_i + g_k - g_i g_k) (D_c S_c^-1 D_c^T)_ik. Clutter moves nothing.
template <class Vector, class Matrix>
class GaussianUpdate {
 public:
  GaussianUpdate(const Vector& gain, Vector& mean, Matrix& covariance)
      : gain_(gain),
        mean_(mean),
        covariance_(covariance),
        second_(Matrix::Zero(covariance.rows(), covariance.cols())),
        reduction_(second_) {
    mean_.setZero();
  }

  /// One component: `d` is P H^T, n x 6.
  template <class Columns>
  void add(const Innovation& innovation, const Columns& d) {
    const Cholesky6 s(innovation.covariance);
    const Columns whitened = s.whitened_rows(d);
    const Vector moved = gain_.cwiseProduct(whitened * s.whitened(innovation.residual));
    reduction_.template selfadjointView<Eigen::Lower>().rankUpdate(whitened, innovation.weight);
    second_.template selfadjointView<Eigen::Lower>().rankUpdate(moved, innovation.weight);
    mean_ += innovation.weight * moved;
  }

  /// Puts the moments of the mixture of all components and of clutter into the mean and the
  /// covariance that the update was made with.
  void finish() {
    const Eigen::Index n = covariance_.rows();
    for (Eigen::Index k = 0; k < n; ++k) {
      const auto gain = gain_.tail(n - k).array();
      covariance_.col(k).tail(n - k).array() +=
          second_.col(k).tail(n - k).array() - mean_.tail(n - k).array() * mean_[k] -
          (gain + gain_[k] - gain * gain_[k]) * reduction_.col(k).tail(n - k).array();
    }
    covariance_.template triangularView<Eigen::StrictlyUpper>() = covariance_.transpose();
  }

  /// sum_c a_c D_c S_c^-1 D_c^T in the columns of the camera, n x 6.
  auto camera_reduction() const {
    Eigen::Matrix<double, Eigen::Dynamic, 6> columns = reduction_.template leftCols<6>();
    columns.template topRows<6>() =
        Matrix6d(columns.template topRows<6>().template selfadjointView<Eigen::Lower>());
    return columns;
  }

 private:
  const Vector& gain_;
  Vector& mean_;
  Matrix& covariance_;
  Matrix second_;
  Matrix reduction_;
};

}  // namespace posemix::internal
