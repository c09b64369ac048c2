// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cmath>
#include <tuple>

#include <fmt/ranges.h>
#include <nanobind/stl/tuple.h>

#include "errors.hpp"
#include "poses.hpp"
#include "record.hpp"
#include "seed.hpp"

namespace posemix::python {
namespace {

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

}  // namespace

void bind_errors(nb::module_& m) {
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
            new (self) M(mixture_of(nb::cast<std::vector<double>>(logs.attr("tolist")()),
                                    ShapedRows(means, 6, "means").rows,
                                    matrices_of(covariances, 6, "covariances")));
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

}  // namespace posemix::python
