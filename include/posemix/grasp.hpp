// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

/// Everything of the room `grasp`.
#include "posemix/grasp/calibration.hpp"
#include "posemix/grasp/consensus.hpp"
#include "posemix/grasp/outcome.hpp"
#include "posemix/grasp/scores.hpp"
#include "posemix/grasp/success_probability.hpp"
#include "posemix/grasp/tolerance_region.hpp"
