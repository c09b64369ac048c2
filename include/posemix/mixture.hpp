// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

/// Everything of the room `mixture`.
#include "posemix/mixture/density_kernel.hpp"
#include "posemix/mixture/em.hpp"
#include "posemix/mixture/em_gaussian.hpp"
#include "posemix/mixture/em_impl.hpp"
#include "posemix/mixture/em_kernels.hpp"
#include "posemix/mixture/em_projected.hpp"
#include "posemix/mixture/em_rn.hpp"
#include "posemix/mixture/em_rows.hpp"
#include "posemix/mixture/em_samples.hpp"
#include "posemix/mixture/em_start.hpp"
#include "posemix/mixture/log_densities.hpp"
#include "posemix/mixture/log_weights.hpp"
#include "posemix/mixture/mixture.hpp"
#include "posemix/mixture/moments.hpp"
#include "posemix/mixture/operations.hpp"
#include "posemix/mixture/projected_mixture.hpp"
#include "posemix/mixture/projected_operations.hpp"
#include "posemix/mixture/samples.hpp"
#include "posemix/mixture/tangent_moments.hpp"
