// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <vector>

#include "density.hpp"
#include "posemix/filter/gaussian_sum_filter.hpp"
#include "posemix/filter/multi_object_filter.hpp"
#include "poses.hpp"
