// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "joint_gaussian.hpp"

#include "posemix/filter/update.hpp"

namespace posemix::internal {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
/// Six columns of a covariance, in which P H^T is kept.
using SixColumns = Eigen::Matrix<double, Eigen::Dynamic, 6>;

/// Alternatives of less weight do not change the rows of the leading hypothesis beyond rounding.
constexpr double kNegligibleWeight = 1e-7;

/// All coordinates but those of one object.
std::vector<Index> all_but(Index first, Index dof, Index size) {
  std::vector<Index> rest;
  rest.reserve(static_cast<std::size_t>(size - dof));
  for (Index i = 0; i < size; ++i) {
    if (i < first || i >= first + dof) rest.push_back(i);
  }
  return rest;
}

/// The coordinates that are not in `s`.
std::vector<Index> rest_of(const std::vector<Index>& s, Index size) {
  std::vector<bool> is_in(static_cast<std::size_t>(size), false);
  for (const Index i : s) is_in[static_cast<std::size_t>(i)] = true;
  std::vector<Index> rest;
  for (Index i = 0; i < size; ++i) {
    if (!is_in[static_cast<std::size_t>(i)]) rest.push_back(i);
  }
  return rest;
}

/// x <- J x for the coordinates x of one block.
void transport(const Matrix6d& jacobian, std::size_t index, MatrixXd& covariance) {
  rows(covariance, index) = (jacobian * rows(covariance, index)).eval();
  columns(covariance, index) = (columns(covariance, index) * jacobian.transpose()).eval();
}

}  // namespace

void move(ConditionalPose& object, const Vector12d& by) {
  object.pose = SE3d::exp(by.head<6>()) * object.pose;
  if (object.slow) *object.slow += by.tail<6>();
}

Matrix12x6d regression_on_camera(const Matrix12x6d& cross_covariance, const Matrix6d& camera) {
  const Eigen::LLT<Matrix6d> factor(camera);
  return factor.solve(cross_covariance.transpose()).transpose();
}

ConditionalPose JointGaussian::conditional(std::size_t index) const {
  ConditionalPose object{pose(index), {}, Matrix12d::Zero(), Matrix12x6d::Zero()};
  const Index n = dof(index);
  if (blocks_of(index) > 1) object.slow = blocks_[index + 1].slow;
  object.covariance.topLeftCorner(n, n) = covariance_.block(first(index), first(index), n, n);
  object.cross_covariance.topRows(n) = covariance_.block(first(index), 0, n, kPoseDof);
  return object;
}

MatrixXd JointGaussian::rows_of(std::size_t index) const {
  return covariance_.middleRows(first(index), dof(index));
}

/// B_j. = P_OC P_CC^-1 B_C.
MatrixXd JointGaussian::regressed_rows(const ConditionalPose& object) const {
  const Matrix12x6d by =
      regression_on_camera(object.cross_covariance, covariance(kCamera, kCamera));
  return by.topRows(object.slow ? 12 : 6) * rows(covariance_, kCamera);
}

std::size_t JointGaussian::append(const ConditionalPose& object) {
  const std::size_t index = size();
  const std::size_t blocks = object.slow ? 2 : 1;
  blocks_.push_back({object.pose, {}});
  if (object.slow) blocks_.push_back({SE3d(), object.slow});
  const Index n = covariance_.rows() + offset(blocks);
  const Index before = covariance_.rows();
  covariance_.conservativeResize(n, n);
  covariance_.bottomRows(offset(blocks)).setZero();
  covariance_.rightCols(offset(blocks)).topRows(before).setZero();
  replace(index, object);
  return index;
}

std::size_t JointGaussian::append(const SE3d& pose, const Matrix6d& covariance) {
  ConditionalPose alone{pose, {}, Matrix12d::Zero(), Matrix12x6d::Zero()};
  alone.covariance.topLeftCorner<6, 6>() = covariance;
  return append(alone);
}

void JointGaussian::replace(std::size_t index, const ConditionalPose& object) {
  const Index n = dof(index);
  MatrixXd own = regressed_rows(object);
  own.leftCols(kPoseDof) = object.cross_covariance.topRows(n);
  own.middleCols(first(index), n) = object.covariance.topLeftCorner(n, n);
  set_rows(index, object.pose, object.slow, own);
}

void JointGaussian::erase(std::size_t index) {
  const std::vector<Index> kept = all_but(first(index), dof(index), covariance_.rows());
  covariance_ = MatrixXd(covariance_(kept, kept));
  const auto at = blocks_.begin() + static_cast<std::ptrdiff_t>(index);
  blocks_.erase(at, at + static_cast<std::ptrdiff_t>(blocks_of(index)));
}

void JointGaussian::set_rows(std::size_t index, const SE3d& pose,
                             const std::optional<Vector6d>& slow, const MatrixXd& values) {
  blocks_[index].pose = pose;
  if (slow) blocks_[index + 1].slow = slow;
  covariance_.middleCols(first(index), dof(index)) = values.transpose();
  covariance_.middleRows(first(index), dof(index)) = values;
}

void JointGaussian::transform(std::size_t index, const MatrixXd& f) {
  auto own_rows = covariance_.middleRows(first(index), dof(index));
  own_rows = (f * own_rows).eval();
  auto own_columns = covariance_.middleCols(first(index), dof(index));
  own_columns = (own_columns * f.transpose()).eval();
  symmetrize(covariance_);
}

void JointGaussian::move_object(std::size_t index, const Vector12d& by) {
  blocks_[index].pose = SE3d::exp(by.head<6>()) * blocks_[index].pose;
  if (blocks_of(index) > 1) *blocks_[index + 1].slow += by.tail<6>();
}

void JointGaussian::decay_slow(std::size_t index, double factor, const Matrix6d& q) {
  const std::size_t slow = index + 1;
  *blocks_[slow].slow *= factor;
  rows(covariance_, slow) *= factor;
  columns(covariance_, slow) *= factor;
  block(covariance_, slow, slow) += q;
}

MatrixXd JointGaussian::times_ht(std::size_t index, const Matrix6d& slow_map) const {
  MatrixXd d = columns(covariance_, index) - columns(covariance_, kCamera);
  if (blocks_of(index) > 1) d.noalias() += columns(covariance_, index + 1) * slow_map.transpose();
  return d;
}

CameraChange JointGaussian::update(std::size_t index, const Explanation& leading,
                                   const CameraAlternative& alternative,
                                   const GainFactors& factors) {
  const Index n = covariance_.rows();
  VectorXd gain = VectorXd::Constant(n, factors.camera);
  gain.segment<kPoseDof>(first(index)).setOnes();
  if (blocks_of(index) > 1) gain.segment<kPoseDof>(offset(index + 1)).setConstant(factors.slow);
  // Under the leading hypothesis, eq. (5).
  VectorXd mean(n);
  MatrixXd b = covariance_;
  GaussianUpdate update(gain, mean, b);
  for (const Innovation& seen : leading.innovations) {
    if (seen.weight > 0.0) update.add(seen, SixColumns(times_ht(index, seen.slow_map)));
  }
  update.finish();
  // E[e (K z)^T] with e = e_0 - K z is (1 - g) D S^-1 D_C^T g_C.
  const SixColumns reduction = update.camera_reduction();
  CameraChange change{Vector6d::Zero(), factors.camera * factors.camera * reduction.topRows<6>(),
                      factors.camera * (VectorXd::Ones(n) - gain).asDiagonal() * reduction};
  if (alternative.weight < kNegligibleWeight) {
    covariance_ = std::move(b);
  } else {
    // Under all others, eq. (6): the rest follows the camera.
    const Matrix6d prior = covariance(kCamera, kCamera);
    const MatrixXd g = prior.llt().solve(rows(covariance_, kCamera)).transpose();
    MatrixXd other = covariance_;
    other.noalias() += g * (alternative.covariance - prior) * g.transpose();
    // Projection onto one Gaussian, eq. (7) and (8).
    project(index, alternative.weight, mean, b, g * alternative.mean - mean, other);
  }
  change.mean = move(mean);
  return change;
}

VectorXd JointGaussian::difference(const JointGaussian& other, const BlockPairs& shared) const {
  VectorXd result(offset(shared.size()));
  for (std::size_t i = 0; i < shared.size(); ++i) {
    const auto [here, there] = shared[i];
    result.segment<kPoseDof>(offset(i)) = is_pose(here)
                                              ? (other.pose(there) * pose(here).inverse()).log()
                                              : Vector6d(other.slow(there) - slow(here));
  }
  return result;
}

Vector6d JointGaussian::mix(double weight, const JointGaussian& other, const BlockPairs& shared) {
  std::vector<Index> s;  // the coordinates that are shared, here and there
  std::vector<Index> t;
  for (const auto& [here, there] : shared) {
    for (Index k = 0; k < kPoseDof; ++k) {
      s.push_back(offset(here) + k);
      t.push_back(offset(there) + k);
    }
  }
  const VectorXd apart = difference(other, shared);
  MatrixXd b = other.covariance_(t, t);
  // As seen from the mean of the mixture, eq. 14 of the midway-merge paper.
  for (std::size_t i = 0; i < shared.size(); ++i) {
    if (!is_pose(shared[i].first)) continue;
    const Vector6d d = apart.segment<kPoseDof>(offset(i));
    transport(SE3d::left_jacobian_inverse(-weight * d), shared[i].first, covariance_);
    transport(SE3d::left_jacobian_inverse((1.0 - weight) * d), i, b);
  }
  MatrixXd mixed = (1.0 - weight) * covariance_(s, s) + weight * b;
  mixed.noalias() += weight * (1.0 - weight) * apart * apart.transpose();
  return move(regressed_on(s, weight * apart, mixed));
}

VectorXd JointGaussian::regressed_on(const std::vector<Index>& s, const VectorXd& mean_s,
                                     const MatrixXd& covariance_s) {
  // x_r = G x_s + r for the rest r.
  const MatrixXd before = covariance_(s, s);
  const std::vector<Index> r = rest_of(s, covariance_.rows());
  VectorXd mean = VectorXd::Zero(covariance_.rows());
  mean(s) = mean_s;
  if (!r.empty()) {
    const MatrixXd g = before.llt().solve(covariance_(s, r)).transpose();
    mean(r) = g * mean_s;
    const MatrixXd rows = g * covariance_s;
    const MatrixXd own = covariance_(r, r) + g * (covariance_s - before) * g.transpose();
    covariance_(r, s) = rows;
    covariance_(s, r) = rows.transpose();
    covariance_(r, r) = own;
  }
  covariance_(s, s) = covariance_s;
  symmetrize(covariance_);
  return mean;
}

void JointGaussian::shift_back(const CameraChange& change, const Matrix6d& back) {
  const SE3d shift = SE3d::exp(-back * change.mean);
  const Matrix6d added = back * change.covariance * back.transpose();
  for (std::size_t i = 0; i < size(); ++i) {
    if (is_pose(i)) blocks_[i].pose = shift * blocks_[i].pose;
    const Matrix6d with_error = rows(change.error_covariance, i) * back.transpose();
    for (std::size_t k = 0; k < size(); ++k) {
      if (!is_pose(k)) continue;
      block(covariance_, i, k) += with_error;
      block(covariance_, k, i) += with_error.transpose();
      if (is_pose(i)) block(covariance_, i, k) += added;
    }
  }
  symmetrize(covariance_);
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
  const MatrixXd g = before.llt().solve(b_js.transpose()).transpose();
  mean.segment(at, own) += g * shift;
  for (std::size_t i = 0; i < s.size(); ++i) mean(s[i]) += shift(static_cast<Index>(i));
  const MatrixXd row = g * b_s;
  covariance_(s, s) = b_s;
  covariance_.middleRows(at, own)(Eigen::all, s) = row;
  covariance_.middleCols(at, own)(s, Eigen::all) = row.transpose();
  covariance_.block(at, at, own, own) =
      b.block(at, at, own, own) + g * (b_s - before) * g.transpose();
  symmetrize(covariance_);
}

Vector6d JointGaussian::move(const VectorXd& mean) {
  for (std::size_t k = 0; k < size(); ++k) {
    const Vector6d part = mean.segment<kPoseDof>(offset(k));
    if (is_pose(k)) {
      blocks_[k].pose = SE3d::exp(part) * blocks_[k].pose;
    } else {
      *blocks_[k].slow += part;
    }
  }
  return mean.head<kPoseDof>();
}

}  // namespace posemix::internal
