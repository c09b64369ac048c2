# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors

# posemix_need(<package> <version> <Debian package> [argument of find_package]...)
#
# Finds a package. All that are missing are told at once.
macro(posemix_need package version debian)
  find_package(${package} ${version} QUIET ${ARGN})
  if(NOT ${package}_FOUND)
    list(APPEND posemix_missing "${package} ${version} or later, Debian's ${debian}")
  endif()
endmacro()

set(posemix_missing)
posemix_need(Eigen3 3.4 libeigen3-dev NO_MODULE)
posemix_need(Boost 1.74 libboost-dev CONFIG)
posemix_need(fmt 9 libfmt-dev)
posemix_need(tomlplusplus 3.3 libtomlplusplus-dev)
posemix_need(nlohmann_json 3.11 nlohmann-json3-dev)
# NLopt::nlopt, whose C++ interface is header-only.
posemix_need(NLopt 2.7 libnlopt-cxx-dev CONFIG)
include("${CMAKE_CURRENT_LIST_DIR}/posemix-nlopt.cmake")
# Highway, for vector instructions that are chosen at run time.
posemix_need(hwy 1.0.3 libhwy-dev CONFIG)
posemix_need(ZLIB 1.2 zlib1g-dev)
find_path(RANDOM123_INCLUDE_DIR Random123/philox.h)
mark_as_advanced(RANDOM123_INCLUDE_DIR)
if(NOT RANDOM123_INCLUDE_DIR)
  list(APPEND posemix_missing "Random123, Debian's librandom123-dev")
endif()
if(POSEMIX_BUILD_PROGRAM)
  posemix_need(CLI11 2.1 libcli11-dev)
  # `posemix data` downloads, checks and unpacks files.
  if(POSEMIX_FETCH)
    posemix_need(CURL 7.85 libcurl4-openssl-dev)
    posemix_need(OpenSSL 3.0 libssl-dev COMPONENTS Crypto)
    posemix_need(LibArchive 3.6 libarchive-dev)
  endif()
endif()
if(posemix_missing)
  list(JOIN posemix_missing "\n  " posemix_missing)
  message(FATAL_ERROR "posemix is built with these packages, which were not found:\n  ${posemix_missing}\n"
    "On Debian `tools/bootstrap build` installs them. A wheel needs neither them nor a compiler.")
endif()

find_package(Threads REQUIRED)
set(POSEMIX_WITH_MPI OFF)
if(POSEMIX_MPI)
  find_package(MPI 3.0 COMPONENTS CXX)
  set(POSEMIX_WITH_MPI ${MPI_CXX_FOUND})
endif()

# The target yaml-cpp, for the camera and tag files of fiducials.
set(POSEMIX_WITH_YAML OFF)
if(POSEMIX_YAML)
  find_package(yaml-cpp 0.7 CONFIG)
  set(POSEMIX_WITH_YAML ${yaml-cpp_FOUND})
endif()

# CycloneDDS::ddsc and its compiler of IDL, whose messages are C, for `posemix live`.
set(POSEMIX_WITH_CYCLONE OFF)
if(POSEMIX_CYCLONE AND POSEMIX_BUILD_PROGRAM)
  find_package(CycloneDDS 0.10 CONFIG)
  find_program(POSEMIX_IDLC idlc)
  mark_as_advanced(POSEMIX_IDLC)
  if(CycloneDDS_FOUND AND POSEMIX_IDLC)
    enable_language(C)
    set(POSEMIX_WITH_CYCLONE ON)
  endif()
endif()

add_library(posemix_random123 INTERFACE)
target_include_directories(posemix_random123 SYSTEM INTERFACE "${RANDOM123_INCLUDE_DIR}")
add_library(Random123::Random123 ALIAS posemix_random123)

if(POSEMIX_BUILD_TESTS)
  if(NOT POSEMIX_FETCH)
    message(FATAL_ERROR "The tests need downloads: POSEMIX_BUILD_TESTS=ON goes with POSEMIX_FETCH=ON")
  endif()
  find_package(GTest 1.12 REQUIRED)
  # MatIO::MatIO, which writes the MATLAB files that tests read.
  find_package(MatIO 1.5 REQUIRED)
  find_package(rapidcheck REQUIRED)
endif()
if(POSEMIX_BUILD_BENCH)
  find_package(benchmark 1.7 REQUIRED)
endif()
