// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/lie/pose_stack.hpp"

namespace posemix {

template class PoseStack<double>;

}  // namespace posemix
