// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "errors.hpp"
#include "record.hpp"
#include "seed.hpp"
#include "settings.hpp"

namespace posemix::python {
namespace {

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

}  // namespace

void bind_error_fit(nb::module_& m) {
  using S = ErrorMixtureSettings;
  Settings<S>(m, "ErrorMixtureSettings", "Settings of `fit_error_mixture`.")
      .field("max_components", &S::max_components, "int",
             "Largest number of components, besides that of outliers.")
      .field("prior_count", &S::prior_count, "float",
             "Samples that the prior of a covariance counts as.")
      .field("prior_scale", &S::prior_scale, "float",
             "Value of the prior, in diagonal covariances of the trimmed errors.")
      .field("outlier_rotation_sd_deg", &S::outlier_rotation_sd_deg, "float",
             "Standard deviation of the outliers about every axis [deg].")
      .field("outlier_translation_sd_m", &S::outlier_translation_sd_m, "float",
             "Standard deviation of the outliers along every axis [m].")
      .field("trim", &S::trim, "float",
             "Robust standard deviations beyond which an error is an outlier.")
      .field("restarts", &S::restarts, "int", "Starts at every number of components.")
      .field("max_iterations", &S::max_iterations, "int", "Largest number of iterations of a run.")
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

}  // namespace posemix::python
