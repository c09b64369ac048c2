// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "standard_streams.hpp"

#include <cerrno>

#include <fcntl.h>
#include <unistd.h>

namespace posemix {

void fill_closed_streams() {
  for (int stream = STDIN_FILENO; stream <= STDERR_FILENO; ++stream) {
    if (::fcntl(stream, F_GETFD) != -1 || errno != EBADF) continue;
    // The lowest descriptor that is free is this one.
    const int flags = stream == STDIN_FILENO ? O_WRONLY : O_RDONLY;
    if (::open("/dev/null", flags) < 0) return;
  }
}

}  // namespace posemix
