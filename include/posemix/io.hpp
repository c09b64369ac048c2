// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

/// Everything of the room `io`.
#include "posemix/io/bop.hpp"
#include "posemix/io/bop_models.hpp"
#include "posemix/io/bop_views.hpp"
#include "posemix/io/dataset.hpp"
#include "posemix/io/dataset_sequence.hpp"
#include "posemix/io/grasp_outcomes.hpp"
#include "posemix/io/gzip.hpp"
#include "posemix/io/mixture_file.hpp"
#include "posemix/io/npy.hpp"
#include "posemix/io/object_poses.hpp"
#include "posemix/io/observation_csv.hpp"
#include "posemix/io/observation_jsonl.hpp"
#include "posemix/io/output_file.hpp"
#include "posemix/io/output_folder.hpp"
#include "posemix/io/placeholder_covariance.hpp"
#include "posemix/io/ply.hpp"
#include "posemix/io/pose_samples.hpp"
#include "posemix/io/pose_table.hpp"
#include "posemix/io/posterior_file.hpp"
#include "posemix/io/rigid.hpp"
#include "posemix/io/text.hpp"
#include "posemix/io/tum.hpp"
#include "posemix/io/tum_covariance.hpp"
