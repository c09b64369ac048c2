// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include "study/engine/table.hpp"

namespace posemix {

/// One row per detector and method: medians over the recordings, and comparisons with the published
/// results and with the odometry.
StudyTable summarise_ycbv(const StudyTable& rows);

}  // namespace posemix
