// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "density.hpp"
#include "posemix/density/operations.hpp"

/// Operations on many densities on SE(3) at once.

namespace posemix::python {
namespace {

/// Densities from rows of means and as many covariances; a single density is used for all.
struct PoseRows {
  Rows means;
  Matrices covariances;

  PoseRows(const Rows& m, const Matrices& c) : means(m), covariances(c) {
    require_columns(means, 7, "means");
    if (covariances.shape(1) != 6 || covariances.shape(2) != 6)
      throw InvalidInput("covariances do not have the shape (n, 6, 6)");
    if (covariances.shape(0) != means.shape(0)) {
      throw InvalidInput(fmt::format("{} means and {} covariances; expected as many of both",
                                     means.shape(0), covariances.shape(0)));
    }
  }

  std::size_t size() const { return means.shape(0); }
  internal::ConstDensities rows() const {
    return {pose_rows_in(means), {covariances.data(), size() == 1 ? 0U : 36U}};
  }
  ConcentratedSE3 at(std::size_t i) const {
    const std::size_t k = size() == 1 ? 0 : i;
    const Eigen::Map<const Matrix6d> covariance(covariances.data() + 36 * k);
    return ConcentratedSE3::trusted(Wire<SE3d>::read(means.data() + 7 * k), covariance);
  }
};

/// Densities as arrays of means and covariances.
struct PoseRowsOut {
  NewArray means;
  NewArray covariances;

  explicit PoseRowsOut(std::size_t n) : means({n, 7}), covariances({n, 6, 6}) {}
  void set(std::size_t i, const ConcentratedSE3& density) {
    Wire<SE3d>::write(density.mean(), means.data + 7 * i);
    Eigen::Map<Matrix6d>(covariances.data + 36 * i) = density.covariance();
  }
  internal::MutableDensities rows() const { return {pose_rows_out(means), {covariances.data, 36}}; }
  nb::tuple tuple() { return nb::make_tuple(std::move(means.array), std::move(covariances.array)); }
};

std::size_t common_size(const PoseRows& x, const PoseRows& y) {
  if (x.size() != y.size() && x.size() != 1 && y.size() != 1) {
    throw InvalidInput(fmt::format(
        "{} densities and {}; expected as many of both, or one of either", x.size(), y.size()));
  }
  return x.size() == 1 ? y.size() : x.size();
}

/// function(rows..., count) on several threads.
template <class Function, class... In>
nb::tuple in_batch(Function function, std::size_t count, std::size_t threads, const In&... in) {
  PoseRowsOut out(count);
  {
    const nb::gil_scoped_release unlocked;
    internal::by_parts(function, count, threads, in.rows()..., out.rows());
  }
  return out.tuple();
}

nb::tuple fused_rows(const PoseRows& x, const PoseRows& y, const FuseSettings& settings) {
  PoseRowsOut out(common_size(x, y));
  std::vector<char> converged;  // a std::vector<bool> of libc++ becomes no list
  {
    const nb::gil_scoped_release unlocked;
    for (std::size_t i = 0; i < common_size(x, y); ++i) {
      const auto result = fuse(x.at(i), y.at(i), settings);
      converged.push_back(result.converged ? 1 : 0);
      out.set(i, result.density);
    }
  }
  nb::list flags;
  for (const char each : converged) flags.append(nb::bool_(each != 0));
  const nb::tuple densities = out.tuple();
  return nb::make_tuple(nb::object(densities[0]), nb::object(densities[1]), flags);
}

}  // namespace

void bind_density_batches(nb::module_& m) {
  m.def("compose_rows", [](const Rows& mx, const Matrices& cx, const Rows& my, const Matrices& cy,
                           std::size_t threads) {
    const PoseRows x(mx, cx);
    const PoseRows y(my, cy);
    return in_batch(internal::density_product_of, common_size(x, y), threads, x, y);
  });
  m.def("between_rows", [](const Rows& mx, const Matrices& cx, const Rows& my, const Matrices& cy,
                           std::size_t threads) {
    const PoseRows x(mx, cx);
    const PoseRows y(my, cy);
    return in_batch(internal::density_between_of, common_size(x, y), threads, x, y);
  });
  m.def("inverse_rows", [](const Rows& mx, const Matrices& cx, std::size_t threads) {
    const PoseRows x(mx, cx);
    return in_batch(internal::density_inverse_of, x.size(), threads, x);
  });
  m.def("fuse_rows", [](const Rows& mx, const Matrices& cx, const Rows& my, const Matrices& cy,
                        const FuseSettings& settings) {
    return fused_rows({mx, cx}, {my, cy}, settings);
  });
}

}  // namespace posemix::python
