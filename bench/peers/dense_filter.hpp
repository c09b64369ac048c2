// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "dense_lie.hpp"
#include "jobs.hpp"

/// The midway merge and a frame of the Gaussian-sum filter by dense matrices, as the authors of the
/// midway-merge paper wrote them: Joseph form, LU, dense Jacobians.
namespace dense {

template <class S>
struct Hypothesis {
  S weight{};  ///< in an update its logarithm
  std::vector<Pose<S>> mean;
  Matrix<S> covariance;
};

template <class S>
std::vector<double> numbers_of(const Hypothesis<S>& h) {
  std::vector<double> numbers;
  for (const Pose<S>& pose : h.mean) append(numbers, pose);
  append(numbers, h.covariance);
  return numbers;
}

template <class S>
std::vector<Hypothesis<S>> hypotheses(const bench::Jobs& jobs, const std::string& name) {
  const auto weights = jobs.input(name + "_weights");
  const auto poses = poses_of<S>(jobs.input(name + "_poses"));
  const auto covariances = jobs.input(name + "_covariances");
  const std::size_t each = poses.size() / weights.size();
  const auto n = static_cast<Eigen::Index>(6 * each);
  std::vector<Hypothesis<S>> result;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const auto first = poses.begin() + static_cast<std::ptrdiff_t>(i * each);
    const Eigen::Map<const RowMajor> covariance(&covariances[i * 36 * each * each], n, n);
    result.push_back({S(weights[i]),
                      {first, first + static_cast<std::ptrdiff_t>(each)},
                      covariance.template cast<S>()});
  }
  return result;
}

/// Midway-merge paper, eq. 12-19, with block-diagonal Jacobians as dense matrices.
template <class S>
Hypothesis<S> merged(const Hypothesis<S>& a, const Hypothesis<S>& b) {
  const Eigen::Index n = a.covariance.rows();
  const S w_a = a.weight / (a.weight + b.weight);
  const S w_b = 1 - w_a;
  Matrix<S> j_a = Matrix<S>::Zero(n, n);
  Matrix<S> j_b = Matrix<S>::Zero(n, n);
  Vector<S> d(n);
  Hypothesis<S> result{a.weight + b.weight, {}, {}};
  for (Eigen::Index i = 0; i < n / 6; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const Vector6<S> step = log(b.mean[at] * a.mean[at].inverse());
    result.mean.push_back(exp<S>(w_b * step) * a.mean[at]);
    j_a.template block<6, 6>(6 * i, 6 * i) = left_jacobian_inverse<S>(-w_b * step);
    j_b.template block<6, 6>(6 * i, 6 * i) = left_jacobian_inverse<S>(w_a * step);
    d.template segment<6>(6 * i) = step;
  }
  result.covariance = w_a * (j_a * a.covariance * j_a.transpose()) +
                      w_b * (j_b * b.covariance * j_b.transpose()) +
                      S(w_a * w_b) * (d * d.transpose());
  return result;
}

/// One image of the filter: what it knows before, the detections, the components of their noise
/// with weights, and the variances of the camera's step.
template <class S>
struct Frame {
  std::vector<Hypothesis<S>> prior;
  std::vector<Pose<S>> detections;
  std::vector<Vector6<S>> noise;
  std::vector<double> noise_weights;
  Vector6<S> step;

  explicit Frame(const bench::Jobs& jobs)
      : prior(hypotheses<S>(jobs, "frame")),
        detections(poses_of<S>(jobs.input("frame_detections"))),
        noise(vectors_of<S>(jobs.input("frame_noise"))),
        noise_weights(jobs.input("frame_noise_weights")),
        step(vectors_of<S>(jobs.input("frame_step"))[0]) {}
};

/// The measurement of one hypothesis: z = h x + noise of covariance r.
template <class S>
struct Measurement {
  Matrix<S> h, r;
  Vector<S> z;
};

template <class S>
Measurement<S> measurement(const Hypothesis<S>& prior, const Frame<S>& frame,
                           const Vector6<S>& noise) {
  const auto objects = static_cast<Eigen::Index>(frame.detections.size());
  const Pose<S> camera_world = prior.mean[0].inverse();
  const Matrix6<S> back = adjoint(camera_world);
  Measurement<S> m{Matrix<S>::Zero(6 * objects, prior.covariance.rows()),
                   Matrix<S>::Zero(6 * objects, 6 * objects), Vector<S>(6 * objects)};
  for (Eigen::Index j = 0; j < objects; ++j) {
    const auto at = static_cast<std::size_t>(j);
    const Pose<S> seen = camera_world * prior.mean[at + 1];
    const Matrix6<S> carried = adjoint(seen);
    m.h.template block<6, 6>(6 * j, 0) = -back;
    m.h.template block<6, 6>(6 * j, 6 * j + 6) = back;
    m.z.template segment<6>(6 * j) = log(seen * frame.detections[at].inverse());
    m.r.template block<6, 6>(6 * j, 6 * j) = carried * noise.asDiagonal() * carried.transpose();
  }
  return m;
}

/// The update of one hypothesis under one component of the noise.
template <class S>
Hypothesis<S> updated(const Hypothesis<S>& prior, const Frame<S>& frame, std::size_t component) {
  using std::abs;
  using std::log;
  const Eigen::Index n = prior.covariance.rows();
  const auto [h, r, z] = measurement(prior, frame, frame.noise[component]);
  const Matrix<S>& p = prior.covariance;
  const Matrix<S> s = h * p * h.transpose() + r;
  const Eigen::PartialPivLU<Matrix<S>> lu(s);
  const Matrix<S> gain = lu.solve(Matrix<S>(h * p)).transpose();
  const Matrix<S> left = Matrix<S>::Identity(n, n) - gain * h;
  const Vector<S> correction = -(gain * z);
  Hypothesis<S> result;
  result.covariance = left * p * left.transpose() + gain * r * gain.transpose();
  for (Eigen::Index i = 0; i < n / 6; ++i) {
    const Vector6<S> step = correction.template segment<6>(6 * i);
    result.mean.push_back(exp(step) * prior.mean[static_cast<std::size_t>(i)]);
  }
  S log_determinant(0);
  for (Eigen::Index i = 0; i < s.rows(); ++i) log_determinant += log(abs(lu.matrixLU()(i, i)));
  const S squared = z.dot(lu.solve(z));
  result.weight =
      log(prior.weight) + log(S(frame.noise_weights[component])) - (log_determinant + squared) / 2;
  return result;
}

template <class S>
bool lighter(const Hypothesis<S>& a, const Hypothesis<S>& b) {
  return a.weight < b.weight;
}

/// All children of all hypotheses, with normalised weights.
template <class S>
std::vector<Hypothesis<S>> children(const Frame<S>& frame) {
  using std::exp;
  std::vector<Hypothesis<S>> all;
  for (Hypothesis<S> h : frame.prior) {
    const Matrix6<S> ad = adjoint(h.mean[0]);
    h.covariance.template topLeftCorner<6, 6>() += ad * frame.step.asDiagonal() * ad.transpose();
    for (std::size_t k = 0; k < frame.noise.size(); ++k) all.push_back(updated(h, frame, k));
  }
  const S largest = std::max_element(all.begin(), all.end(), lighter<S>)->weight;
  S sum(0);
  for (Hypothesis<S>& h : all) sum += h.weight = exp(S(h.weight - largest));
  for (Hypothesis<S>& h : all) h.weight /= sum;
  return all;
}

/// Predict, update, merge the heaviest with the lightest to as many as before, and last the two
/// heaviest to the estimate.
template <class S>
Hypothesis<S> frame_of(const Frame<S>& frame) {
  std::vector<Hypothesis<S>> all = children(frame);
  while (all.size() > frame.prior.size()) {
    const auto [light, heavy] = std::minmax_element(all.begin(), all.end(), lighter<S>);
    Hypothesis<S> one = merged(*heavy, *light);
    *heavy = std::move(one);
    all.erase(light);
  }
  std::partial_sort(all.begin(), all.begin() + 2, all.end(),
                    [](const auto& a, const auto& b) { return lighter(b, a); });
  return merged(all[0], all[1]);
}

}  // namespace dense
