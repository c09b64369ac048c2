# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
#
# The compiler of the wheels: clang, libc++ and the oldest glibc that is supported, all from the PyPI package ziglang.
# tools/make_wheels gives the folder with the commands that call it.
set(commands "$ENV{POSEMIX_WHEEL_COMMANDS}")
set(CMAKE_C_COMPILER "${commands}/cc")
set(CMAKE_CXX_COMPILER "${commands}/c++")
set(CMAKE_AR "${commands}/ar" CACHE FILEPATH "")
set(CMAKE_RANLIB "${commands}/ranlib" CACHE FILEPATH "")
# Optimised always, tests of CMake too: for other settings the compiler would first compile another C++ library.
set(CMAKE_TRY_COMPILE_CONFIGURATION Release)
set(CMAKE_C_FLAGS_INIT "-O2 -g0 -ffunction-sections -fdata-sections")
# Boost 1.74 has base classes that libc++ has only on demand.
# nanobind names stderr without <cstdio>, which Python.h leaves out for the stable ABI and libc++ does not bring.
set(CMAKE_CXX_FLAGS_INIT "${CMAKE_C_FLAGS_INIT} -D_LIBCPP_ENABLE_CXX17_REMOVED_UNARY_BINARY_FUNCTION -include cstdio")
