// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "worst_errors.hpp"

#include <algorithm>
#include <iomanip>
#include <sstream>

#include <gtest/gtest.h>

namespace posemix::oracle {

void WorstErrors::add_raised(const std::string& name, const Matrix& got, const Matrix& want,
                             const Matrix& where, const Real& scale) {
  const Real distance = (got - want).norm() - smallest_;
  Real error = distance / std::max(Real(want.norm()), scale);
  if (got.allFinite() && distance <= Real(0)) error = Real(0);
  if (!got.allFinite()) error = std::numeric_limits<Real>::infinity();
  Entry& entry = entries_[name];
  const bool first = ++entry.count == 1;
  if (!first && error <= entry.error) return;
  entry.error = error;
  entry.got = got;
  entry.want = want;
  entry.where = where;
}

void WorstErrors::check() const {
  for (const auto& [name, entry] : entries_) {
    std::ostringstream error;
    error << std::setprecision(2) << std::scientific << entry.error << " over " << entry.count;
    ::testing::Test::RecordProperty(name, error.str());
    EXPECT_LE(entry.error, limit_)
        << std::setprecision(20) << name << " at [" << entry.where.transpose() << "]\nexpected\n"
        << entry.want << "\nactual\n"
        << entry.got;
  }
}

}  // namespace posemix::oracle
