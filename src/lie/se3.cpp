// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/lie/se3.hpp"

namespace posemix {

template class SE3<double>;

}  // namespace posemix
