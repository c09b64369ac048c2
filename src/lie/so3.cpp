// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/lie/so3.hpp"

namespace posemix {

template class SO3<double>;

}  // namespace posemix
