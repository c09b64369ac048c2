// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>

#include "oracle.hpp"
#include "posemix/lie/lie.hpp"
#include "samples.hpp"
#include "worst_errors.hpp"

// Every function of SO(3) and SE(3) against 100-digit arithmetic: norm-wise relative error, block
// by block where rotations and metres share a matrix.
namespace posemix {
namespace {

using oracle::Matrix;
using oracle::Real;
using oracle::Vector;
using oracle::WorstErrors;

using Real50 = boost::multiprecision::cpp_bin_float_50;
using Scalars = ::testing::Types<float, double, long double, Real50>;

template <typename S>
class Accuracy : public ::testing::Test {};
TYPED_TEST_SUITE(Accuracy, Scalars);

template <typename Scalar>
std::vector<Scalar> all_angles() {
  auto angles = oracle::angles_to_pi<Scalar>();
  const auto beyond = oracle::angles_beyond_pi<Scalar>();
  angles.insert(angles.end(), beyond.begin(), beyond.end());
  return angles;
}

template <typename Scalar>
Vector axis_part(const Vector& phi) {
  const Real angle = phi.norm();
  if (angle == Real(0)) return phi;
  return phi * (sin(Real(angle / Real(2))) / angle);
}

TYPED_TEST(Accuracy, RotationExp) {
  using Scalar = TypeParam;
  auto worst = WorstErrors::of<Scalar>();
  for (const auto& phi : oracle::rotation_vectors(all_angles<Scalar>())) {
    const auto r = SO3<Scalar>::exp(phi);
    const Vector exact = oracle::raise(phi);
    worst.add("exp_matrix", r.matrix(), oracle::exp(exact), phi);
    worst.add("exp_quaternion_axis", r.quaternion().vec(), axis_part<Scalar>(exact), phi);
    worst.add("adjoint", r.adjoint(), oracle::exp(exact), phi);
  }
  worst.check();
}

TYPED_TEST(Accuracy, RotationExpBeyondOneTurn) {
  using Scalar = TypeParam;
  auto worst = WorstErrors::of<Scalar>();
  for (const double turns : {0.75, 0.9999, 1.0, 1.0001, 1.5, 2.0, 7.3, 25.0, 49.9, 50.0}) {
    const Scalar angle = Scalar(turns * 2.0 * 3.14159265358979323846);
    for (const auto& axis : oracle::directions<Scalar>()) {
      const Eigen::Matrix<Scalar, 3, 1> phi = angle * axis;
      const Matrix want = oracle::exp(oracle::raise(phi));
      worst.add("exp_matrix", SO3<Scalar>::exp(phi).matrix(), want, phi,
                Real(Real(angle) * want.norm()));
    }
  }
  worst.check();
}

TYPED_TEST(Accuracy, RotationLog) {
  using Scalar = TypeParam;
  auto worst = WorstErrors::of<Scalar>();
  for (const auto& phi : oracle::rotation_vectors(oracle::angles_to_pi<Scalar>())) {
    const auto r = SO3<Scalar>::exp(phi);
    worst.add("log", r.log(), oracle::log(oracle::raise(r.quaternion().coeffs())), phi);
    if (phi.norm() < Scalar(3)) worst.add("log_of_exp", r.log(), oracle::raise(phi), phi);
    const auto back = SO3<Scalar>::from_matrix(r.matrix());
    worst.add("from_matrix", back.matrix(), oracle::raise(r.matrix()), phi);
  }
  worst.check();
}

TYPED_TEST(Accuracy, RotationJacobians) {
  using Scalar = TypeParam;
  using Group = SO3<Scalar>;
  auto worst = WorstErrors::of<Scalar>();
  for (const auto& phi : oracle::rotation_vectors(all_angles<Scalar>())) {
    const Matrix want = oracle::left_jacobian(oracle::raise(phi));
    const Matrix inverse = oracle::inverse(want);
    worst.add("left_jacobian", Group::left_jacobian(phi), want, phi);
    worst.add("right_jacobian", Group::right_jacobian(-phi), want, phi);
    worst.add("left_jacobian_inverse", Group::left_jacobian_inverse(phi), inverse, phi);
    worst.add("right_jacobian_inverse", Group::right_jacobian_inverse(-phi), inverse, phi);
  }
  worst.check();
}

TYPED_TEST(Accuracy, VolumeFactor) {
  using Scalar = TypeParam;
  auto worst = WorstErrors::of<Scalar>();
  for (const auto& phi : oracle::rotation_vectors(all_angles<Scalar>())) {
    const Vector exact = oracle::raise(phi);
    // Below 1e-20 the determinant keeps too few digits; its Taylor series does not need more terms.
    const Real u = exact.squaredNorm();
    const Real want = u < Real(1e-40) ? Real(-u / Real(12) - u * u / Real(1440))
                                      : oracle::log_abs_det(oracle::left_jacobian(exact));
    const auto got = oracle::as_matrix(SO3<Scalar>::log_abs_det_left_jacobian(phi));
    worst.add("log_abs_det_left_jacobian", got, oracle::as_matrix(want), phi);
  }
  worst.check();
}

TYPED_TEST(Accuracy, PoseExpAndLog) {
  using Scalar = TypeParam;
  auto worst = WorstErrors::of<Scalar>();
  for (const auto& xi : oracle::twists(oracle::angles_to_pi<Scalar>())) {
    const auto x = SE3<Scalar>::exp(xi);
    const Matrix want = oracle::exp(oracle::raise(xi));
    worst.add("exp_rotation", x.rotation().matrix(), want.topLeftCorner(3, 3), xi);
    worst.add("exp_translation", x.translation(), want.topRightCorner(3, 1), xi);
    const Vector log = oracle::log(oracle::raise(x.rotation().quaternion().coeffs()),
                                   oracle::raise(x.translation()));
    worst.add("log_rotation", x.log().template head<3>(), log.head(3), xi);
    worst.add("log_translation", x.log().template tail<3>(), log.tail(3), xi);
  }
  worst.check();
}

TYPED_TEST(Accuracy, PoseJacobians) {
  using Scalar = TypeParam;
  using Group = SE3<Scalar>;
  auto worst = WorstErrors::of<Scalar>();
  const auto add_blocks = [&worst](const char* name, const auto& got, const Matrix& want,
                                   const auto& xi) {
    const std::string text(name);
    worst.add(text + "_a", got.template topLeftCorner<3, 3>(), want.topLeftCorner(3, 3), xi);
    worst.add(text + "_b", got.template bottomLeftCorner<3, 3>(), want.bottomLeftCorner(3, 3), xi);
    worst.add(text, got, want, xi);
  };
  for (const auto& xi : oracle::twists(all_angles<Scalar>())) {
    const Matrix want = oracle::left_jacobian(oracle::raise(xi));
    const Matrix inverse = oracle::inverse(want);
    add_blocks("left_jacobian", Group::left_jacobian(xi), want, xi);
    add_blocks("right_jacobian", Group::right_jacobian(-xi), want, xi);
    add_blocks("left_jacobian_inverse", Group::left_jacobian_inverse(xi), inverse, xi);
    add_blocks("right_jacobian_inverse", Group::right_jacobian_inverse(-xi), inverse, xi);
  }
  worst.check();
}

TYPED_TEST(Accuracy, PoseCongruences) {
  using Scalar = TypeParam;
  using Group = SE3<Scalar>;
  typename Group::TangentMatrix root = Group::TangentMatrix::Identity();
  for (Eigen::Index i = 1; i < 6; ++i) root(i, i - 1) = Scalar(static_cast<int>(i)) / Scalar(4);
  const typename Group::TangentMatrix p = root * root.transpose();
  const Matrix exact = oracle::raise(p);
  auto worst = WorstErrors::of<Scalar>();
  const auto add = [&](const char* name, const auto& got, const Matrix& j, const auto& xi) {
    // A product of matrices is exact to the product of their norms, not to its own.
    worst.add(name, got, oracle::product(oracle::product(j, exact), j.transpose()), xi,
              Real(j.squaredNorm() * exact.norm()));
  };
  for (const Scalar& angle :
       {Scalar(0), Scalar(1e-9), Scalar(0.5), Scalar(1.99), Scalar(2.01), Scalar(3.1)}) {
    for (const auto& xi : oracle::twists(std::vector<Scalar>{angle})) {
      const Matrix j = oracle::left_jacobian(oracle::raise(xi));
      add("left_jacobian_congruence", Group::left_jacobian_congruence(xi, p), j, xi);
      add("left_jacobian_inverse_congruence", Group::left_jacobian_inverse_congruence(xi, p),
          oracle::inverse(j), xi);
    }
  }
  worst.check();
}

TYPED_TEST(Accuracy, PoseProducts) {
  using Scalar = TypeParam;
  auto worst = WorstErrors::of<Scalar>();
  const auto twists =
      oracle::twists(std::vector<Scalar>{Scalar(0), Scalar(1e-9), Scalar(1.2), Scalar(3)});
  for (const auto& left : twists) {
    const auto x = SE3<Scalar>::exp(left);
    const Matrix rx = oracle::rotation(oracle::raise(x.rotation().quaternion().coeffs()));
    const Vector tx = oracle::raise(x.translation());
    worst.add("inverse_translation", x.inverse().translation(),
              -oracle::product(rx.transpose(), tx), left);
    worst.add("adjoint_b", x.adjoint().template bottomLeftCorner<3, 3>(),
              oracle::product(oracle::cross(tx), rx), left);
    worst.add("matrix", x.matrix().template topLeftCorner<3, 3>(), rx, left);
    for (std::size_t i = 0; i < twists.size(); i += 7) {
      const auto y = SE3<Scalar>::exp(twists[i]);
      const Matrix ry = oracle::rotation(oracle::raise(y.rotation().quaternion().coeffs()));
      const Vector ty = oracle::raise(y.translation());
      worst.add("compose_rotation", (x * y).rotation().matrix(), oracle::product(rx, ry), left);
      worst.add("compose_translation", (x * y).translation(), oracle::product(rx, ty) + tx, left,
                Real(tx.norm() + ty.norm()));
    }
  }
  worst.check();
}

}  // namespace
}  // namespace posemix
