// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "dense_filter.hpp"

/// Mixtures in plain Eigen: reduction by merging the cheapest pair, and EM on vectors.
namespace dense {

/// Two densities on SE(3) as Gaussians in the tangent space at a point between their means.
template <class S>
struct Tangents {
  Matrix6<S> p, q;
  Vector6<S> d;

  /// `part` of the way from a to b.
  Tangents(const Hypothesis<S>& a, const Hypothesis<S>& b, S part) {
    d = log(b.mean[0] * a.mean[0].inverse());
    const Matrix6<S> j_a = left_jacobian_inverse<S>(-part * d);
    const Matrix6<S> j_b = left_jacobian_inverse<S>((1 - part) * d);
    p = j_a * a.covariance * j_a.transpose();
    q = j_b * b.covariance * j_b.transpose();
  }
};

/// Runnalls' bound on the loss of a merge (Runnalls 2007).
struct Runnalls {
  template <class S>
  S operator()(const Hypothesis<S>& a, const Hypothesis<S>& b) const {
    const S sum = a.weight + b.weight;
    const S part = b.weight / sum;
    const Tangents<S> at(a, b, part);
    const Matrix6<S> both =
        (1 - part) * at.p + part * at.q + (part * (1 - part)) * at.d * at.d.transpose();
    return (sum * std::log(both.determinant()) - a.weight * std::log(at.p.determinant()) -
            b.weight * std::log(at.q.determinant())) /
           2;
  }
};

/// D(p || q) + D(q || p) in the tangent space halfway.
struct SymmetricKl {
  template <class S>
  S operator()(const Hypothesis<S>& a, const Hypothesis<S>& b) const {
    const Tangents<S> at(a, b, S(0.5));
    const Matrix6<S> p = at.p.inverse();
    const Matrix6<S> q = at.q.inverse();
    return ((p * at.q).trace() + (q * at.p).trace() - 12 + at.d.dot((p + q) * at.d)) / 2;
  }
};

/// Merges the pair of least cost until `left` are left. Costs that a merge does not touch are kept.
template <class S, class Cost>
std::vector<Hypothesis<S>> reduced(std::vector<Hypothesis<S>> all, std::size_t left,
                                   const Cost& cost) {
  const auto count = static_cast<Eigen::Index>(all.size());
  const auto of = [&](Eigen::Index i) -> Hypothesis<S>& {
    return all[static_cast<std::size_t>(i)];
  };
  constexpr S kNever = std::numeric_limits<S>::infinity();
  Matrix<S> costs = Matrix<S>::Constant(count, count, kNever);
  std::vector<Eigen::Index> alive;
  for (Eigen::Index j = 0; j < count; ++j) {
    for (const Eigen::Index i : alive) costs(i, j) = cost(of(i), of(j));
    alive.push_back(j);
  }
  while (alive.size() > left) {
    Eigen::Index a = 0;
    Eigen::Index b = 0;
    costs.minCoeff(&a, &b);
    of(a) = merged(of(a), of(b));
    costs.row(b).setConstant(kNever);
    costs.col(b).setConstant(kNever);
    std::erase(alive, b);
    for (const Eigen::Index other : alive) {
      if (other < a) costs(other, a) = cost(of(other), of(a));
      if (other > a) costs(a, other) = cost(of(a), of(other));
    }
  }
  std::vector<Hypothesis<S>> result;
  for (const Eigen::Index i : alive) result.push_back(of(i));
  return result;
}

/// The mixture as weights, poses and covariances, each component after the other.
template <class S>
std::vector<double> numbers_of(const std::vector<Hypothesis<S>>& mixture) {
  S sum(0);
  for (const auto& h : mixture) sum += h.weight;
  std::vector<double> numbers;
  for (const auto& h : mixture) {
    numbers.push_back(static_cast<double>(h.weight / sum));
    const auto rest = numbers_of(h);
    numbers.insert(numbers.end(), rest.begin(), rest.end());
  }
  return numbers;
}

/// log sum exp of the rows of terms.
template <class S>
S log_sum_exp(const Vector<S>& terms) {
  using std::log;
  const S largest = terms.maxCoeff();
  return largest + log((terms.array() - largest).exp().sum());
}

/// Components of a mixture on R^6.
template <class S>
struct VectorMixture {
  std::vector<S> weights;
  std::vector<Vector6<S>> means;
  std::vector<Matrix6<S>> covariances;

  std::size_t size() const { return weights.size(); }
};

template <class S>
std::vector<double> numbers_of(const VectorMixture<S>& mixture) {
  std::vector<double> numbers;
  for (std::size_t k = 0; k < mixture.size(); ++k) {
    numbers.push_back(static_cast<double>(mixture.weights[k]));
    append(numbers, mixture.means[k]);
    append(numbers, mixture.covariances[k]);
  }
  return numbers;
}

/// Factors of the components: what a density is whitened with, and its constant. Weights of any
/// sum.
template <class S>
struct Whitening {
  std::vector<Matrix6<S>> roots;  ///< inverses of Cholesky's factors
  Vector<S> constants;            ///< log w - log det P / 2 - 3 log 2 pi

  Whitening(const std::vector<S>& weights, const std::vector<Matrix6<S>>& covariances)
      : constants(static_cast<Eigen::Index>(weights.size())) {
    using std::acos;
    using std::log;
    const S pi = acos(S(-1));  // std::numbers has none of 34 digits
    const S sum = std::accumulate(weights.begin(), weights.end(), S(0));
    for (std::size_t k = 0; k < weights.size(); ++k) {
      const Matrix6<S> root = Eigen::LLT<Matrix6<S>>(covariances[k]).matrixL();
      roots.emplace_back(root.inverse());
      constants(static_cast<Eigen::Index>(k)) =
          log(weights[k] / sum) - root.diagonal().array().log().sum() - 3 * log(2 * pi);
    }
  }
};

/// Log densities on SE(3), with respect to the Haar measure |det J_l| dxi.
template <class S>
std::vector<double> log_densities(const std::vector<Hypothesis<S>>& mixture,
                                  const std::vector<Pose<S>>& at) {
  using std::log;
  std::vector<S> weights;
  std::vector<Matrix6<S>> covariances;
  std::vector<Pose<S>> back;
  for (const auto& h : mixture) {
    weights.push_back(h.weight);
    covariances.emplace_back(h.covariance);
    back.push_back(h.mean[0].inverse());
  }
  const Whitening<S> whitening(weights, covariances);
  Vector<S> terms(whitening.constants.size());
  std::vector<double> result;
  for (const Pose<S>& x : at) {
    for (std::size_t k = 0; k < mixture.size(); ++k) {
      const Vector6<S> xi = dense::log(x * back[k]);
      const S volume = 2 * log(2 * Coefficients<S>(xi.template head<3>().squaredNorm()).b);
      const auto i = static_cast<Eigen::Index>(k);
      terms(i) = whitening.constants(i) - (whitening.roots[k] * xi).squaredNorm() / 2 - volume;
    }
    result.push_back(static_cast<double>(log_sum_exp(terms)));
  }
  return result;
}

template <class S>
using Samples = Eigen::Matrix<S, 6, Eigen::Dynamic>;
constexpr Eigen::Index kBlock = 512;  ///< so many samples stay in the cache

/// The logs of weight times density of every component (columns) at a block of samples (rows).
template <class S, class Block>
Matrix<S> log_terms(const VectorMixture<S>& mixture, const Whitening<S>& whitening,
                    const Block& block) {
  Matrix<S> terms(block.cols(), whitening.constants.size());
  Samples<S> d(6, block.cols());
  for (std::size_t k = 0; k < mixture.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    d.noalias() = whitening.roots[k] * (block.colwise() - mixture.means[k]);
    terms.col(i) = (whitening.constants(i) - d.colwise().squaredNorm().array() / 2).transpose();
  }
  return terms;
}

/// Log densities on R^6.
template <class S>
std::vector<double> log_densities(const VectorMixture<S>& mixture, const Samples<S>& samples) {
  const Whitening<S> whitening(mixture.weights, mixture.covariances);
  std::vector<double> result;
  for (Eigen::Index first = 0; first < samples.cols(); first += kBlock) {
    const auto block = samples.middleCols(first, std::min(kBlock, samples.cols() - first));
    const Matrix<S> terms = log_terms(mixture, whitening, block);
    const Vector<S> largest = terms.rowwise().maxCoeff();
    const Vector<S> sums =
        largest.array() + (terms.colwise() - largest).array().exp().rowwise().sum().log();
    append(result, sums);
  }
  return result;
}

/// One iteration of EM by products of matrices.
template <class S>
VectorMixture<S> em_iteration(const VectorMixture<S>& before, const Samples<S>& samples) {
  const Whitening<S> whitening(before.weights, before.covariances);
  VectorMixture<S> sums{std::vector<S>(before.size(), S(0)),
                        std::vector<Vector6<S>>(before.size(), Vector6<S>::Zero()),
                        std::vector<Matrix6<S>>(before.size(), Matrix6<S>::Zero())};
  for (Eigen::Index first = 0; first < samples.cols(); first += kBlock) {
    const auto block = samples.middleCols(first, std::min(kBlock, samples.cols() - first));
    Matrix<S> shares = log_terms(before, whitening, block);
    const Vector<S> largest = shares.rowwise().maxCoeff();
    shares = (shares.colwise() - largest).array().exp();
    const Vector<S> total = shares.rowwise().sum();
    shares.array().colwise() /= total.array();
    for (std::size_t k = 0; k < before.size(); ++k) {
      const auto share = shares.col(static_cast<Eigen::Index>(k));
      const Samples<S> shared = block * share.asDiagonal();
      sums.weights[k] += share.sum();
      sums.means[k] += shared.rowwise().sum();
      sums.covariances[k].noalias() += shared * block.transpose();
    }
  }
  for (std::size_t k = 0; k < before.size(); ++k) {
    sums.means[k] /= sums.weights[k];
    sums.covariances[k] =
        (sums.covariances[k] / sums.weights[k] - sums.means[k] * sums.means[k].transpose()).eval();
    sums.weights[k] /= S(samples.cols());
  }
  return sums;
}

}  // namespace dense
