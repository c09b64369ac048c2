# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(Boost 1.74 REQUIRED CONFIG)
find_package(fmt 9 REQUIRED)
find_package(tomlplusplus 3.3 REQUIRED)
find_package(nlohmann_json 3.11 REQUIRED)
# NLopt::nlopt, whose C++ interface is header-only.
find_package(NLopt 2.7 REQUIRED CONFIG)
# Highway, for vector instructions that are chosen at run time.
find_package(hwy 1.0.3 REQUIRED CONFIG)

find_package(ZLIB 1.2 REQUIRED)
find_package(Threads REQUIRED)
set(POSEMIX_WITH_MPI OFF)
if(POSEMIX_MPI)
  find_package(MPI 3.0 COMPONENTS CXX)
  set(POSEMIX_WITH_MPI ${MPI_CXX_FOUND})
endif()

# MatIO::MatIO, for the MATLAB files of YCB-Video.
set(POSEMIX_WITH_MATIO OFF)
if(POSEMIX_MATIO)
  find_package(MatIO 1.5)
  set(POSEMIX_WITH_MATIO ${MatIO_FOUND})
endif()

# The target yaml-cpp, for the camera and tag files of fiducials.
set(POSEMIX_WITH_YAML OFF)
if(POSEMIX_YAML)
  find_package(yaml-cpp 0.7 CONFIG)
  set(POSEMIX_WITH_YAML ${yaml-cpp_FOUND})
endif()

find_path(RANDOM123_INCLUDE_DIR Random123/philox.h REQUIRED)
mark_as_advanced(RANDOM123_INCLUDE_DIR)
add_library(posemix_random123 INTERFACE)
target_include_directories(posemix_random123 SYSTEM INTERFACE "${RANDOM123_INCLUDE_DIR}")
add_library(Random123::Random123 ALIAS posemix_random123)

if(POSEMIX_BUILD_PROGRAM)
  find_package(CLI11 2.1 REQUIRED)
  # `posemix data` downloads, checks and unpacks files.
  find_package(CURL 7.85 REQUIRED)
  find_package(OpenSSL 3.0 REQUIRED COMPONENTS Crypto)
  find_package(LibArchive 3.6 REQUIRED)
endif()
if(POSEMIX_BUILD_TESTS)
  find_package(GTest 1.12 REQUIRED)
  find_package(rapidcheck REQUIRED)
endif()
if(POSEMIX_BUILD_BENCH)
  find_package(benchmark 1.7 REQUIRED)
endif()
