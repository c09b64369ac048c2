// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <ostream>
#include <string>

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "posemix/testing/lie_laws.hpp"

namespace posemix::testing {

inline void PrintTo(const Law& law, std::ostream* out) { *out << law.name; }

/// One test for each law of one group.
class LieLaw : public ::testing::TestWithParam<Law> {
 public:
  static std::string name_of(const ::testing::TestParamInfo<Law>& info) { return info.param.name; }
};

inline bool holds(const Law& law) { return rc::check(law.name, law.holds); }

}  // namespace posemix::testing

/// Runs the laws of a group of `dof` degrees of freedom under the name `suite`.
#define POSEMIX_TEST_LIE_LAWS(suite, dof, ...)                                             \
  INSTANTIATE_TEST_SUITE_P(suite, LieLaw, ::testing::ValuesIn(lie_laws<__VA_ARGS__>(dof)), \
                           LieLaw::name_of)
