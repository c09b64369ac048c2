// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <limits>
#include <map>
#include <string>

#include "oracle.hpp"

namespace posemix::oracle {

/// Largest norm-wise relative error of each named function, and where it occurred.
class WorstErrors {
 public:
  /// Accepts errors of up to 45 units of rounding of `Scalar`: 1e-14 in double precision.
  template <typename Scalar>
  static WorstErrors of() {
    return {Real(45) * Real(std::numeric_limits<Scalar>::epsilon()),
            Real(16) * Real(std::numeric_limits<Scalar>::denorm_min())};
  }

  /// Error of `got` against `want` relative to |want|, or to `scale` where that is larger.
  template <typename Got, typename Where>
  void add(const std::string& name, const Eigen::MatrixBase<Got>& got, const Matrix& want,
           const Eigen::MatrixBase<Where>& where, const Real& scale = Real(0)) {
    add_raised(name, raise(got), want, raise(where), scale);
  }

  /// Fails for each function whose error exceeds the limit; the errors are properties of the test.
  void check() const;

 private:
  struct Entry {
    Real error{0};
    long count = 0;
    Matrix got, want, where;
  };

  // Results below the normal range are exact to a few of its smallest numbers only.
  WorstErrors(const Real& limit, const Real& smallest) : limit_(limit), smallest_(smallest) {}

  void add_raised(const std::string& name, const Matrix& got, const Matrix& want,
                  const Matrix& where, const Real& scale);

  Real limit_;
  Real smallest_;
  std::map<std::string, Entry> entries_;
};

}  // namespace posemix::oracle
