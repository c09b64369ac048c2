// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <sstream>
#include <string>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "posemix/lie/lie.hpp"
#include "posemix/testing/lie_laws.hpp"

// The law suite must detect a broken group, and print what it expected.
namespace posemix::testing {
namespace {

template <typename Function>
std::string failure_of(const Function& property) {
  std::ostringstream text;
  rc::detail::printResultMessage(rc::detail::checkTestable(property), text);
  return text.str();
}

TEST(LieCheck, FailurePrintsExpectedActualAndDistance) {
  const std::string text = failure_of([] {
    const SO3d x = SO3d::exp(Eigen::Vector3d(0.25, 0, 0));
    expect_close("a turn", x, SO3d(), 1.0);
  });
  for (const char* part :
       {"a turn", "expected", "Exp  [0 0 0]", "actual", "Exp  [0.25", "distance 0.25"}) {
    EXPECT_NE(text.find(part), std::string::npos) << part << " in\n" << text;
  }
}

TEST(LieCheck, NumbersThatAreNotNumbersFail) {
  const std::string text = failure_of([] {
    const Eigen::Vector3d nan = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
    expect_close<Eigen::Vector3d>("nan", nan, Eigen::Vector3d::Zero(), 1.0);
  });
  EXPECT_NE(text.find("distance"), std::string::npos) << text;
}

/// SO(3) whose left Jacobian has lost its quadratic term.
class CrookedRotation : public SO3d {
 public:
  using SO3d::SO3d;
  CrookedRotation(const SO3d& r) : SO3d(r) {}
  static CrookedRotation exp(const Tangent& phi) { return SO3d::exp(phi); }
  static CrookedRotation identity() { return {}; }
  CrookedRotation inverse() const { return SO3d::inverse(); }
  CrookedRotation operator*(const CrookedRotation& other) const { return SO3d::operator*(other); }
  static TangentMatrix left_jacobian(const Tangent& phi) {
    return TangentMatrix::Identity() + hat(phi) / 2;
  }
};

}  // namespace

template <>
struct TangentDraw<CrookedRotation> : TangentDraw<SO3d> {};
template <>
struct Rebind<CrookedRotation, long double> {
  using type = SO3<long double>;
};

namespace {

TEST(LieCheck, FindsAWrongJacobian) {
  const LieLaws<CrookedRotation> laws(3);
  EXPECT_EQ(failure_of([&] { laws.exp_and_log_are_inverse(); }).find("expected"),
            std::string::npos);
  EXPECT_NE(failure_of([&] { laws.jacobians_are_derivatives_of_exp(); }).find("J_l"),
            std::string::npos);
  EXPECT_NE(failure_of([&] { laws.jacobians_are_consistent(); }).find("J_l J_l^-1 = I"),
            std::string::npos);
  EXPECT_NE(failure_of([&] { laws.volume_factor_is_the_determinant(); }).find("log |det J_l|"),
            std::string::npos);
}

}  // namespace
}  // namespace posemix::testing
