// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/lie/lie.hpp"

#include <algorithm>

#include "arrays.hpp"
#include "posemix/lie/interpolate.hpp"
#include "posemix/lie/mean.hpp"

namespace posemix::python {
namespace {

/// The number of rows of two operands; one of them may be a single row, which is used for all.
std::size_t common_rows(const Rows& a, const Rows& b) {
  if (a.shape(0) == b.shape(0) || b.shape(0) == 1) return a.shape(0);
  if (a.shape(0) == 1) return b.shape(0);
  throw InvalidInput(fmt::format("{} elements and {}; expected as many of both, or one of either",
                                 a.shape(0), b.shape(0)));
}

const double* row(const Rows& rows, std::size_t i) {
  return rows.data() + (rows.shape(0) == 1 ? 0 : i) * rows.shape(1);
}

/// Calls f(input row, output row) for all rows, without holding the interpreter's lock.
template <class Function>
Array each_row(const Rows& in, const std::vector<std::size_t>& row_shape, Function f) {
  std::vector<std::size_t> shape{in.shape(0)};
  shape.insert(shape.end(), row_shape.begin(), row_shape.end());
  std::size_t stride = 1;
  for (const std::size_t n : row_shape) stride *= n;
  NewArray out(shape);
  {
    const nb::gil_scoped_release unlocked;
    for (std::size_t i = 0; i < in.shape(0); ++i)
      f(in.data() + i * in.shape(1), out.data + i * stride);
  }
  return std::move(out.array);
}

template <class Function>
Array each_pair(const Rows& a, const Rows& b, std::size_t columns, Function f) {
  const std::size_t n = common_rows(a, b);
  NewArray out({n, columns});
  {
    const nb::gil_scoped_release unlocked;
    for (std::size_t i = 0; i < n; ++i) f(row(a, i), row(b, i), out.data + i * columns);
  }
  return std::move(out.array);
}

template <class G>
void write_matrix(const typename G::TangentMatrix& m, double* out) {
  Eigen::Map<Eigen::Matrix<double, G::Dof, G::Dof, Eigen::RowMajor>> rows(out);
  rows = m;
}

template <class G>
typename G::Tangent tangent(const double* p) {
  return Eigen::Map<const typename G::Tangent>(p);
}

/// Binds the functions of one group under names that begin with `prefix`.
template <class G>
void bind_group(nb::module_& m, const std::string& prefix) {
  const auto def = [&](const char* name, auto function, auto... extra) {
    m.def((prefix + name).c_str(), function, extra...);
  };
  def(
      "exp",
      [](const Rows& xi) {
        require_columns(xi, Wire<G>::kDof, "xi");
        return each_row(xi, {Wire<G>::kSize}, [](const double* in, double* out) {
          Wire<G>::write(G::exp(tangent<G>(in)), out);
        });
      },
      "xi"_a);
  def(
      "log",
      [](const Rows& x) {
        return each_row(x, {Wire<G>::kDof}, [](const double* in, double* out) {
          Eigen::Map<typename G::Tangent> result(out);
          result = Wire<G>::read(in).log();
        });
      },
      "x"_a);
  def(
      "multiply",
      [](const Rows& a, const Rows& b) {
        return each_pair(a, b, Wire<G>::kSize, [](const double* x, const double* y, double* out) {
          Wire<G>::write(Wire<G>::read(x) * Wire<G>::read(y), out);
        });
      },
      "a"_a, "b"_a);
  def(
      "act",
      [](const Rows& x, const Rows& points) {
        require_columns(points, 3, "points");
        return each_pair(x, points, 3, [](const double* in, const double* p, double* out) {
          Eigen::Map<Eigen::Vector3d> result(out);
          result = Wire<G>::read(in) * Eigen::Vector3d(p[0], p[1], p[2]);
        });
      },
      "x"_a, "points"_a);
  def(
      "inverse",
      [](const Rows& x) {
        return each_row(x, {Wire<G>::kSize}, [](const double* in, double* out) {
          Wire<G>::write(Wire<G>::read(in).inverse(), out);
        });
      },
      "x"_a);
  def(
      "matrix",
      [](const Rows& x) {
        return each_row(x, {Wire<G>::kSide, Wire<G>::kSide}, [](const double* in, double* out) {
          Eigen::Map<Eigen::Matrix<double, Wire<G>::kSide, Wire<G>::kSide, Eigen::RowMajor>> result(
              out);
          result = Wire<G>::read(in).matrix();
        });
      },
      "x"_a);
  def(
      "from_matrix",
      [](const Matrices& matrices, double tolerance) {
        if (matrices.shape(1) != Wire<G>::kSide || matrices.shape(2) != Wire<G>::kSide) {
          throw InvalidInput(fmt::format("matrices of shape ({}, {}); expected ({}, {})",
                                         matrices.shape(1), matrices.shape(2), Wire<G>::kSide,
                                         Wire<G>::kSide));
        }
        NewArray out({matrices.shape(0), Wire<G>::kSize});
        for (std::size_t i = 0; i < matrices.shape(0); ++i) {
          const Eigen::Map<
              const Eigen::Matrix<double, Wire<G>::kSide, Wire<G>::kSide, Eigen::RowMajor>>
              matrix(matrices.data() + i * Wire<G>::kSide * Wire<G>::kSide);
          Wire<G>::write(G::from_matrix(matrix, tolerance), out.data + i * Wire<G>::kSize);
        }
        return std::move(out.array);
      },
      "matrices"_a, "tolerance"_a);
  def(
      "adjoint",
      [](const Rows& x) {
        return each_row(x, {Wire<G>::kDof, Wire<G>::kDof}, [](const double* in, double* out) {
          write_matrix<G>(Wire<G>::read(in).adjoint(), out);
        });
      },
      "x"_a);
  const auto jacobian = [&](const char* name, auto function) {
    def(
        name,
        [function](const Rows& xi) {
          require_columns(xi, Wire<G>::kDof, "xi");
          return each_row(xi, {Wire<G>::kDof, Wire<G>::kDof},
                          [function](const double* in, double* out) {
                            write_matrix<G>(function(tangent<G>(in)), out);
                          });
        },
        "xi"_a);
  };
  using Tangent = typename G::Tangent;
  jacobian("left_jacobian", [](const Tangent& xi) { return G::left_jacobian(xi); });
  jacobian("left_jacobian_inverse", [](const Tangent& xi) { return G::left_jacobian_inverse(xi); });
  jacobian("right_jacobian", [](const Tangent& xi) { return G::right_jacobian(xi); });
  jacobian("right_jacobian_inverse",
           [](const Tangent& xi) { return G::right_jacobian_inverse(xi); });
  jacobian("ad", [](const Tangent& xi) { return G::ad(xi); });
  def(
      "interpolate",
      [](const Numbers& a, const Numbers& b, const Numbers& t) {
        const G from = element_of<G>(a);
        const G to = element_of<G>(b);
        NewArray out({t.shape(0), Wire<G>::kSize});
        for (std::size_t i = 0; i < t.shape(0); ++i)
          Wire<G>::write(interpolate(from, to, t.data()[i]), out.data + i * Wire<G>::kSize);
        return std::move(out.array);
      },
      "a"_a, "b"_a, "t"_a);
  def(
      "weighted_mean",
      [](const Rows& x, const Numbers& weights) {
        const std::vector<G> elements = elements_of<G>(x, "x");
        const std::vector<double> w(weights.data(), weights.data() + weights.shape(0));
        const MeanResult<G> result = weighted_mean<G>(elements, w);
        return nb::make_tuple(array_of(result.mean), result.converged);
      },
      "x"_a, "weights"_a);
}

}  // namespace

void bind_lie(nb::module_& m) {
  bind_group<SO3d>(m, "so3_");
  bind_group<SE3d>(m, "se3_");
  m.def(
      "so3_normalized",
      [](const Rows& quaternions) {
        require_columns(quaternions, 4, "quaternions");
        NewArray out({quaternions.shape(0), 4});
        for (std::size_t i = 0; i < quaternions.shape(0); ++i) {
          const double* q = quaternions.data() + 4 * i;
          Wire<SO3d>::write(
              SO3d::from_stored_quaternion(Eigen::Quaterniond(q[3], q[0], q[1], q[2])),
              out.data + 4 * i);
        }
        return std::move(out.array);
      },
      "quaternions"_a);
}

}  // namespace posemix::python
