// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "density.hpp"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/vector.h>

#include "generic.hpp"
#include "posemix/density/operations.hpp"
#include "posemix/density/pose_stack.hpp"
#include "posemix/density/projected_operations.hpp"
#include "posemix/lie/pose_stack.hpp"
#include "record.hpp"
#include "rules.hpp"
#include "settings.hpp"
#include "words.hpp"

namespace posemix::python {
namespace {

/// The class of a density with what all kinds have.
template <class D>
nb::class_<D> bind_gaussian(nb::module_& m, const char* name) {
  nb::class_<D> made(m, name);
  made.def_prop_ro(
      "mean", [](const D& self) { return array_of(self.mean()); }, nb::rv_policy::move);
  made.def_prop_ro(
      "covariance", [](const D& self) { return matrix_array(self.covariance()); },
      nb::rv_policy::move);
  return made;
}

template <class G>
void bind_concentrated(nb::module_& m, const char* name) {
  using D = ConcentratedGaussian<G>;
  using Covariance = typename G::TangentMatrix;
  bind_gaussian<D>(m, name)
      .def(
          "__init__",
          [](Unmade<D> self, const Numbers& mean, const Covariance& covariance) {
            new (self.place) D(element_of<G>(mean), covariance);
          },
          "mean"_a, "covariance"_a)
      .def_prop_ro(
          "body_covariance", [](const D& self) { return matrix_array(self.body_covariance()); },
          nb::rv_policy::move)
      .def("log_density", &log_densities_at<D>, "points"_a)
      .def(
          "sample",
          [](const D& self, std::size_t count, RandomStream& stream) {
            return drawn(self, count, stream);
          },
          "count"_a, "stream"_a);
  bind_composition<D>(m);
  m.def(
      "fuse",
      [](const D& p, const D& q, const std::optional<FuseSettings>& settings) {
        auto result = fuse(p, q, settings.value_or(FuseSettings{}));
        return AnyFusion{nb::cast(std::move(result.density)), result.log_overlap, result.converged,
                         result.iterations, std::nullopt};
      },
      "p"_a, "q"_a, "settings"_a.none());
  m.def(
      "recenter",
      [](const D& x, const Numbers& anchor) {
        const TangentGaussian<G> moved = recenter(x, element_of<G>(anchor));
        return nb::make_tuple(vector_array(moved.mean), matrix_array(moved.covariance));
      },
      "x"_a, "anchor"_a);
  m.def(
      "back_project",
      [](const Numbers& anchor, const typename G::Tangent& mean, const Covariance& covariance) {
        const G at = element_of<G>(anchor);
        return back_project(
            TangentGaussian<G>{at, mean, checked_covariance(covariance, at.dof(), "covariance")});
      },
      "anchor"_a, "mean"_a, "covariance"_a);
}

void bind_stack(nb::module_& m) {
  using D = ConcentratedStack;
  bind_gaussian<D>(m, "ConcentratedStack")
      .def(
          "__init__",
          [](Unmade<D> self, const Rows& mean, const Eigen::MatrixXd& covariance) {
            new (self.place) D(PoseStackd(elements_of<SE3d>(mean, "mean")), covariance);
          },
          "mean"_a, "covariance"_a)
      .def(
          "marginal", [](const D& self, std::size_t index) { return marginal(self, index); },
          "index"_a)
      .def(
          "marginals",
          [](const D& self, const std::vector<std::size_t>& indices) {
            return marginal(self, std::span<const std::size_t>(indices));
          },
          "indices"_a)
      .def(
          "conditional",
          [](const D& self, const std::vector<std::size_t>& indices, const Rows& values) {
            const std::vector<SE3d> poses = elements_of<SE3d>(values, "values");
            return conditional(self, indices, poses);
          },
          "indices"_a, "values"_a)
      .def(
          "relative_pose",
          [](const D& self, std::size_t from, std::size_t to) {
            return relative_pose(self, from, to);
          },
          "from_index"_a, "to_index"_a)
      .def(
          "log_density",
          [](const D& self, const Rows& points) {
            const std::size_t n = self.mean().size();
            const std::vector<SE3d> poses = elements_of<SE3d>(points, "points");
            NewArray out({poses.size() / n});
            const nb::gil_scoped_release unlocked;
            const D::Evaluator evaluator(self);
            for (std::size_t i = 0; (i + 1) * n <= poses.size(); ++i) {
              const auto first = poses.begin() + static_cast<std::ptrdiff_t>(i * n);
              out.data[i] = evaluator.log_density(
                  PoseStackd(std::vector<SE3d>(first, first + static_cast<std::ptrdiff_t>(n))));
            }
            return std::move(out.array);
          },
          "points"_a)
      .def(
          "sample",
          [](const D& self, std::size_t count, RandomStream& stream) {
            NewArray out({count, self.mean().size(), 7});
            const nb::gil_scoped_release unlocked;
            for_each_draw(self, count, stream, [row = out.data](const PoseStackd& stack) mutable {
              for (const SE3d& pose : stack) {
                Wire<SE3d>::write(pose, row);
                row += 7;
              }
            });
            return std::move(out.array);
          },
          "count"_a, "stream"_a);
}

template <class G>
void bind_projected(nb::module_& m, const char* name) {
  using D = ProjectedGaussian<G>;
  using Covariance = typename G::TangentMatrix;
  bind_gaussian<D>(m, name)
      .def(
          "__init__",
          [](Unmade<D> self, const Numbers& tangent_point, const typename G::Tangent& mean,
             const Covariance& covariance) {
            new (self.place) D(element_of<SO3d>(tangent_point), mean, covariance);
          },
          "tangent_point"_a, "tangent_mean"_a, "covariance"_a)
      .def_prop_ro(
          "tangent_point", [](const D& self) { return array_of(self.tangent_point()); },
          nb::rv_policy::move)
      .def_prop_ro(
          "tangent_mean", [](const D& self) { return vector_array(self.tangent_mean()); },
          nb::rv_policy::move)
      .def_prop_ro("log_normalizer", &D::log_normalizer)
      .def("log_density", &log_densities_at<D>, "points"_a)
      .def(
          "sample",
          [](const D& self, std::size_t count, RandomStream& stream) {
            return drawn(self, count, stream);
          },
          "count"_a, "stream"_a)
      .def(
          "sample_by_projection",
          [](const D& self, std::size_t count, RandomStream& stream) {
            NewArray out({count, Wire<G>::kSize});
            const nb::gil_scoped_release unlocked;
            for (std::size_t i = 0; i < count; ++i)
              Wire<G>::write(self.sample_by_projection(stream), out.data + i * Wire<G>::kSize);
            return std::move(out.array);
          },
          "count"_a, "stream"_a)
      .def(
          "change_chart",
          [](const D& self, const Numbers& tangent_point) {
            return change_chart(self, element_of<SO3d>(tangent_point));
          },
          "tangent_point"_a);
  bind_composition<D>(m);
  m.def(
      "fuse",
      [](const D& p, const D& q, const std::optional<ProjectedFuseSettings>& settings) {
        auto result = fuse(p, q, settings.value_or(ProjectedFuseSettings{}));
        std::optional<AnyProductMode> second;
        if (result.second)
          second = {nb::cast(std::move(result.second->density)), result.second->log_overlap};
        return AnyFusion{nb::cast(std::move(result.density)), result.log_overlap, result.converged,
                         result.iterations, std::move(second)};
      },
      "p"_a, "q"_a, "settings"_a.none());
}

void bind_settings(nb::module_& m) {
  Settings<FuseSettings>(m, "FuseSettings", "Settings of `fuse` for concentrated Gaussians.")
      .field("max_iterations", &FuseSettings::max_iterations, "int", "Gauss-Newton steps at most.")
      .field("tolerance", &FuseSettings::tolerance, "float", "Norm of the last step [rad, m].")
      .done();
  Words<FusionRule>(m, "FusionRule",
                    "Rule by which the product of two projected Gaussians is found.")
      .value(FusionRule::mode, "The exact mode of the product, with the Hessian there.")
      .value(FusionRule::jacobian,
             "Both in the chart halfway (MPG paper, eq. 14-16); small angles only.");
  Words<CompositionRule>(m, "CompositionRule", "Rule by which projected Gaussians are composed.")
      .value(CompositionRule::cubature, "Moments under the distributions, degree five.")
      .value(CompositionRule::third_degree_cubature,
             "2n points over the Gaussians in the tangent spaces.")
      .value(CompositionRule::jacobian, "Linearised (MPG paper, eq. 17).");
  Settings<ProjectedFuseSettings>(m, "ProjectedFuseSettings",
                                  "Settings of `fuse` for projected Gaussians.")
      .field("rule", &ProjectedFuseSettings::rule, "FusionRule",
             "Rule by which the product is found.")
      .field("max_iterations", &ProjectedFuseSettings::max_iterations, "int", "Steps at most.")
      .field("tolerance", &ProjectedFuseSettings::tolerance, "float", "Norm of the last step.")
      .field("max_angle", &ProjectedFuseSettings::max_angle, "float",
             "Largest angle between the quaternions of the tangent points for the Jacobian rule, "
             "half of that between the rotations [rad].")
      .field("second_mode_from", &ProjectedFuseSettings::second_mode_from, "float",
             "The product's second mode is kept where its relative weight is at least this.")
      .done();
}

void bind_fusion(nb::module_& m) {
  m.attr("X") = nb::type_var("X");
  Record<AnyProductMode>(m, "ProductMode", "One mode of the product of two densities.")
      .field("density", &AnyProductMode::density, "typing.Any", "The density at the mode.")
      .field("log_overlap", &AnyProductMode::log_overlap, "float",
             "Log of the integral of the product around the mode over the group [nats].")
      .done();
  Record<AnyFusion>(m, "FuseResult", "Result of `fuse`.", nb::is_generic(),
                    nb::sig("class FuseResult(typing.Generic[X])"))
      .field("density", &AnyFusion::density, "X", "The normalised product.")
      .field("log_overlap", &AnyFusion::log_overlap, "float",
             "Log of the integral of the product over the group [nats].")
      .field("converged", &AnyFusion::converged, "bool",
             "Whether the iteration converged, of every pair.")
      .field("iterations", &AnyFusion::iterations, "int | None",
             "Iterations of a single pair; None for mixtures.")
      .field("second", &AnyFusion::second, "ProductMode | None",
             "The product's second mode, of two projected Gaussians on opposite sides.")
      .done();
}

}  // namespace

void bind_density(nb::module_& m) {
  bind_settings(m);
  bind_fusion(m);
  bind_concentrated<SO3d>(m, "ConcentratedSO3");
  bind_concentrated<SE3d>(m, "ConcentratedSE3");
  bind_stack(m);
  bind_projected<SO3d>(m, "ProjectedSO3");
  bind_projected<SE3d>(m, "ProjectedSE3");
}

}  // namespace posemix::python
