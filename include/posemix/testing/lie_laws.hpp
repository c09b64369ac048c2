// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include <rapidcheck.h>
#include <Eigen/Core>
#include <Eigen/LU>

#include "posemix/lie/lie.hpp"
#include "posemix/testing/lie_check.hpp"
#include "posemix/testing/lie_draw.hpp"

namespace posemix::testing {

/// A named property: `holds` draws its own data from RapidCheck and throws if the law is broken.
struct Law {
  std::string name;
  std::function<void()> holds;
};

/// The laws that every Lie group obeys, to rounding error. `x`, `y`, `z` are drawn elements, `xi`,
/// `eta` drawn tangent vectors with rotations below pi.
///
///     for (const Law& law : lie_laws<SE3d>()) rc::check(law.name, law.holds);
template <LieGroup G>
class LieLaws {
 public:
  using Scalar = typename G::Scalar;
  using Tangent = typename G::Tangent;
  using TangentMatrix = typename G::TangentMatrix;

  /// Laws for elements of `dof` degrees of freedom.
  explicit LieLaws(Eigen::Index dof) : dof_(dof) {}

  void group_axioms() const {
    const G x = element(), y = element(), z = element();
    const Scalar scale = size(x) + size(y) + size(z);
    expect_close("(x y) z = x (y z)", (x * y) * z, x * (y * z), scale);
    expect_close("x e = x", x * x.identity(), x, scale);
    expect_close("e x = x", x.identity() * x, x, scale);
    expect_close("x x^-1 = e", x * x.inverse(), x.identity(), scale);
    expect_close("x^-1 x = e", x.inverse() * x, x.identity(), scale);
    expect_close("(x y)^-1 = y^-1 x^-1", (x * y).inverse(), y.inverse() * x.inverse(), scale);
    RC_ASSERT(x.dof() == dof_);
    RC_ASSERT(x.is_approx(x, Scalar(0.001)));
  }

  void exp_and_log_are_inverse() const {
    const Tangent xi = tangent();
    const G x = G::exp(xi) * element();
    expect_close<Tangent>("log exp xi = xi", G::exp(xi).log(), xi, size(xi));
    expect_close("exp log x = x", G::exp(x.log()), x, size(x));
    expect_close("exp 0 = e", G::exp(Tangent::Zero(dof_)), x.identity(), Scalar(1));
  }

  void exp_is_a_one_parameter_group() const {
    const Tangent xi = tangent();
    const Scalar s = draw_fraction<Scalar>(), t = draw_fraction<Scalar>();
    const G sum = G::exp(Tangent((s + t) * xi));
    expect_close("exp (s + t) xi", G::exp(Tangent(s * xi)) * G::exp(Tangent(t * xi)), sum,
                 size(xi));
    expect_close("exp -xi = (exp xi)^-1", G::exp(-xi), G::exp(xi).inverse(), size(xi));
  }

  void adjoint_is_conjugation() const {
    const G x = element(), y = element();
    const Tangent xi = tangent();
    const Scalar scale = size(x) * size(xi);
    const Tangent moved = x.adjoint() * xi;
    expect_close("exp(Ad xi) = x exp(xi) x^-1", G::exp(moved), x * G::exp(xi) * x.inverse(), scale);
    const Scalar square = size(x) * size(y);
    expect_close<TangentMatrix>("Ad(x y)", (x * y).adjoint(), x.adjoint() * y.adjoint(), square);
    expect_close<TangentMatrix>("Ad(x^-1) Ad(x) = I", x.inverse().adjoint() * x.adjoint(), unit(),
                                size(x) * size(x));
  }

  void ad_is_the_derivative_of_adjoint() const {
    const Tangent xi = tangent(), eta = tangent(), zeta = tangent();
    const auto wide = widened(xi);
    using WideG = Wide<G>;
    const auto slope = derivative_at_zero<typename WideG::Scalar>([&](const auto& s) {
      const typename WideG::Tangent step = s * wide;
      return WideG::exp(step).adjoint();
    });
    const Scalar cube = size(xi) * size(xi) * size(xi);
    expect_close<TangentMatrix>("ad = dAd", G::ad(xi), narrowed(slope), cube * size(xi) * size(xi));
    expect_close<Tangent>("ad(xi) eta = -ad(eta) xi", G::ad(xi) * eta, -G::ad(eta) * xi,
                          size(xi) * size(eta));
    const TangentMatrix bracket = G::ad(xi) * G::ad(eta) - G::ad(eta) * G::ad(xi);
    expect_close<Tangent>("Jacobi identity", bracket * zeta, G::ad(G::ad(xi) * eta) * zeta,
                          size(xi) * size(eta) * size(zeta));
  }

  void jacobians_are_derivatives_of_exp() const {
    const Tangent xi = tangent();
    using WideG = Wide<G>;
    using WideTangent = typename WideG::Tangent;
    const WideTangent at = widened(xi);
    const WideG back = WideG::exp(at).inverse();
    typename WideG::TangentMatrix left(dof_, dof_), right(dof_, dof_);
    for (Eigen::Index i = 0; i < dof_; ++i) {
      const auto moved = [&](const auto& s) {
        const WideTangent step = at + s * WideTangent::Unit(dof_, i);
        return WideG::exp(step);
      };
      using WideS = typename WideG::Scalar;
      left.col(i) =
          derivative_at_zero<WideS>([&](const auto& s) { return (moved(s) * back).log(); });
      right.col(i) =
          derivative_at_zero<WideS>([&](const auto& s) { return (back * moved(s)).log(); });
    }
    const Scalar scale = size(xi) * size(xi);
    expect_close<TangentMatrix>("J_l", G::left_jacobian(xi), narrowed(left), scale);
    expect_close<TangentMatrix>("J_r", G::right_jacobian(xi), narrowed(right), scale);
  }

  void jacobians_are_consistent() const {
    const Tangent xi = tangent();
    const TangentMatrix left = G::left_jacobian(xi), right = G::right_jacobian(xi);
    const Scalar scale = size(xi) * size(xi);
    expect_close<TangentMatrix>("J_l J_l^-1 = I", left * G::left_jacobian_inverse(xi), unit(),
                                scale);
    expect_close<TangentMatrix>("J_r^-1 J_r = I", G::right_jacobian_inverse(xi) * right, unit(),
                                scale);
    expect_close<TangentMatrix>("J_r(xi) = J_l(-xi)", right, G::left_jacobian(-xi), scale);
    expect_close<TangentMatrix>("J_r = Ad(exp -xi) J_l", right, G::exp(-xi).adjoint() * left,
                                scale);
    expect_close<Tangent>("J_l xi = xi", left * xi, xi, scale);
  }

  void congruences_are_products() const {
    const Tangent xi = tangent();
    const G x = element();
    const TangentMatrix p = draw_covariance<G>(dof_);
    const auto expect_product = [&](const char* what, const TangentMatrix& got,
                                    const TangentMatrix& j) {
      expect_close<TangentMatrix>(what, got, j * p * j.transpose(), j.squaredNorm() * p.norm());
      RC_ASSERT(got == got.transpose());
    };
    expect_product("J_l P J_l^T", G::left_jacobian_congruence(xi, p), G::left_jacobian(xi));
    expect_product("J_l^-1 P J_l^-T", G::left_jacobian_inverse_congruence(xi, p),
                   G::left_jacobian_inverse(xi));
    expect_product("Ad P Ad^T", x.adjoint_congruence(p), x.adjoint());
  }

  void volume_factor_is_the_determinant() const {
    using std::abs;
    using std::log;
    using Value = Eigen::Matrix<Scalar, 1, 1>;
    const Tangent xi = tangent();
    const Scalar determinant = G::left_jacobian(xi).partialPivLu().determinant();
    expect_close<Value>("log |det J_l|", Value(G::log_abs_det_left_jacobian(xi)),
                        Value(Scalar(log(Scalar(abs(determinant))))), size(xi) * size(xi));
  }

  void interpolation_follows_the_geodesic() const {
    const G a = element(), x = element();
    const Tangent xi = tangent();
    const Tangent part = Scalar(0.9) * xi;
    const G b = G::exp(part) * a;
    const Scalar t = draw_fraction<Scalar>();
    const Scalar scale = size(a) * size(xi) * size(x);
    expect_close("t = 0", interpolate(a, b, Scalar(0)), a, scale);
    expect_close("t = 1", interpolate(a, b, Scalar(1)), b, scale);
    const G at = interpolate(a, b, t);
    expect_close("exp(t log(b a^-1)) a", at, G::exp(Tangent(t * part)) * a, scale);
    expect_close("from the other end", interpolate(b, a, Scalar(Scalar(1) - t)), at, scale);
    expect_close("in another frame", interpolate(x * a, x * b, t), x * at, scale);
  }

  void mean_solves_its_equation() const {
    const auto [elements, weights] = cluster();
    const auto result = weighted_mean(elements, weights, exact_);
    RC_ASSERT(result.converged);
    const G x = element(), y = element();
    std::vector<G> moved;
    Tangent sum = Tangent::Zero(dof_);
    Scalar scale = size(x) * size(y) * size(result.mean);
    for (std::size_t i = 0; i < elements.size(); ++i) {
      moved.push_back(x * elements[i] * y);
      sum += weights[i] * (elements[i] * result.mean.inverse()).log();
      scale += weights[i] * size(elements[i]);
    }
    scale *= size(result.mean) * size(y);
    expect_close<Tangent>("sum w_i log(X_i mean^-1) = 0", sum, Tangent::Zero(dof_), scale);
    expect_close("mean(x X_i y) = x mean y", weighted_mean(moved, weights, exact_).mean,
                 x * result.mean * y, scale);
  }

  void mean_of_special_sets() const {
    const auto [elements, weights] = cluster();
    const std::vector<G> same(elements.size(), elements.front());
    const auto result = weighted_mean(same, weights);
    const Scalar scale = size(elements[0]) + size(elements[1]);
    RC_ASSERT(result.converged);
    expect_close("mean of one element", result.mean, elements.front(), scale);
    const std::vector<G> two{elements[0], elements[1]};
    const std::vector<Scalar> both{weights[0], weights[1]};
    const G between = interpolate(two[0], two[1], Scalar(both[1] / (both[0] + both[1])));
    expect_close("mean of two", weighted_mean(two, both, exact_).mean, between, scale * scale);
  }

  void matrices_represent_the_group() const requires MatrixLieGroup<G> {
    const G x = element(), y = element();
    const Tangent xi = tangent(), eta = tangent();
    const Scalar scale = size(x) + size(y);
    expect_close<typename G::Matrix>("matrix of a product", (x * y).matrix(),
                                     x.matrix() * y.matrix(), scale);
    expect_close<Tangent>("vee hat xi = xi", G::vee(G::hat(xi)), xi, Scalar(0));
    const typename G::Matrix bracket = G::hat(xi) * G::hat(eta) - G::hat(eta) * G::hat(xi);
    expect_close<Tangent>("ad(xi) eta = [xi, eta]", G::ad(xi) * eta, G::vee(bracket),
                          size(xi) * size(eta));
    expect_close("matrix and back", G::from_matrix(x.matrix()), x, size(x));
  }

 private:
  Tangent tangent() const { return draw_tangent<G>(dof_); }
  G element() const { return draw_element<G>(dof_); }
  TangentMatrix unit() const { return TangentMatrix::Identity(dof_, dof_); }
  static Scalar size(const Tangent& xi) { return Scalar(1) + xi.norm(); }
  static Scalar size(const G& x) { return size(x.log()); }

  static typename Wide<G>::Tangent widened(const Tangent& xi) {
    return xi.template cast<typename Wide<G>::Scalar>();
  }
  template <typename Derived>
  static TangentMatrix narrowed(const Eigen::MatrixBase<Derived>& m) {
    return m.template cast<Scalar>();
  }

  /// Two to five elements within 0.8 rad of one, with weights in (0, 1].
  std::pair<std::vector<G>, std::vector<Scalar>> cluster() const {
    const G centre = element();
    const int count = draw_integer(2, 6);
    std::vector<G> elements;
    std::vector<Scalar> weights;
    for (int i = 0; i < count; ++i) {
      elements.push_back(centre * G::exp(Tangent(Scalar(0.25) * tangent())));
      weights.push_back(Scalar(draw_integer(1, 1001)) / Scalar(1000));
    }
    return {elements, weights};
  }

  Eigen::Index dof_;
  MeanSettings exact_{.tolerance = 0.0};
};

/// The laws of `G`; `dof` is needed if it is not known at compile time.
template <LieGroup G>
std::vector<Law> lie_laws(Eigen::Index dof = G::Dof) {
  using Laws = LieLaws<G>;
  const Laws laws(dof);
  const auto law = [&laws](const char* name, void (Laws::*holds)() const) {
    return Law{name, [laws, holds] { (laws.*holds)(); }};
  };
  std::vector<Law> all{
      law("group_axioms", &Laws::group_axioms),
      law("exp_and_log_are_inverse", &Laws::exp_and_log_are_inverse),
      law("exp_is_a_one_parameter_group", &Laws::exp_is_a_one_parameter_group),
      law("adjoint_is_conjugation", &Laws::adjoint_is_conjugation),
      law("ad_is_the_derivative_of_adjoint", &Laws::ad_is_the_derivative_of_adjoint),
      law("jacobians_are_derivatives_of_exp", &Laws::jacobians_are_derivatives_of_exp),
      law("jacobians_are_consistent", &Laws::jacobians_are_consistent),
      law("congruences_are_products", &Laws::congruences_are_products),
      law("volume_factor_is_the_determinant", &Laws::volume_factor_is_the_determinant),
      law("interpolation_follows_the_geodesic", &Laws::interpolation_follows_the_geodesic),
      law("mean_solves_its_equation", &Laws::mean_solves_its_equation),
      law("mean_of_special_sets", &Laws::mean_of_special_sets)};
  if constexpr (MatrixLieGroup<G>) {
    all.push_back(law("matrices_represent_the_group", &Laws::matrices_represent_the_group));
  }
  return all;
}

}  // namespace posemix::testing
