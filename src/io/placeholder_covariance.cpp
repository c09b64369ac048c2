// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/io/placeholder_covariance.hpp"

namespace posemix {

bool is_placeholder_covariance(const Matrix6d& covariance) {
  return covariance == Matrix6d::Zero() || covariance == Matrix6d::Identity() ||
         covariance(0, 0) == -1.0;
}

}  // namespace posemix
