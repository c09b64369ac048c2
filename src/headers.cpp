// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors

// Nothing but the place at which the headers shared by all rooms are precompiled.
