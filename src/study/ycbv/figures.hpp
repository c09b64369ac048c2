// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <vector>

#include "study/engine/study.hpp"
#include "study/engine/table.hpp"

namespace posemix {

/// errors.svg: the errors of every method, sorted; camera.svg: the camera's error against that of
/// the odometry alone.
std::vector<StudyFile> draw_ycbv(const StudyTable& rows);

}  // namespace posemix
