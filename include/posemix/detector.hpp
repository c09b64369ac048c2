// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

/// Everything of the room `detector`.
#include "posemix/detector/default_noise.hpp"
#include "posemix/detector/detector_noise.hpp"
#include "posemix/detector/error_mixture.hpp"
#include "posemix/detector/noise_correlation.hpp"
#include "posemix/detector/noise_em.hpp"
#include "posemix/detector/noise_fit.hpp"
#include "posemix/detector/noise_modes.hpp"
#include "posemix/detector/noise_observation.hpp"
#include "posemix/detector/noise_statistics.hpp"
#include "posemix/detector/object_sensor.hpp"
#include "posemix/detector/observation.hpp"
#include "posemix/detector/odometry_noise.hpp"
#include "posemix/detector/slow_error_fit.hpp"
#include "posemix/detector/symmetry.hpp"
