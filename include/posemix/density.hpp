// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

/// Everything of the room `density`.
#include "posemix/density/concentrated_gaussian.hpp"
#include "posemix/density/gnomonic.hpp"
#include "posemix/density/operations.hpp"
#include "posemix/density/pose_stack.hpp"
#include "posemix/density/projected_gaussian.hpp"
#include "posemix/density/projected_moments.hpp"
#include "posemix/density/projected_operations.hpp"
