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

/// Tangent vectors, whose rows need not be next to each other.
using Vectors = nb::ndarray<const double, nb::ndim<2>, nb::device::cpu>;

internal::ConstRows vectors(const Vectors& xi, std::size_t dof) {
  if (xi.shape(1) != dof || (xi.shape(0) > 0 && xi.stride(1) != 1)) {
    throw InvalidInput(fmt::format("tangent vectors of {} numbers; expected {}, next to each other",
                                   xi.shape(1), dof));
  }
  return {xi.data(), static_cast<std::size_t>(xi.stride(0))};
}

/// The functions of many elements of a group, and their rows.
template <class G>
struct Batch;

template <>
struct Batch<SO3d> {
  static constexpr auto kExp = &internal::so3_exp_of;
  static constexpr auto kLog = &internal::so3_log_of;
  static constexpr auto kLeftJacobian = &internal::so3_left_jacobian_of;
  static constexpr auto kLeftJacobianInverse = &internal::so3_left_jacobian_inverse_of;

  static internal::ConstRows in(const Rows& x) { return {x.data(), x.shape(0) == 1 ? 0U : 4U}; }
  static internal::MutableRows out(const NewArray& x) { return {x.data, 4}; }
};

template <>
struct Batch<SE3d> {
  static constexpr auto kExp = &internal::exp_of;
  static constexpr auto kLog = &internal::log_of;
  static constexpr auto kLeftJacobian = &internal::left_jacobian_of;
  static constexpr auto kLeftJacobianInverse = &internal::left_jacobian_inverse_of;

  static internal::ConstPoseRows in(const Rows& x) { return pose_rows_in(x); }
  static internal::MutablePoseRows out(const NewArray& x) { return pose_rows_out(x); }
};

/// function(rows..., count) on several threads, without holding the interpreter's lock.
template <class Function, class... BatchRows>
void in_batch(Function function, std::size_t count, std::size_t threads, const BatchRows&... rows) {
  const nb::gil_scoped_release unlocked;
  internal::by_parts(function, count, threads, rows...);
}

/// Binds the batch functions of one group under names that begin with `prefix`.
template <class G>
void bind_batches(nb::module_& m, const std::string& prefix) {
  using B = Batch<G>;
  constexpr std::size_t kDof = Wire<G>::kDof;
  constexpr std::size_t kSize = Wire<G>::kSize;
  const auto def = [&](const char* name, auto function, auto... extra) {
    m.def((prefix + name).c_str(), function, extra..., "threads"_a = 1);
  };
  def(
      "exp",
      [](const Vectors& xi, std::size_t threads) {
        const internal::ConstRows in = vectors(xi, kDof);
        NewArray out({xi.shape(0), kSize});
        in_batch(B::kExp, xi.shape(0), threads, in, B::out(out));
        return std::move(out.array);
      },
      "xi"_a);
  def(
      "log",
      [](const Rows& x, std::size_t threads) {
        require_columns(x, kSize, "x");
        NewArray out({x.shape(0), kDof});
        in_batch(B::kLog, x.shape(0), threads, B::in(x), internal::MutableRows{out.data, kDof});
        return std::move(out.array);
      },
      "x"_a);
  const auto jacobian = [&](const char* name, auto function) {
    def(
        name,
        [function](const Vectors& xi, std::size_t threads) {
          const internal::ConstRows in = vectors(xi, kDof);
          NewArray out({xi.shape(0), kDof, kDof});
          in_batch(function, xi.shape(0), threads, in,
                   internal::MutableMatrices{out.data, kDof * kDof, true});
          return std::move(out.array);
        },
        "xi"_a);
  };
  jacobian("left_jacobian", B::kLeftJacobian);
  jacobian("left_jacobian_inverse", B::kLeftJacobianInverse);
}

/// Binds the other functions of one group under names that begin with `prefix`.
template <class G>
void bind_group(nb::module_& m, const std::string& prefix) {
  const auto def = [&](const char* name, auto function, auto... extra) {
    m.def((prefix + name).c_str(), function, extra...);
  };
  // Products and inverses have the bits of the operators of C++, so that increments of odometry from
  // Python are those of a recording.
  def(
      "multiply",
      [](const Rows& a, const Rows& b) {
        return each_pair(a, b, Wire<G>::kSize, [](const double* x, const double* y, double* out) {
          Wire<G>::write(Wire<G>::read(x) * Wire<G>::read(y), out);
        });
      },
      "a"_a, "b"_a);
  def(
      "inverse",
      [](const Rows& x) {
        return each_row(x, {Wire<G>::kSize}, [](const double* in, double* out) {
          Wire<G>::write(Wire<G>::read(in).inverse(), out);
        });
      },
      "x"_a);
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
  def(
      "ad",
      [](const Rows& xi) {
        require_columns(xi, Wire<G>::kDof, "xi");
        return each_row(xi, {Wire<G>::kDof, Wire<G>::kDof}, [](const double* in, double* out) {
          write_matrix<G>(G::ad(tangent<G>(in)), out);
        });
      },
      "xi"_a);
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
  bind_batches<SO3d>(m, "so3_");
  bind_group<SE3d>(m, "se3_");
  bind_batches<SE3d>(m, "se3_");
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
