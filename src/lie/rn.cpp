// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/lie/rn.hpp"

namespace posemix {

template class Rn<3, double>;
template class Rn<Eigen::Dynamic, double>;

}  // namespace posemix
