// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <span>
#include <string>

#include "study/engine/study.hpp"

namespace posemix {

StudyReport report_fuse_views(std::span<const std::string> results);

}  // namespace posemix
