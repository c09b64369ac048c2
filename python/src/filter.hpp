// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <vector>

#include "density.hpp"
#include "dict.hpp"
#include "posemix/filter/gaussian_sum_filter.hpp"
#include "posemix/filter/multi_object_filter.hpp"
#include "poses.hpp"

namespace posemix::python {

nb::dict report_dict(const ReductionReport& report);
nb::dict report_dict(const UpdateReport& report);
nb::dict report_dict(const ObjectUpdateReport& report);
nb::list hypothesis_list(const std::vector<ObjectHypothesis>& hypotheses);

}  // namespace posemix::python
