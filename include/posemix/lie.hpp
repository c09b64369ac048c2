// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

/// Everything of the room `lie`.
#include "posemix/lie/batch.hpp"
#include "posemix/lie/batch_rows.hpp"
#include "posemix/lie/bernoulli.hpp"
#include "posemix/lie/concept.hpp"
#include "posemix/lie/interpolate.hpp"
#include "posemix/lie/lie.hpp"
#include "posemix/lie/mean.hpp"
#include "posemix/lie/pose_blocks.hpp"
#include "posemix/lie/pose_checks.hpp"
#include "posemix/lie/pose_covariance.hpp"
#include "posemix/lie/pose_stack.hpp"
#include "posemix/lie/rn.hpp"
#include "posemix/lie/rotation_of.hpp"
#include "posemix/lie/se3.hpp"
#include "posemix/lie/small_angle.hpp"
#include "posemix/lie/so3.hpp"
#include "posemix/lie/twist_matrix.hpp"
