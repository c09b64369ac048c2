// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

namespace posemix {

/// Takes the descriptors of standard streams that the program was started without, so that no file
/// that is opened later becomes one of them. What is read from them or written to them is an error,
/// as if they were closed.
void fill_closed_streams();

}  // namespace posemix
