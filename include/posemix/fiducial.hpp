// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

/// Everything of the room `fiducial`.
#include "posemix/fiducial/camera_file.hpp"
#include "posemix/fiducial/camera_model.hpp"
#include "posemix/fiducial/corner_file.hpp"
#include "posemix/fiducial/corner_noise.hpp"
#include "posemix/fiducial/fiducial_folder.hpp"
#include "posemix/fiducial/fiducial_sequence.hpp"
#include "posemix/fiducial/fiducials.hpp"
#include "posemix/fiducial/rig_calibration.hpp"
#include "posemix/fiducial/tag_file.hpp"
#include "posemix/fiducial/tag_odometry.hpp"
#include "posemix/fiducial/tag_pose.hpp"
