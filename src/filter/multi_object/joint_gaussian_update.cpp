// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <utility>

#include "camera_regression.hpp"
#include "joint_gaussian.hpp"
#include "pair_columns.hpp"

/// The update of the joint Gaussian by a detection, eq. (5) to (8), (13) and (14) of
/// docs/many-objects.md.
namespace posemix::internal {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Alternatives of less weight do not change the rows of the leading hypothesis beyond rounding.
constexpr double kNegligibleWeight = 1e-7;

/// Up to so many other poses eq. (8) has the regression on all of them: as many as there are before
/// any becomes passive.
constexpr std::size_t kMostExact = 47;

/// Number of blocks, of those that are neither camera nor motion, that the regression has beyond.
constexpr std::size_t kNeighbours = 16;

/// All coordinates but those of one object.
std::vector<Index> all_but(Index first, Index dof, Index size) {
  std::vector<Index> rest;
  rest.reserve(static_cast<std::size_t>(size - dof));
  for (Index i = 0; i < size; ++i) {
    if (i < first || i >= first + dof) rest.push_back(i);
  }
  return rest;
}

/// Detections in the coordinates of the pair, [xi_C; xi_O; b] or [xi_C; xi_O], with the extrinsics
/// behind xi_C.
struct PairChange {
  MatrixXd covariance;  ///< N: the covariance of everything else changes by F N F^T
  VectorXd mean;        ///< its mean moves by F times this
};

/// Eq. (5) for everything else, whose columns of the pair are F and whose gain has the factor
/// `gain`. The error of the camera that sees is `seen_by` times that of the rig.
PairChange pair_change(const Explanation& leading, double gain, const MatrixXd& seen_by,
                       Index dof) {
  const Index rig = seen_by.cols();
  PairChange change{MatrixXd::Zero(dof, dof), VectorXd::Zero(dof)};
  for (const Innovation& seen : leading.innovations) {
    if (!(seen.weight > 0.0)) continue;
    MatrixXd h(dof, 6);  // H^T
    h.topRows(rig) = -seen_by.transpose();
    h.middleRows<6>(rig) = Matrix6d::Identity();
    if (dof > rig + 6) h.bottomRows<6>() = seen.slow_map.transpose();
    const Eigen::LLT<Matrix6d> s(seen.covariance);
    const MatrixXd reduction = h * s.solve(h.transpose());
    const VectorXd moved = gain * h * s.solve(seen.residual);
    change.covariance +=
        seen.weight * (moved * moved.transpose() - (2.0 * gain - gain * gain) * reduction);
    change.mean += seen.weight * moved;
  }
  change.covariance -= change.mean * change.mean.transpose();
  return change;
}

/// The regression of all coordinates on the first ones.
struct Following {
  MatrixXd by;
  MatrixXd covariance;  ///< of all
};

/// Eq. (6): all coordinates follow the first ones, of covariance `prior` and joint rows `rows`, the
/// covariance of which becomes `other`. Of a camera known far worse than detections rounding may
/// leave no factor: there what is left of each pose alone decides.
template <typename Prior, typename Rows, typename Other>
Following following(const MatrixXd& covariance, const Prior& prior, const Rows& rows,
                    const Other& other) {
  const Eigen::LLT<Prior> factor(prior);
  const bool has_factor = factor.info() == Eigen::Success;
  Following result{has_factor ? MatrixXd(factor.solve(rows).transpose())
                              : MatrixXd(RegularFactor(prior).solve(rows).transpose()),
                   covariance};
  result.covariance.noalias() += result.by * (other - prior) * result.by.transpose();
  return result;
}

}  // namespace

SixColumns JointGaussian::times_ht(std::size_t index, const Matrix6d& slow_map,
                                   const MatrixXd& seen_by) const {
  SixColumns d = covariance_.middleCols<6>(first(index)) - columns(covariance_, kCamera);
  if (const Index more = seen_by.cols() - 6; more > 0)
    d.noalias() -= covariance_.middleCols(6, more) * seen_by.rightCols(more).transpose();
  if (blocks_of(index) > 1)
    d.noalias() += covariance_.middleCols<6>(first(index + 1)) * slow_map.transpose();
  return d;
}

template <int Own>
std::optional<CameraChange> JointGaussian::update_columns(std::size_t index,
                                                          const Explanation& leading,
                                                          const CameraAlternative& alternative,
                                                          const GainFactors& factors) {
  PairUpdate<Own> pair(covariance_, first(index), leading, factors);
  if (!pair.ok()) return std::nullopt;
  if (alternative.weight < kNegligibleWeight) {
    pair.take_leading(covariance_);
  } else if (!pair.take_mixture(alternative.weight, alternative.mean, alternative.covariance,
                                covariance_)) {
    return std::nullopt;
  }
  // E[e (K z)^T] with e = e_0 - K z is (1 - g) D S^-1 D_C^T g_C.
  const double g = factors.camera;
  CameraChange change{Vector6d::Zero(), g * g * pair.camera_reduction(),
                      KeptMatrix<6>(covariance_.rows())};
  if (g < 1.0 || factors.slow < 1.0) {
    auto with_error = change.error_covariance.get();
    pair.set_reduction_with_camera(with_error);
    with_error *= g;
    if constexpr (Own > 6) {
      const Index slow = first(index + 1);
      const Matrix6d own = (1.0 - factors.slow) * with_error.middleRows<6>(slow);
      with_error *= 1.0 - g;
      with_error.middleRows<6>(slow) = own;
    } else {
      with_error *= 1.0 - g;
    }
    with_error.middleRows<6>(first(index)).setZero();
  }
  change.mean = move_active(pair.mean());
  move_passive(pair.mean());
  return change;
}

CameraChange JointGaussian::update(std::size_t index, const Explanation& leading,
                                   const CameraAlternative& alternative, const GainFactors& factors,
                                   const ObservationSource& source) {
  activate(index);
  if (extrinsics_ == 0 && (alternative.weight < kNegligibleWeight || is_small(index))) {
    auto change = dof(index) == 6 ? update_columns<6>(index, leading, alternative, factors)
                                  : update_columns<12>(index, leading, alternative, factors);
    if (change) return *std::move(change);
  }
  return update_densely(index, leading, alternative, factors, source);
}

CameraChange JointGaussian::update_densely(std::size_t index, const Explanation& leading,
                                           const CameraAlternative& alternative,
                                           const GainFactors& factors,
                                           const ObservationSource& source) {
  activate(index);
  const Index n = covariance_.rows();
  const MatrixXd by = seen_by(source);
  VectorXd gain = VectorXd::Constant(n, factors.camera);
  gain.segment<kPoseDof>(first(index)).setOnes();
  if (blocks_of(index) > 1) gain.segment<kPoseDof>(first(index + 1)).setConstant(factors.slow);
  // Under the leading hypothesis, eq. (5).
  VectorXd mean(n);
  MatrixXd b = covariance_;
  GaussianUpdate update(gain, mean, b);
  for (const Innovation& seen : leading.innovations) {
    if (seen.weight > 0.0) update.add(seen, times_ht(index, seen.slow_map, by));
  }
  update.finish();
  // E[e (K z)^T] with e = e_0 - K z is (1 - g) D S^-1 D_C^T g_C.
  const SixColumns reduction = update.camera_reduction();
  CameraChange change{Vector6d::Zero(), factors.camera * factors.camera * reduction.topRows<6>(),
                      KeptMatrix<6>(n)};
  change.error_covariance.get() =
      factors.camera * (VectorXd::Ones(n) - gain).asDiagonal() * reduction;
  if (alternative.weight < kNegligibleWeight) {
    covariance_ = std::move(b);
  } else if (!is_small(index)) {
    project_near(index, leading, alternative, factors.camera, by, mean, b);
    covariance_ = std::move(b);
  } else if (extrinsics_ > 0) {
    const auto [by_rig, other] = following(
        covariance_, MatrixXd(rig()), covariance_.topRows(rig_dof()), alternative.rig.covariance);
    project(index, alternative.weight, mean, b, by_rig * alternative.rig.mean - mean, other);
  } else {
    // Under all others, eq. (6), the rest follows the camera; onto one Gaussian, eq. (7) and (8).
    const auto [by_camera, other] = following(covariance_, covariance(kCamera, kCamera),
                                              rows(covariance_, kCamera), alternative.covariance);
    project(index, alternative.weight, mean, b, by_camera * alternative.mean - mean, other);
  }
  if (extrinsics_ > 0) change.rig_mean = mean.head(rig_dof());
  change.mean = move_active(mean);
  move_passive(mean);
  return change;
}

void JointGaussian::project(std::size_t index, double w_a, VectorXd& mean, const MatrixXd& b,
                            const VectorXd& apart, const MatrixXd& other) {
  const double w = 1.0 - w_a;
  const Index at = first(index);
  const Index own = dof(index);
  const std::vector<Index> s = all_but(at, own, covariance_.rows());
  // Everything but the object takes the exact moments of the mixture, eq. (7).
  const VectorXd difference = apart(s);
  const VectorXd shift = w_a * difference;
  MatrixXd b_s = w * b(s, s) + w_a * other(s, s);
  b_s.noalias() += w * w_a * difference * difference.transpose();
  // The object keeps the regression that it has under the leading hypothesis, eq. (8).
  const MatrixXd b_js = b.middleRows(at, own)(Eigen::all, s);
  const MatrixXd before = b(s, s);
  const RegularFactor regular(before);
  const MatrixXd g = regular.solve(b_js.transpose()).transpose();
  mean.segment(at, own) += g * shift;
  for (std::size_t i = 0; i < s.size(); ++i) mean(s[i]) += shift(static_cast<Index>(i));
  const MatrixXd row = g * b_s;
  covariance_(s, s) = b_s;
  covariance_.middleRows(at, own)(Eigen::all, s) = row;
  covariance_.middleCols(at, own)(s, Eigen::all) = row.transpose();
  covariance_.block(at, at, own, own) =
      b.block(at, at, own, own) + g * (b_s - before) * g.transpose();
  regular.add_to(covariance_);
  symmetrize(covariance_);
}

bool JointGaussian::is_small(std::size_t index) const {
  if (!carriers_.empty()) return false;
  std::size_t others = 0;
  for (std::size_t i = 1 + extrinsics_; i < size(); ++i) others += i != index && is_pose(i) ? 1 : 0;
  return others <= kMostExact;
}

std::vector<Index> JointGaussian::neighbours(std::size_t index) const {
  const Eigen::LLT<Matrix6d> camera(covariance(kCamera, kCamera));
  const Eigen::LLT<MatrixXd> rig_factor(extrinsics_ > 0 ? MatrixXd(rig()) : MatrixXd());
  const auto given_camera = [&](Index i, Index k) -> Matrix6d {
    if (extrinsics_ > 0) {
      return covariance_.block<6, 6>(i, k) -
             covariance_.block(i, 0, 6, rig_dof()) *
                 rig_factor.solve(covariance_.block(0, k, rig_dof(), 6));
    }
    return Matrix6d(covariance_.block<6, 6>(i, k) -
                    covariance_.block<6, 6>(i, 0) * camera.solve(covariance_.block<6, 6>(0, k)));
  };
  const Index at = first(index);
  const Eigen::LLT<Matrix6d> own(given_camera(at, at));
  std::vector<Index> result;
  for (std::size_t i = 0; i <= extrinsics_; ++i) append_coordinates(result, offset(i));
  std::vector<std::pair<double, Index>> scores;
  for (const Block& other : blocks_) {
    if (other.at < rig_dof() || (other.at >= at && other.at < at + dof(index))) continue;
    if (other.is_motion) {
      append_coordinates(result, other.at);
      continue;
    }
    // tr(C_jj^-1 C_jk C_kk^-1 C_kj): the part of the object's information that the block has.
    const Matrix6d cross = given_camera(other.at, at);
    const Eigen::LLT<Matrix6d> factor(given_camera(other.at, other.at));
    const double score = own.solve(Matrix6d(cross.transpose() * factor.solve(cross))).trace();
    scores.emplace_back(std::isfinite(score) ? -score : 0.0, other.at);
  }
  const std::size_t most = std::min(kNeighbours, scores.size());
  std::partial_sort(scores.begin(), scores.begin() + static_cast<std::ptrdiff_t>(most),
                    scores.end());
  for (std::size_t k = 0; k < most; ++k) append_coordinates(result, scores[k].second);
  return result;
}

/// With T the camera, its motion and the neighbours, F = B_T(C,j,b) and B* of the leading
/// hypothesis, T gets the moments of the mixture, which are B*_TT + F M F^T, and everything else
/// follows by its regression on T: R = B*_.T B*_TT^-1 F, B = B* + R M R^T.
void JointGaussian::project_near(std::size_t index, const Explanation& leading,
                                 const CameraAlternative& alternative, double gain,
                                 const MatrixXd& seen_by, VectorXd& mean, MatrixXd& b) {
  const Index pair_dof = rig_dof() + dof(index);
  const double w_a = alternative.weight;
  const PairChange own = pair_change(leading, gain, seen_by, pair_dof);
  // Eq. (6) and its difference from eq. (5), in the coordinates of the pair.
  VectorXd apart = -own.mean;
  MatrixXd m = -own.covariance;
  if (extrinsics_ > 0) {
    const MatrixXd prior = rig();
    const Eigen::LLT<MatrixXd> factor(prior);
    const MatrixXd change = alternative.rig.covariance - prior;
    apart.head(rig_dof()) += factor.solve(alternative.rig.mean);
    m.topLeftCorner(rig_dof(), rig_dof()) += factor.solve(factor.solve(change).transpose());
  } else {
    const Matrix6d prior = covariance(kCamera, kCamera);
    const Eigen::LLT<Matrix6d> camera(prior);
    apart.head<6>() += camera.solve(alternative.mean);
    m.topLeftCorner<6, 6>() +=
        camera.solve(camera.solve(Matrix6d(alternative.covariance - prior)).transpose());
  }
  m = (w_a * m + (1.0 - w_a) * w_a * apart * apart.transpose()).eval();

  std::vector<Index> pair;
  for (std::size_t i = 0; i <= extrinsics_; ++i) append_coordinates(pair, offset(i));
  for (std::size_t k = 0; k < blocks_of(index); ++k) append_coordinates(pair, first(index + k));
  const std::vector<Index> t = neighbours(index);
  const MatrixXd b_t = b(Eigen::all, t);
  const MatrixXd before = b_t(t, Eigen::all);
  const RegularFactor regular(before);
  regular.add_to(b);
  const MatrixXd r = b_t * regular.solve(MatrixXd(covariance_(t, pair)));
  mean.noalias() += r * (w_a * apart);
  const MatrixXd left = r * m;
  b.triangularView<Eigen::Lower>() += left * r.transpose();
  b.triangularView<Eigen::StrictlyUpper>() = b.transpose();
}

}  // namespace posemix::internal
