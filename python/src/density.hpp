// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include <nanobind/eigen/dense.h>

#include "arrays.hpp"
#include "posemix/base/random.hpp"
#include "posemix/density/concentrated_gaussian.hpp"
#include "posemix/density/projected_gaussian.hpp"
#include "posemix/mixture/log_densities.hpp"
#include "posemix/mixture/mixture.hpp"
#include "posemix/mixture/samples.hpp"

namespace posemix::python {

using ConcentratedSO3 = ConcentratedGaussian<SO3d>;
using ConcentratedSE3 = ConcentratedGaussian<SE3d>;
using ConcentratedStack = ConcentratedGaussian<PoseStackd>;
using ProjectedSO3 = ProjectedGaussian<SO3d>;
using ProjectedSE3 = ProjectedGaussian<SE3d>;

/// The class of the Python package for a compiled type of density or mixture.
template <class T>
struct PublicClass;

template <class G>
struct PublicClass<ConcentratedGaussian<G>> {
  static constexpr const char* kModule = "posemix.density";
  static constexpr const char* kName = "ConcentratedGaussian";
  static constexpr auto kType =
      nb::detail::const_name<std::is_same_v<G, SO3d>>("posemix.lie.SO3", "posemix.lie.SE3");
  static constexpr auto kAnnotation =
      nb::detail::const_name("posemix.density.ConcentratedGaussian[") + kType +
      nb::detail::const_name("]");
};

template <class G>
struct PublicClass<ProjectedGaussian<G>> {
  static constexpr const char* kModule = "posemix.density";
  static constexpr const char* kName = "ProjectedGaussian";
  static constexpr auto kType =
      nb::detail::const_name<std::is_same_v<G, SO3d>>("posemix.lie.SO3", "posemix.lie.SE3");
  static constexpr auto kAnnotation = nb::detail::const_name("posemix.density.ProjectedGaussian[") +
                                      kType + nb::detail::const_name("]");
};

template <class D>
struct PublicClass<Mixture<D>> {
  static constexpr const char* kModule = "posemix.mixture";
  static constexpr const char* kName = "Mixture";
  static constexpr auto kAnnotation = nb::detail::const_name("posemix.mixture.Mixture[") +
                                      PublicClass<D>::kAnnotation + nb::detail::const_name("]");
};

/// Converts from objects of the package's class or of its compiled part, and to objects of the
/// package's class.
template <class T>
struct PublicCaster : nb::detail::type_caster_base<T> {
  using Base = nb::detail::type_caster_base<T>;
  static constexpr auto Name = PublicClass<T>::kAnnotation;

  bool from_python(nb::handle source, std::uint32_t flags,
                   nb::detail::cleanup_list* cleanup) noexcept {
    if (nb::isinstance<T>(source)) return Base::from_python(source, flags, cleanup);
    PyObject* const part = PyObject_GetAttrString(source.ptr(), "_handle");
    if (part == nullptr) {
      PyErr_Clear();
      return false;
    }
    const bool taken =
        nb::isinstance<T>(nb::handle(part)) && Base::from_python(part, flags, cleanup);
    Py_DECREF(part);  // the object that it is an attribute of holds a reference
    return taken;
  }

  template <class Value>
  static nb::handle from_cpp(Value&& value, nb::rv_policy policy,
                             nb::detail::cleanup_list* cleanup) noexcept try {
    const nb::object part = nb::steal(Base::from_cpp(std::forward<Value>(value), policy, cleanup));
    if (!part.is_valid()) return {};
    const nb::object made = nb::module_::import_(PublicClass<T>::kModule);
    return made.attr(PublicClass<T>::kName).attr("_of")(part).release();
  } catch (nb::python_error& error) {
    error.restore();
    return {};
  }
};

/// The memory in which a constructor of a compiled part makes its object. nanobind finds
/// constructors by the annotation of their first argument, and the annotation of T itself is that
/// of the package's class.
template <class T>
struct Unmade {
  T* place = nullptr;
};

}  // namespace posemix::python

namespace nanobind::detail {

template <class T>
struct type_caster<posemix::python::Unmade<T>> {
  NB_TYPE_CASTER(posemix::python::Unmade<T>, const_name<T>())

  bool from_python(handle source, std::uint32_t flags, cleanup_list* cleanup) noexcept {
    type_caster_base<T> base;
    if (!base.from_python(source, flags, cleanup)) return false;
    value.place = base.operator T*();
    return true;
  }
};

template <class G>
struct type_caster<posemix::ConcentratedGaussian<G>>
    : posemix::python::PublicCaster<posemix::ConcentratedGaussian<G>> {};
template <class G>
struct type_caster<posemix::ProjectedGaussian<G>>
    : posemix::python::PublicCaster<posemix::ProjectedGaussian<G>> {};
template <class D>
struct type_caster<posemix::Mixture<D>> : posemix::python::PublicCaster<posemix::Mixture<D>> {};

}  // namespace nanobind::detail

namespace posemix::python {

/// A covariance as an array in C order.
template <class Matrix>
Array matrix_array(const Matrix& m) {
  NewArray out({static_cast<std::size_t>(m.rows()), static_cast<std::size_t>(m.cols())});
  Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
      out.data, m.rows(), m.cols()) = m;
  return std::move(out.array);
}

template <class Vector>
Array vector_array(const Vector& v) {
  NewArray out({static_cast<std::size_t>(v.size())});
  Eigen::Map<Eigen::VectorXd>(out.data, v.size()) = v;
  return std::move(out.array);
}

template <class G>
G mean_of(const Numbers& row) {
  return element_of<G>(row);
}

/// Log densities of a density or a mixture at the rows of `points`.
template <class D>
Array log_densities_at(const D& density, const Rows& points) {
  using G = typename D::Group;
  require_columns(points, Wire<G>::kSize, "points");
  NewArray out({points.shape(0)});
  {
    const nb::gil_scoped_release unlocked;
    const std::vector<G> elements = elements_of<G>(points, "points");
    std::ranges::copy(log_densities(density, std::span<const G>(elements)), out.data);
  }
  return std::move(out.array);
}

/// Calls `use` with `count` draws of a density or a mixture, of which a block is in memory.
template <class D, class Use>
void for_each_draw(const D& density, std::size_t count, RandomStream& stream, Use use) {
  constexpr std::size_t kBlock = 4096;
  for (std::size_t left = count; left > 0; left -= std::min(left, kBlock))
    for (const auto& element : samples(density, std::min(left, kBlock), stream)) use(element);
}

/// `count` draws of a density or a mixture as rows.
template <class D>
Array drawn(const D& density, std::size_t count, RandomStream& stream) {
  using Row = Wire<typename D::Group>;
  NewArray out({count, Row::kSize});
  {
    const nb::gil_scoped_release unlocked;
    for_each_draw(density, count, stream, [row = out.data](const auto& element) mutable {
      Row::write(element, row);
      row += Row::kSize;
    });
  }
  return std::move(out.array);
}

}  // namespace posemix::python
