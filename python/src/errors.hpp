// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <vector>

#include "array_like.hpp"
#include "density.hpp"
#include "posemix/detector/error_mixture.hpp"

/// Errors of estimates as rows of six numbers.
namespace posemix::python {

inline std::vector<Vector6d> errors_of(const Rows& rows) {
  require_columns(rows, 6, "errors");
  std::vector<Vector6d> errors;
  for (std::size_t i = 0; i < rows.shape(0); ++i)
    errors.emplace_back(Eigen::Map<const Vector6d>(rows.data() + 6 * i));
  return errors;
}

inline Array rows_of(const std::vector<Vector6d>& errors) {
  NewArray out({errors.size(), 6});
  for (std::size_t i = 0; i < errors.size(); ++i)
    Eigen::Map<Vector6d>(out.data + 6 * i) = errors[i];
  return std::move(out.array);
}

inline std::vector<Vector6d> finite_errors(const ArrayLike& values) {
  std::vector<Vector6d> errors = errors_of(ShapedRows(values, 6, "errors").rows);
  for (std::size_t i = 0; i < errors.size(); ++i)
    if (!errors[i].allFinite())
      throw InvalidInput(fmt::format("error {} is not finite; expected finite numbers", i));
  return errors;
}

inline ErrorMixture unit_mixture() {
  return ErrorMixture(Mixture<ErrorMixture::Gaussian>(
      {{0.0, ErrorMixture::Gaussian(Rnd<6>(Vector6d::Zero()), Matrix6d::Identity())}}));
}

}  // namespace posemix::python
