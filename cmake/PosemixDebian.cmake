# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
#
# Two Debian packages by CPack (make deb): posemix, the program, with its manual pages, completion and documents, and
# libposemix-dev, the static library with its headers. What the program links is found by dpkg-shlibdeps.
set(CPACK_GENERATOR DEB)
set(CPACK_VERBATIM_VARIABLES ON)
set(CPACK_PACKAGE_VENDOR "posemix contributors")
set(CPACK_PACKAGE_CONTACT "posemix contributors <contributors@posemix.invalid>")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL program development)
set(CPACK_POSEMIX_VERSION "${PROJECT_VERSION}")
set(CPACK_PRE_BUILD_SCRIPTS "${CMAKE_CURRENT_LIST_DIR}/debian_files.cmake")

set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)

set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME posemix)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SUGGESTS "libposemix-dev, bash-completion, xdg-utils")
set(CPACK_COMPONENT_PROGRAM_DESCRIPTION "The program: poses of a camera and of objects from noisy detections,
object SLAM, fusion of views, square tags, grasps, calibration of
covariances, and a report for the browser.")

# A static library needs what it was compiled with; fmt has its major version in all names.
math(EXPR fmt_next "${fmt_VERSION_MAJOR} + 1")
set(needs "libeigen3-dev (>= 3.4)" "libfmt-dev (>= ${fmt_VERSION_MAJOR})" "libfmt-dev (<< ${fmt_next})" "libhwy-dev (>= 1.0.3)"
  "libnlopt-dev (>= 2.7)" "zlib1g-dev")
if(POSEMIX_WITH_YAML)
  list(APPEND needs "libyaml-cpp-dev (>= 0.7)")
endif()
list(JOIN needs ", " CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libposemix-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SUGGESTS "posemix, libgtest-dev, librapidcheck-dev, libboost-dev")
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION "The C++20 library: filters for object SLAM, grasps, files and reports.
It is static, with headers, for find_package(posemix) in CMake.")

# Documents lie below the name of the package. The licence of the library is that of what it was compiled with too.
file(READ "${PROJECT_SOURCE_DIR}/LICENSE" licence)
string(REGEX MATCH "Copyright ([^\n]*)" copyright "${licence}")
set(copyright "${CMAKE_MATCH_1}")
string(REGEX MATCH "Permission is hereby.*" licence "${licence}")
string(STRIP "${licence}" licence)
string(REGEX REPLACE "\n\n" "\n.\n" licence "${licence}")
string(REGEX REPLACE "\n" "\n " licence "${licence}")
configure_file("${CMAKE_CURRENT_LIST_DIR}/debian_copyright.in" "${PROJECT_BINARY_DIR}/debian/copyright" @ONLY)
set(documents "${CMAKE_INSTALL_DATAROOTDIR}/doc")
install(DIRECTORY "${PROJECT_SOURCE_DIR}/docs" DESTINATION "${documents}/posemix" COMPONENT program
  FILES_MATCHING PATTERN "*.md" PATTERN images EXCLUDE PATTERN _api EXCLUDE)
install(DIRECTORY "${PROJECT_SOURCE_DIR}/configs" DESTINATION "${documents}/posemix/examples" COMPONENT program)
install(DIRECTORY "${PROJECT_SOURCE_DIR}/examples/" DESTINATION "${documents}/libposemix-dev/examples" COMPONENT development
  FILES_MATCHING PATTERN "*.cpp")
foreach(package IN ITEMS posemix=program libposemix-dev=development)
  string(REPLACE "=" ";" package "${package}")
  list(GET package 0 name)
  list(GET package 1 component)
  install(FILES "${PROJECT_BINARY_DIR}/debian/copyright" DESTINATION "${documents}/${name}" COMPONENT ${component})
  install(FILES "${PROJECT_SOURCE_DIR}/CHANGELOG.md" DESTINATION "${documents}/${name}" COMPONENT ${component})
endforeach()
include(CPack)
