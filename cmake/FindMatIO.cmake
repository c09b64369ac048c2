# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
#
# Defines MatIO::MatIO, the library that writes MATLAB files for the tests, because it has no CMake package of its own.
include(FindPackageHandleStandardArgs)
find_path(MatIO_INCLUDE_DIR matio.h)
find_library(MatIO_LIBRARY matio)
mark_as_advanced(MatIO_INCLUDE_DIR MatIO_LIBRARY)
if(MatIO_INCLUDE_DIR AND EXISTS "${MatIO_INCLUDE_DIR}/matio_pubconf.h")
  file(STRINGS "${MatIO_INCLUDE_DIR}/matio_pubconf.h" MatIO_version_lines
    REGEX "#define MATIO_(MAJOR|MINOR|RELEASE_LEVEL)[A-Z_]* +[0-9]+")
  string(REGEX REPLACE "[^0-9;]" "" MatIO_VERSION "${MatIO_version_lines}")
  string(REPLACE ";" "." MatIO_VERSION "${MatIO_VERSION}")
endif()
find_package_handle_standard_args(MatIO REQUIRED_VARS MatIO_LIBRARY MatIO_INCLUDE_DIR VERSION_VAR MatIO_VERSION)
if(MatIO_FOUND AND NOT TARGET MatIO::MatIO)
  add_library(MatIO::MatIO UNKNOWN IMPORTED)
  set_target_properties(MatIO::MatIO PROPERTIES
    IMPORTED_LOCATION "${MatIO_LIBRARY}" INTERFACE_INCLUDE_DIRECTORIES "${MatIO_INCLUDE_DIR}")
endif()
