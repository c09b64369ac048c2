// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <span>
#include <vector>

#include <nanobind/eigen/dense.h>

#include "arrays.hpp"
#include "posemix/base/random.hpp"
#include "posemix/density/concentrated_gaussian.hpp"
#include "posemix/density/projected_gaussian.hpp"

namespace posemix::python {

using ConcentratedSO3 = ConcentratedGaussian<SO3d>;
using ConcentratedSE3 = ConcentratedGaussian<SE3d>;
using ConcentratedStack = ConcentratedGaussian<PoseStackd>;
using ProjectedSO3 = ProjectedGaussian<SO3d>;
using ProjectedSE3 = ProjectedGaussian<SE3d>;

/// A covariance as rows, in numpy's own order.
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

/// Log densities of D::Evaluator at the rows of `points`.
template <class D>
Array log_densities(const D& density, const Rows& points) {
  using G = typename D::Group;
  require_columns(points, Wire<G>::kSize, "points");
  NewArray out({points.shape(0)});
  {
    const nb::gil_scoped_release unlocked;
    const typename D::Evaluator evaluator(density);
    for (std::size_t i = 0; i < points.shape(0); ++i)
      out.data[i] = evaluator.log_density(Wire<G>::read(points.data() + i * Wire<G>::kSize));
  }
  return std::move(out.array);
}

/// `count` draws as rows.
template <class G, class Draw>
Array drawn(std::size_t count, Draw draw) {
  NewArray out({count, Wire<G>::kSize});
  {
    const nb::gil_scoped_release unlocked;
    for (std::size_t i = 0; i < count; ++i) Wire<G>::write(draw(), out.data + i * Wire<G>::kSize);
  }
  return std::move(out.array);
}

}  // namespace posemix::python
