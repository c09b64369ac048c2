// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors

// Nothing but the place at which the headers shared by all tests are precompiled.

int main() { return 0; }
