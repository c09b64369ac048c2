// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/base/linear.hpp"

namespace posemix {

POSEMIX_LINEAR(, 3);
POSEMIX_LINEAR(, 6);
POSEMIX_LINEAR(, Eigen::Dynamic);

}  // namespace posemix
