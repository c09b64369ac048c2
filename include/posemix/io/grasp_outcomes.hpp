// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "posemix/grasp/outcome.hpp"

/// Tables of pose estimates with the outcomes of grasps: `DATASET_ESTIMATOR.csv`, one row per
/// estimate.
namespace posemix {

/// Adds the rows of one table to `outcomes`.
///
/// Lines that start with '#' are comments. The first other line names the columns, among them
/// `scene_id`, `im_id`, `obj_id`, `score`, `est_tx` ... `est_qw` and `gt_tx` ... `gt_qw` (poses
/// T_camera_object in metres, quaternions x y z w). A column `grasp_GRIPPER` has 1 for success, 0
/// for failure and nothing for a grasp that was not tried. Other columns are ignored, because some
/// of them, such as `visib`, are known only with the truth.
/// @throws InvalidInput `name:line: got ..., expected ...` for a column that is missing or occurs
/// twice, a row of another length, a value that is not a number, a quaternion whose norm differs
/// from one by more than kQuaternionNormTolerance, an outcome other than 0, 1 or nothing, and a
/// second estimate of the same object in the same image
void parse_grasp_outcomes(std::string_view text, const std::string& name,
                          const std::string& dataset, const std::string& estimator,
                          GraspOutcomes& outcomes);

/// Reads all tables of a folder, or of its folder `consensus-driven-uncertainty` if there is one,
/// in the order of their names. The name of the dataset is the part of the file's name before the
/// first '_'.
/// @throws InvalidInput as parse_grasp_outcomes, for a path that is not a folder or a folder
/// without tables, and for a table with another form of name
GraspOutcomes read_grasp_outcomes(const std::filesystem::path& folder);

}  // namespace posemix
