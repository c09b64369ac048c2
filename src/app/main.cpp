// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "program.hpp"

int main(int argc, char** argv) { return posemix::run_program(argc, argv); }
