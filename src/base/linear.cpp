// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/base/linear.hpp"

namespace posemix {
namespace {

/// Eigen sums a long product in pieces that fit the caches of the machine. Pieces of one size, of
/// caches of 32 KiB, 512 KiB and 4 MiB, give the same bits on all machines.
const bool kPiecesAreOfOneSize = [] {
  Eigen::setCpuCacheSizes(32 << 10, 512 << 10, 4 << 20);
  return true;
}();

}  // namespace

POSEMIX_LINEAR(, 3);
POSEMIX_LINEAR(, 6);
POSEMIX_LINEAR(, Eigen::Dynamic);

}  // namespace posemix
