// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

/// Everything of the room `slam`.
#include "posemix/slam/association.hpp"
#include "posemix/slam/candidate.hpp"
#include "posemix/slam/consistency.hpp"
#include "posemix/slam/evaluation.hpp"
#include "posemix/slam/frame_estimate.hpp"
#include "posemix/slam/frame_input.hpp"
#include "posemix/slam/fuse_views.hpp"
#include "posemix/slam/gaussian_sum_slam.hpp"
#include "posemix/slam/job.hpp"
#include "posemix/slam/method.hpp"
#include "posemix/slam/motion_settings.hpp"
#include "posemix/slam/multi_object_slam.hpp"
#include "posemix/slam/object_model.hpp"
#include "posemix/slam/object_slam.hpp"
#include "posemix/slam/observed_error.hpp"
#include "posemix/slam/particle_slam.hpp"
#include "posemix/slam/run.hpp"
#include "posemix/slam/sequence.hpp"
#include "posemix/slam/simulation.hpp"
#include "posemix/slam/smoothing.hpp"
#include "posemix/slam/symmetric_error.hpp"
#include "posemix/slam/tracker.hpp"
#include "posemix/slam/truth_match.hpp"
