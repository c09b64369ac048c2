// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

/// Everything of the room `reduction`.
#include "posemix/reduction/loss.hpp"
#include "posemix/reduction/merge.hpp"
#include "posemix/reduction/merge_impl.hpp"
#include "posemix/reduction/pair.hpp"
#include "posemix/reduction/pair_table.hpp"
#include "posemix/reduction/reduce.hpp"
