// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

/// Everything of the room `results`.
#include "posemix/results/consistency_files.hpp"
#include "posemix/results/hypothesis_record.hpp"
#include "posemix/results/provenance.hpp"
#include "posemix/results/report.hpp"
#include "posemix/results/results.hpp"
#include "posemix/results/simulation_folder.hpp"
#include "posemix/results/state_file.hpp"
#include "posemix/results/trace_tracks.hpp"
