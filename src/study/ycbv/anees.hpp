// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include "study/engine/table.hpp"

namespace posemix {

/// One row per detector, method and pose (relative, right mode, camera, world) that has an ANEES:
/// over the recordings its median, mean and worst, and the share within 0.5 to 2.
StudyTable summarise_anees(const StudyTable& rows);

}  // namespace posemix
