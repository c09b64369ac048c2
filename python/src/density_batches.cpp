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
  nb::tuple tuple() { return nb::make_tuple(std::move(means.array), std::move(covariances.array)); }
};

template <class Operation>
nb::tuple each_density(const PoseRows& x, const PoseRows& y, Operation operation) {
  if (x.size() != y.size() && x.size() != 1 && y.size() != 1) {
    throw InvalidInput(fmt::format(
        "{} densities and {}; expected as many of both, or one of either", x.size(), y.size()));
  }
  const std::size_t n = x.size() == 1 ? y.size() : x.size();
  PoseRowsOut out(n);
  {
    const nb::gil_scoped_release unlocked;
    for (std::size_t i = 0; i < n; ++i) out.set(i, operation(x.at(i), y.at(i)));
  }
  return out.tuple();
}

}  // namespace

void bind_density_batches(nb::module_& m) {
  m.def("compose_rows", [](const Rows& mx, const Matrices& cx, const Rows& my, const Matrices& cy) {
    return each_density({mx, cx}, {my, cy},
                        [](const auto& x, const auto& y) { return compose(x, y); });
  });
  m.def("between_rows", [](const Rows& mx, const Matrices& cx, const Rows& my, const Matrices& cy) {
    return each_density({mx, cx}, {my, cy},
                        [](const auto& x, const auto& y) { return between(x, y); });
  });
  m.def("inverse_rows", [](const Rows& mx, const Matrices& cx) {
    const PoseRows x(mx, cx);
    return each_density(x, x, [](const auto& a, const auto&) { return inverse(a); });
  });
  m.def("fuse_rows", [](const Rows& mx, const Matrices& cx, const Rows& my, const Matrices& cy,
                        const FuseSettings& settings) {
    std::vector<bool> converged;
    const nb::tuple fused = each_density({mx, cx}, {my, cy}, [&](const auto& x, const auto& y) {
      auto result = fuse(x, y, settings);
      converged.push_back(result.converged);
      return std::move(result.density);
    });
    return nb::make_tuple(fused[0], fused[1], converged);
  });
}

}  // namespace posemix::python
