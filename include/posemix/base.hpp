// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

/// Everything of the room `base`.
#include "posemix/base/draw_index.hpp"
#include "posemix/base/error.hpp"
#include "posemix/base/gaussian_cubature.hpp"
#include "posemix/base/limits.hpp"
#include "posemix/base/linear.hpp"
#include "posemix/base/random.hpp"
#include "posemix/base/range.hpp"
#include "posemix/base/sobol.hpp"
#include "posemix/base/state_fields.hpp"
#include "posemix/base/statistics.hpp"
#include "posemix/base/stopwatch.hpp"
#include "posemix/base/units.hpp"
#include "posemix/base/vector_instructions.hpp"
#include "posemix/base/words.hpp"
