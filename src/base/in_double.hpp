// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <boost/math/policies/policy.hpp>

namespace posemix::internal {

/// Has Boost evaluate functions of double in double. It would take long double, whose exp and log
/// are instructions of the processor that makers round in different ways, and twice the time.
using InDouble = boost::math::policies::policy<boost::math::policies::promote_double<false>>;

}  // namespace posemix::internal
