// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

/// Everything of the room `config`.
#include "posemix/config/data_folder.hpp"
#include "posemix/config/detector_noise.hpp"
#include "posemix/config/noise_toml.hpp"
#include "posemix/config/observation_sequence.hpp"
#include "posemix/config/sequence_file.hpp"
#include "posemix/config/simulation_config.hpp"
#include "posemix/config/symmetries.hpp"
#include "posemix/config/toml_table.hpp"
