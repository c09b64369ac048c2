// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

/// Everything of the room `filter`.
#include "posemix/filter/gaussian_sum_filter.hpp"
#include "posemix/filter/iterated_update.hpp"
#include "posemix/filter/mode_measurement.hpp"
#include "posemix/filter/motion_models.hpp"
#include "posemix/filter/moving_object_filter.hpp"
#include "posemix/filter/moving_object_smoother.hpp"
#include "posemix/filter/multi_object_filter.hpp"
#include "posemix/filter/multi_object_ranges.hpp"
#include "posemix/filter/object_motion.hpp"
#include "posemix/filter/object_prior.hpp"
#include "posemix/filter/predict.hpp"
#include "posemix/filter/robust_update.hpp"
#include "posemix/filter/update.hpp"
