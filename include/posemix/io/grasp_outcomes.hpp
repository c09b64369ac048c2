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
/// Lines that start with '#' are comments; the first other line names the columns, of which
/// `scene_id`, `im_id`, `obj_id`, `score`, `est_tx` ... `est_qw` and `gt_tx` ... `gt_qw` (poses
/// T_camera_object, metres and quaternions x y z w) must be there. A column `grasp_GRIPPER` holds 1
/// for success, 0 for failure and nothing where the grasp was not tried. Other columns are not
/// looked at: some of them, as `visib`, are known only with the truth.
/// @throws InvalidInput `name:line: got ..., expected ...` for a column that is missing or there
/// twice, a row of another length, a value that is no number, a quaternion whose norm is further
/// than kQuaternionNormTolerance from one, an outcome other than 0, 1 or nothing, and a second
/// estimate of the same object in the same image
void parse_grasp_outcomes(std::string_view text, const std::string& name,
                          const std::string& dataset, const std::string& estimator,
                          GraspOutcomes& outcomes);

/// Every table of a folder, or of its folder `consensus-driven-uncertainty` where there is one, in
/// the order of their names. The dataset is what comes before the first '_' of a file's name.
/// @throws InvalidInput as parse_grasp_outcomes; when the folder is none or holds no table, and for
/// a table whose name is not of that form
GraspOutcomes read_grasp_outcomes(const std::filesystem::path& folder);

}  // namespace posemix
