// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "density.hpp"
#include "dict.hpp"
#include "posemix/detector/error_mixture.hpp"
#include "posemix/grasp/calibration.hpp"
#include "posemix/grasp/scores.hpp"
#include "poses.hpp"
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

template <class Function>
Array each_error(const Rows& rows, Function f) {
  require_columns(rows, 6, "errors");
  NewArray out({rows.shape(0)});
  const nb::gil_scoped_release unlocked;
  for (std::size_t i = 0; i < rows.shape(0); ++i)
    out.data[i] = f(Vector6d(Eigen::Map<const Vector6d>(rows.data() + 6 * i)));
  return std::move(out.array);
}

void bind_error_mixture(nb::module_& m) {
  nb::class_<ErrorMixture>(m, "ErrorMixture")
      .def("__init__",
           [](ErrorMixture* self, const std::vector<double>& log_weights, const Rows& means,
              const Matrices& covariances) {
             new (self) ErrorMixture(mixture_of(log_weights, means, covariances));
           })
      .def("parts", &parts_of)
      .def("log_density",
           [](const ErrorMixture& self, const Rows& errors) {
             return each_error(errors, [&](const Vector6d& e) { return self.log_density(e); });
           })
      .def("log_pose_density",
           [](const ErrorMixture& self, const Rows& errors) {
             return each_error(errors, [&](const Vector6d& e) { return self.log_pose_density(e); });
           })
      .def("sample", [](const ErrorMixture& self, std::size_t count, RandomStream& stream) {
        NewArray out({count, 6});
        for (std::size_t i = 0; i < count; ++i)
          Eigen::Map<Vector6d>(out.data + 6 * i) = self.sample(stream);
        return std::move(out.array);
      });
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
  m.def("fit_error_mixture", [](const Rows& errors, const S& settings, RandomStream& stream) {
    const std::vector<Vector6d> all = errors_of(errors);
    std::optional<ErrorMixtureFit> fit;
    {
      const nb::gil_scoped_release unlocked;
      fit = fit_error_mixture(all, settings, stream);
    }
    return nb::make_tuple(std::move(fit->errors), fit->components, fit->log_likelihood, fit->bic,
                          fit->history);
  });
  m.def("fit_error_gaussian",
        [](const Rows& errors) { return fit_error_gaussian(errors_of(errors)); });
  m.def("trimmed_errors", [](const Rows& errors, double trim) {
    return rows_of(trimmed_errors(errors_of(errors), trim));
  });
}

std::vector<ScoredPrediction> predictions_of(const Numbers& probabilities,
                                             const std::vector<bool>& successes,
                                             const std::vector<std::size_t>& groups) {
  const std::size_t n = probabilities.shape(0);
  if (successes.size() != n || (!groups.empty() && groups.size() != n)) {
    throw InvalidInput(fmt::format("{} probabilities, {} successes and {} groups; expected as many",
                                   n, successes.size(), groups.size()));
  }
  std::vector<ScoredPrediction> all;
  for (std::size_t i = 0; i < n; ++i)
    all.push_back({probabilities.data()[i], successes[i], groups.empty() ? 0 : groups[i]});
  return all;
}

void bind_scores(nb::module_& m) {
  using Successes = std::vector<bool>;
  const auto def = [&](const char* name, auto score) {
    m.def(name, [score](const Numbers& p, const Successes& s, const std::vector<std::size_t>& g) {
      return score(predictions_of(p, s, g));
    });
  };
  def("brier_score", [](const auto& all) { return brier_score(all); });
  def("log_loss", [](const auto& all) { return log_loss(all); });
  def("accuracy", [](const auto& all) { return accuracy(all); });
  def("auc_within_groups", [](const auto& all) { return auc_within_groups(all); });
  def("fit_platt", [](const auto& all) {
    const PlattCalibration fit = fit_platt(all);
    return nb::make_tuple(fit.slope, fit.bias);
  });
  m.def("calibration_error", [](const Numbers& p, const Successes& s, std::size_t bins) {
    return calibration_error(predictions_of(p, s, {}), bins);
  });
  m.def("reliability", [](const Numbers& p, const Successes& s, std::size_t bins) {
    return list_of(reliability(predictions_of(p, s, {}), bins), [](const ReliabilityBin& bin) {
      return nb::make_tuple(bin.count, bin.mean_probability, bin.success_rate);
    });
  });
  m.def("platt", [](double slope, double bias, const Numbers& p) {
    NewArray out({p.shape(0)});
    const PlattCalibration calibration{slope, bias};
    for (std::size_t i = 0; i < p.shape(0); ++i) out.data[i] = calibration(p.data()[i]);
    return std::move(out.array);
  });
}

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
  m.def("fit_logistic",
        [](const Eigen::MatrixXd& features, const std::vector<bool>& outcomes, const S& settings) {
          const LogisticModel model = fit_logistic(features, outcomes, settings);
          return nb::make_tuple(vector_array(model.weights), model.bias);
        });
  m.def("logistic_probability",
        [](const Eigen::VectorXd& weights, double bias, const Eigen::MatrixXd& features) {
          const LogisticModel model{weights, bias};
          NewArray out({static_cast<std::size_t>(features.rows())});
          for (Eigen::Index i = 0; i < features.rows(); ++i)
            out.data[i] = model.probability(features.row(i).transpose());
          return std::move(out.array);
        });
}

}  // namespace

void bind_errors(nb::module_& m) {
  bind_error_mixture(m);
  bind_error_fit(m);
  bind_scores(m);
  bind_logistic(m);
}

}  // namespace posemix::python
