// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include "study/engine/table.hpp"

namespace posemix {

/// One row per detector, method and error (rotation, position): of the recordings' medians over the
/// frames with a detection, the medians of estimate and detection, the worst ratio of the two, and
/// the number of recordings in which the estimate's is at most the detection's.
StudyTable summarise_paired(const StudyTable& rows);

}  // namespace posemix
