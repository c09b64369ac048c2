// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

/// Everything of the room `divergence`.
#include "posemix/divergence/conversion.hpp"
#include "posemix/divergence/estimate.hpp"
#include "posemix/divergence/gaussian.hpp"
#include "posemix/divergence/gaussian_isd.hpp"
#include "posemix/divergence/monte_carlo.hpp"
#include "posemix/divergence/paper_grid.hpp"
#include "posemix/divergence/projected.hpp"
#include "posemix/divergence/so3_quadrature.hpp"
#include "posemix/divergence/wasserstein.hpp"
