// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cmath>
#include <tuple>

#include <fmt/ranges.h>
#include <nanobind/stl/tuple.h>

#include "array_like.hpp"
#include "density.hpp"
#include "posemix/detector/error_mixture.hpp"
#include "posemix/grasp/calibration.hpp"
#include "posemix/grasp/scores.hpp"
#include "poses.hpp"
#include "record.hpp"
#include "seed.hpp"
#include "settings.hpp"

namespace posemix::python {
namespace {

std::vector<Vector6d> errors_of(const Rows& rows) {
  require_columns(rows, 6, "errors");
  std::vector<Vector6d> errors;
  for (std::size_t i = 0; i < rows.shape(0); ++i)
    errors.emplace_back(Eigen::Map<const Vector6d>(rows.data() + 6 * i));
  return errors;
}

Array rows_of(const std::vector<Vector6d>& errors) {
  NewArray out({errors.size(), 6});
  for (std::size_t i = 0; i < errors.size(); ++i)
    Eigen::Map<Vector6d>(out.data + 6 * i) = errors[i];
  return std::move(out.array);
}

ErrorMixture mixture_of(const std::vector<double>& log_weights, const Rows& means,
                        const Matrices& covariances) {
  const std::vector<Vector6d> centres = errors_of(means);
  if (centres.size() != log_weights.size() || covariances.shape(0) != log_weights.size() ||
      covariances.shape(1) != 6 || covariances.shape(2) != 6) {
    throw InvalidInput(
        fmt::format("{} weights, {} means and {} covariances of {} x {}; expected as "
                    "many of each, 6 x 6",
                    log_weights.size(), centres.size(), covariances.shape(0), covariances.shape(1),
                    covariances.shape(2)));
  }
  std::vector<Component<ErrorMixture::Gaussian>> components;
  for (std::size_t i = 0; i < centres.size(); ++i) {
    const Matrix6d covariance = Eigen::Map<const Matrix6d>(covariances.data() + 36 * i);
    components.push_back({log_weights[i], ErrorMixture::Gaussian(Rnd<6>(centres[i]), covariance)});
  }
  return ErrorMixture(Mixture<ErrorMixture::Gaussian>::from_stored(std::move(components)));
}

nb::tuple parts_of(const ErrorMixture& errors) {
  const auto& mixture = errors.mixture();
  NewArray logs({mixture.size()});
  NewArray means({mixture.size(), 6});
  NewArray covariances({mixture.size(), 6, 6});
  for (std::size_t i = 0; i < mixture.size(); ++i) {
    logs.data[i] = mixture[i].log_weight;
    Eigen::Map<Vector6d>(means.data + 6 * i) = mixture[i].density.mean().log();
    Eigen::Map<Matrix6d>(covariances.data + 36 * i) = mixture[i].density.covariance();
  }
  return nb::make_tuple(std::move(logs.array), std::move(means.array),
                        std::move(covariances.array));
}

std::vector<Vector6d> finite_errors(const ArrayLike& values) {
  std::vector<Vector6d> errors = errors_of(ShapedRows(values, 6, "errors").rows);
  for (std::size_t i = 0; i < errors.size(); ++i)
    if (!errors[i].allFinite())
      throw InvalidInput(fmt::format("error {} is not finite; expected finite numbers", i));
  return errors;
}

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

ErrorMixture unit_mixture() {
  return ErrorMixture(Mixture<ErrorMixture::Gaussian>(
      {{0.0, ErrorMixture::Gaussian(Rnd<6>(Vector6d::Zero()), Matrix6d::Identity())}}));
}

/// f(error) for every error of an array of any shape.
template <class Function>
Array each_error(const ArrayLike& errors, Function f) {
  const ShapedRows given(errors, 6, "errors");
  NewArray out(given.shape);
  const nb::gil_scoped_release unlocked;
  for (std::size_t i = 0; i < given.rows.shape(0); ++i)
    out.data[i] = f(Vector6d(Eigen::Map<const Vector6d>(given.rows.data() + 6 * i)));
  return std::move(out.array);
}

constexpr const char* kErrorMixtureDoc =
    R"(A mixture of Gaussians over errors in the form of `sight_error`.

Parameters
----------
weights : array_like, shape (k,)
    Weights, not negative; they are normalised.
means : array_like, shape (k, 6)
    Means: rotation vector [rad], displacement [m].
covariances : array_like, shape (k, 6, 6)
    Covariances, symmetric positive definite.

Raises
------
ValueError
    For weights that are negative or all zero, numbers of weights, means and covariances that differ, and
    matrices that are not positive definite.
)";

void bind_error_mixture(nb::module_& m) {
  using M = ErrorMixture;
  using Parts = std::tuple<std::vector<double>, Rows, Matrices>;
  const auto part = [](std::size_t i) {
    return [i](const M& self) { return nb::object(parts_of(self)[i]); };
  };
  nb::class_<M>(m, "ErrorMixture", kErrorMixtureDoc)
      .def(
          "__init__",
          [](M* self, const ArrayLike& weights, const ArrayLike& means,
             const ArrayLike& covariances) {
            const nb::object logs =
                nb::module_::import_("posemix.mixture").attr("log_of_weights")(weights);
            const nb::module_ numpy = nb::module_::import_("numpy");
            new (self) M(mixture_of(
                nb::cast<std::vector<double>>(logs.attr("tolist")()),
                ShapedRows(means, 6, "means").rows,
                nb::cast<Matrices>(numpy.attr("asarray")(covariances, "dtype"_a = "float64"))));
          },
          "weights"_a, "means"_a, "covariances"_a)
      .def_prop_ro(
          "weights",
          [](const M& self) {
            Eigen::VectorXd weights(std::ssize(self.mixture()));
            for (std::size_t i = 0; i < self.mixture().size(); ++i)
              weights[static_cast<Eigen::Index>(i)] = std::exp(self.mixture()[i].log_weight);
            return vector_array(weights);
          },
          nb::rv_policy::move, "Weights of the components, shape (k,).")
      .def_prop_ro("means", part(1),
                   nb::for_getter(nb::sig("def means(self, /) -> "
                                          "numpy.typing.NDArray[numpy.float64]")),
                   "Means of the components, shape (k, 6) [rad, m].")
      .def_prop_ro("covariances", part(2),
                   nb::for_getter(nb::sig("def covariances(self, /) -> "
                                          "numpy.typing.NDArray[numpy.float64]")),
                   "Covariances of the components, shape (k, 6, 6).")
      .def("__len__", [](const M& self) { return self.mixture().size(); })
      .def(
          "log_density",
          [](const M& self, const ArrayLike& errors) {
            return each_error(errors, [&](const Vector6d& e) { return self.log_density(e); });
          },
          "errors"_a, "Log of the density at errors (..., 6) in the six coordinates [nats].")
      .def(
          "log_pose_density",
          [](const M& self, const ArrayLike& errors) {
            return each_error(errors, [&](const Vector6d& e) { return self.log_pose_density(e); });
          },
          "errors"_a,
          "Log of the density of the true pose, with respect to the Haar measure, shape (...) "
          "[nats].")
      .def(
          "sample",
          [](const M& self, std::size_t count, const Seed& seed) {
            NewArray out({count, 6});
            for (std::size_t i = 0; i < count; ++i)
              Eigen::Map<Vector6d>(out.data + 6 * i) = self.sample(seed.stream());
            return std::move(out.array);
          },
          "count"_a, "seed"_a, "Draws, shape (count, 6).")
      .def("__getstate__", &parts_of)
      .def("__setstate__",
           [](M& self, const Parts& parts) {
             new (&self) M(mixture_of(std::get<0>(parts), std::get<1>(parts), std::get<2>(parts)));
           })
      .def(
          "__eq__",
          [](const M& self, nb::handle other) {
            if (!nb::isinstance<M>(other)) return false;
            const nb::object same = nb::module_::import_("numpy").attr("array_equal");
            const nb::tuple a = parts_of(self);
            const nb::tuple b = parts_of(*nb::inst_ptr<M>(other));
            return nb::cast<bool>(same(a[0], b[0])) && nb::cast<bool>(same(a[1], b[1])) &&
                   nb::cast<bool>(same(a[2], b[2]));
          },
          nb::sig("def __eq__(self, other: object, /) -> bool"))
      .def("__repr__", [](const M& self) {
        std::vector<double> weights;
        for (const auto& component : self.mixture().components())
          weights.push_back(std::exp(component.log_weight));
        return fmt::format("ErrorMixture of {}, weights [{:.4g}]", weights.size(),
                           fmt::join(weights, ", "));
      });
  m.attr("ErrorMixture").attr("__hash__") = nb::none();
  m.def("sight_error", [](const PoseArray& estimates, const PoseArray& truths) {
    NewArray out({estimates.size(), 6});
    for (std::size_t i = 0; i < estimates.size(); ++i)
      Eigen::Map<Vector6d>(out.data + 6 * i) = sight_error(estimates[i], truths[i]);
    return std::move(out.array);
  });
  m.def("truth_with_error", [](const PoseArray& estimates, const Rows& errors) {
    const std::vector<Vector6d> all = errors_of(errors);
    NewArray out({estimates.size(), 7});
    for (std::size_t i = 0; i < estimates.size(); ++i)
      Wire<SE3d>::write(truth_with_error(estimates[i], all.at(i)), out.data + 7 * i);
    return PoseArray::of(std::move(out.array), estimates.shape);
  });
}

constexpr const char* kFitErrorsDoc =
    R"(Fits mixtures of 1, 2, ... components and a wide one for outliers, and returns the one with the least BIC.

Parameters
----------
errors : array_like, shape (n, 6)
    Errors in the form of `sight_error`, at least 8.
seed : int or RandomStream
    Seed of the starts.
settings : ErrorMixtureSettings, optional
    Priors, width of the outliers, stopping criteria.

Raises
------
ValueError
    For fewer than 8 errors, and errors that are not finite.
)";

constexpr const char* kTrimmedDoc =
    R"(The errors within `trim` robust standard deviations of the median on every axis.

Parameters
----------
errors : array_like, shape (n, 6)
    Errors.
trim : float
    Robust standard deviations, 1.4826 times the median distance from the median.

Returns
-------
ndarray, shape (m, 6)
    All errors if fewer than 8 are within.
)";

void bind_error_fit(nb::module_& m) {
  using S = ErrorMixtureSettings;
  Settings<S>(m, "ErrorMixtureSettings", "Settings of `fit_error_mixture`.")
      .field("max_components", &S::max_components, "int", "Full ones, besides the outliers'.")
      .field("prior_count", &S::prior_count, "float",
             "Samples that the prior of a covariance counts as.")
      .field("prior_scale", &S::prior_scale, "float",
             "Its value, in diagonal covariances of the trimmed errors.")
      .field("outlier_rotation_sd_deg", &S::outlier_rotation_sd_deg, "float", "About every axis.")
      .field("outlier_translation_sd_m", &S::outlier_translation_sd_m, "float", "Along every axis.")
      .field("trim", &S::trim, "float",
             "Robust standard deviations beyond which an error is an outlier.")
      .field("restarts", &S::restarts, "int", "Starts at every number of components.")
      .field("max_iterations", &S::max_iterations, "int", "Of a run.")
      .field("tolerance", &S::tolerance, "float",
             "Gain per error and iteration that ends a run [nats].")
      .done();
  using F = ErrorMixtureFit;
  Record<F>(m, "ErrorMixtureFit", "A fitted mixture.")
      .made_from([] {
        return F{unit_mixture(), 0, 0.0, 0.0, {}};
      })
      .field("errors", &F::errors, "ErrorMixture",
             "The mixture; its last component is that of outliers.")
      .field("components", &F::components, "int", "Number of components without that of outliers.")
      .field("log_likelihood", &F::log_likelihood, "float", "Log-likelihood of the errors [nats].")
      .field("bic", &F::bic, "float",
             "The BIC, which is the smallest of all numbers of components that were tried.")
      .field("history", &F::history, "list[float]",
             "Log posterior after every iteration of the run that was kept.")
      .done();
  m.def(
      "fit_error_mixture",
      [](const ArrayLike& errors, const Seed& seed, const std::optional<S>& settings) {
        const std::vector<Vector6d> all = finite_errors(errors);
        const nb::gil_scoped_release unlocked;
        return fit_error_mixture(all, settings.value_or(S{}), seed.stream());
      },
      "errors"_a, "seed"_a, "settings"_a = nb::none(), kFitErrorsDoc);
  m.def(
      "fit_error_gaussian",
      [](const ArrayLike& errors) { return fit_error_gaussian(finite_errors(errors)); }, "errors"_a,
      "One Gaussian with the mean and covariance of at least 8 errors, shape (n, 6).");
  m.def(
      "trimmed_errors",
      [](const ArrayLike& errors, double trim) {
        return rows_of(trimmed_errors(finite_errors(errors), trim));
      },
      "errors"_a, "trim"_a = 5.0, kTrimmedDoc);
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

void bind_scores(nb::module_& m) {
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
      .field("slope", &P::slope, "float", "1 leaves the logit as it is.")
      .field("bias", &P::bias, "float", "0 leaves the logit as it is.")
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
  bind_score_functions(m);
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
             "Shape (features,); zero where empty.")
      .field("bias_mean", &S::bias_mean, "float", "Of the bias.")
      .field("weights_sd", &S::weights_sd, "float", "Of every weight.")
      .field("bias_sd", &S::bias_sd, "float", "Of the bias.")
      .field("max_iterations", &S::max_iterations, "int", "Newton steps at most.")
      .done();
  using M = LogisticModel;
  Record<M>(m, "LogisticModel",
            "A logistic model, P(success) = s(bias + weights . x) with the logistic function s.")
      .field("weights", &M::weights, kFloatArray, "One per feature, shape (features,).")
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

void bind_errors(nb::module_& m) {
  bind_error_mixture(m);
  bind_error_fit(m);
  bind_scores(m);
  bind_logistic(m);
}

}  // namespace posemix::python
