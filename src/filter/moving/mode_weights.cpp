// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <utility>

#include "moving_object_state.hpp"

namespace posemix::internal {

ModeWeights::ModeWeights(Eigen::Index models, Eigen::Index modes)
    : right(Eigen::ArrayXXd::Zero(models, modes)),
      runs{{.place = kAnyPlace, .weight = Eigen::ArrayXd::Zero(models)}} {}

Eigen::ArrayXd ModeWeights::by_model() const {
  Eigen::ArrayXd sum = right.rowwise().sum();
  for (const WrongRun& run : runs) sum += run.weight;
  return sum;
}

ModeWeights& ModeWeights::operator*=(double factor) {
  right *= factor;
  for (WrongRun& run : runs) run.weight *= factor;
  return *this;
}

void ModeWeights::scale(const Eigen::ArrayXd& factor) {
  right.colwise() *= factor;
  for (WrongRun& run : runs) run.weight *= factor;
}

void ModeWeights::add(const ModeWeights& other) {
  right += other.right;
  for (const WrongRun& run : other.runs) run_at(run.place) += run.weight;
}

void ModeWeights::change_models(const Eigen::MatrixXd& transition) {
  right = (transition.transpose() * right.matrix()).array().eval();
  for (WrongRun& run : runs)
    run.weight = (transition.transpose() * run.weight.matrix()).array().eval();
}

void ModeWeights::draw_modes(double stay, const DetectorModes& modes, double in_run,
                             double recurring, std::span<const std::uint64_t> places) {
  const Eigen::ArrayXd anew = (1.0 - stay) * by_model();
  *this *= stay;
  for (Eigen::Index m = 0; m < right.cols(); ++m)
    right.col(m) += (1.0 - in_run) * modes.share(static_cast<std::size_t>(m)) * anew;
  const double again = places.empty() ? 0.0 : recurring;
  runs.front().weight += (1.0 - again) * in_run * anew;
  for (const std::uint64_t place : places)
    run_at(place) += again / static_cast<double>(places.size()) * in_run * anew;
}

Eigen::ArrayXd& ModeWeights::run_at(std::uint64_t place) {
  const auto run = std::find_if(runs.begin(), runs.end(),
                                [&](const WrongRun& other) { return other.place == place; });
  if (run != runs.end()) return run->weight;
  runs.push_back({.place = place, .weight = Eigen::ArrayXd::Zero(right.rows())});
  return runs.back().weight;
}

void ModeWeights::redirect(std::uint64_t from, std::uint64_t to, bool own) {
  const auto run = std::find_if(runs.begin(), runs.end(),
                                [&](const WrongRun& other) { return other.place == from; });
  if (run == runs.end()) return;
  const Eigen::ArrayXd weight = run->weight;
  runs.erase(run);
  if (own) {
    right.col(0) += weight;
  } else {
    run_at(to) += weight;
  }
}

void ModeWeights::divide(std::uint64_t place, std::span<const PlaceShare> shares) {
  const auto at = [&](std::uint64_t wanted) {
    return std::find_if(runs.begin(), runs.end(),
                        [&](const WrongRun& run) { return run.place == wanted; });
  };
  if (at(place) == runs.end()) return;
  const WrongRun whole = *at(place);
  at(place)->weight.setZero();
  for (const auto& [to, share] : shares) {
    WrongRun part = whole;
    part.place = to;
    part.weight *= share;
    if (const auto known = at(to); known != runs.end()) {
      known->weight += part.weight;
    } else {
      runs.push_back(std::move(part));
    }
  }
}

std::size_t MovingHypothesis::best_model() const {
  Eigen::Index best = 0;
  weights.by_model().maxCoeff(&best);
  return static_cast<std::size_t>(best);
}

}  // namespace posemix::internal
