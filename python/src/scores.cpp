// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/grasp/scores.hpp"

#include "array_like.hpp"
#include "posemix/grasp/calibration.hpp"
#include "record.hpp"
#include "settings.hpp"

namespace posemix::python {
namespace {

Eigen::VectorXd checked_probabilities(const ArrayLike& values) {
  Eigen::VectorXd probabilities = values.flat();
  for (Eigen::Index i = 0; i < probabilities.size(); ++i) {
    if (!(probabilities[i] >= 0.0 && probabilities[i] <= 1.0)) {
      throw InvalidInput(
          fmt::format("probability {} is {}; expected a number in [0, 1]", i, probabilities[i]));
    }
  }
  return probabilities;
}

std::vector<ScoredPrediction> predictions_of(const ArrayLike& probabilities,
                                             const ArrayLike& successes,
                                             const std::optional<ArrayLike>& groups = {}) {
  const Eigen::VectorXd p = checked_probabilities(probabilities);
  const std::vector<bool> won = successes.flags();
  const std::vector<std::size_t> members = groups ? groups->indices() : std::vector<std::size_t>();
  const auto n = static_cast<std::size_t>(p.size());
  if (won.size() != n || (groups && members.size() != n)) {
    throw InvalidInput(fmt::format("{} probabilities, {} successes and {} groups; expected as many",
                                   n, won.size(), members.size()));
  }
  std::vector<ScoredPrediction> all;
  for (std::size_t i = 0; i < n; ++i)
    all.push_back({p[static_cast<Eigen::Index>(i)], won[i], groups ? members[i] : 0});
  return all;
}

constexpr const char* kBrierDoc = R"(Mean squared difference of probability and outcome.

Examples
--------
>>> from posemix import brier_score
>>> round(brier_score([0.9, 0.2], [True, False]), 3)
0.025
)";

constexpr const char* kAucDoc =
    R"(Probability that a success got a larger probability than a failure of the same group.

Parameters
----------
probabilities, successes : array_like, shape (n,)
    Predictions and outcomes.
groups : array_like of int, shape (n,), optional
    Groups of the predictions; only predictions of the same group are compared. A single group unless given.

Returns
-------
float
    The probability, in which ties count half; NaN if no group has both outcomes.
)";

void bind_score_functions(nb::module_& m) {
  const auto def = [&](const char* name, auto score, const char* doc) {
    m.def(
        name,
        [score](const ArrayLike& p, const ArrayLike& s) { return score(predictions_of(p, s)); },
        "probabilities"_a, "successes"_a, doc);
  };
  const auto def_binned = [&](const char* name, auto score, const char* doc) {
    m.def(
        name,
        [score](const ArrayLike& p, const ArrayLike& s, std::size_t bins) {
          return score(predictions_of(p, s), bins);
        },
        "probabilities"_a, "successes"_a, "bins"_a = 10, doc);
  };
  def(
      "brier_score", [](const auto& all) { return brier_score(all); }, kBrierDoc);
  def(
      "log_loss", [](const auto& all) { return log_loss(all); },
      "Mean of -log of the probability given to the outcome, which is taken as at least 1e-9 "
      "[nats].");
  def(
      "accuracy", [](const auto& all) { return accuracy(all); },
      "Fraction of predictions on the right side of one half (one half predicts success).");
  def(
      "fit_platt", [](const auto& all) { return fit_platt(all); },
      "The maximum a posteriori calibration, with normal priors about slope 1 and bias 0.");
  m.def(
      "auc_within_groups",
      [](const ArrayLike& p, const ArrayLike& s, const std::optional<ArrayLike>& groups) {
        return auc_within_groups(predictions_of(p, s, groups));
      },
      "probabilities"_a, "successes"_a, "groups"_a = nb::none(), kAucDoc);
  def_binned(
      "reliability", [](const auto& all, auto bins) { return reliability(all, bins); },
      "The bins of a reliability diagram, of equal width over [0, 1].");
  def_binned(
      "calibration_error", [](const auto& all, auto bins) { return calibration_error(all, bins); },
      "Mean over the predictions of the difference of success rate and mean probability in their "
      "bin.");
}

void bind_records(nb::module_& m) {
  using B = ReliabilityBin;
  Record<B>(m, "ReliabilityBin",
            "Predictions in one bin of a reliability diagram; the means of an empty bin are NaN.")
      .field("count", &B::count, "int", "Number of predictions.")
      .field("mean_probability", &B::mean_probability, "float", "Mean of the predictions.")
      .field("success_rate", &B::success_rate, "float", "Fraction of successes.")
      .done();
  using P = PlattCalibration;
  Record<P>(m, "PlattCalibration",
            "Platt's calibration: logit of the calibrated probability = slope * logit of the raw "
            "one + bias.\n\nRaw probabilities are clipped to [0.001, 0.999].")
      .field("slope", &P::slope, "float", "Slope; 1 leaves the logit as it is.")
      .field("bias", &P::bias, "float", "Bias; 0 leaves the logit as it is.")
      .constructible(0)
      .done()
      .def(
          "__call__",
          [](const P& self, const ArrayLike& probabilities) {
            const Eigen::VectorXd raw = checked_probabilities(probabilities);
            NewArray out(probabilities.shape());
            for (Eigen::Index i = 0; i < raw.size(); ++i) out.data[i] = self(raw[i]);
            return std::move(out.array);
          },
          "probabilities"_a, "The calibrated probabilities, in the shape of `probabilities`.");
}

constexpr const char* kLogisticDoc = R"(The maximum a posteriori logistic model of outcomes.

Parameters
----------
features : array_like, shape (n, features)
    Features; row i belongs to outcome i.
successes : array_like of bool, shape (n,)
    Outcomes.
settings : LogisticSettings, optional
    The prior.

Raises
------
ValueError
    When sizes differ.
)";

void bind_logistic(nb::module_& m) {
  using S = LogisticSettings;
  Settings<S>(m, "LogisticSettings", "Settings of `fit_logistic`: a normal prior.")
      .field("weights_mean", &S::weights_mean, "numpy.typing.ArrayLike",
             "Mean of the weights, shape (features,); zero where empty.")
      .field("bias_mean", &S::bias_mean, "float", "Mean of the bias.")
      .field("weights_sd", &S::weights_sd, "float", "Standard deviation of every weight.")
      .field("bias_sd", &S::bias_sd, "float", "Standard deviation of the bias.")
      .field("max_iterations", &S::max_iterations, "int", "Newton steps at most.")
      .done();
  using M = LogisticModel;
  Record<M>(m, "LogisticModel",
            "A logistic model, P(success) = s(bias + weights . x) with the logistic function s.")
      .field("weights", &M::weights, kFloatArray, "Weights of the features, shape (features,).")
      .field("bias", &M::bias, "float", "Log odds if all features are zero.")
      .constructible(2)
      .done()
      .def(
          "probability",
          [](const M& self, const ArrayLike& features) {
            const auto n = static_cast<std::size_t>(self.weights.size());
            const ShapedRows given(features, n, "features");
            NewArray out(given.shape);
            for (std::size_t i = 0; i < given.rows.shape(0); ++i)
              out.data[i] = self.probability(Eigen::Map<const Eigen::VectorXd>(
                  given.rows.data() + i * n, self.weights.size()));
            return std::move(out.array);
          },
          "features"_a, "Probabilities for features of shape (..., features), shape (...).");
  m.def(
      "fit_logistic",
      [](const ArrayLike& features, const ArrayLike& successes, const std::optional<S>& settings) {
        const auto rows = features.as<Eigen::MatrixXd>("features");
        if (!rows.allFinite()) throw InvalidInput("features are not all finite");
        return fit_logistic(rows, successes.flags(), settings.value_or(S{}));
      },
      "features"_a, "successes"_a, "settings"_a = nb::none(), kLogisticDoc);
}

}  // namespace

void bind_scores(nb::module_& m) {
  bind_records(m);
  bind_score_functions(m);
  bind_logistic(m);
}

}  // namespace posemix::python
