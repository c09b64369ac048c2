// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

/// Everything of the room `draw`.
#include "posemix/draw/chart.hpp"
#include "posemix/draw/consistency_chart.hpp"
#include "posemix/draw/flags.hpp"
#include "posemix/draw/picture.hpp"
