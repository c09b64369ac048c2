# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
include(CMakePackageConfigHelpers)

get_property(posemix_rooms GLOBAL PROPERTY POSEMIX_EXPORTED_ROOMS)

install(DIRECTORY "${PROJECT_SOURCE_DIR}/include/posemix" DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}"
  COMPONENT development FILES_MATCHING PATTERN "*.hpp")
install(TARGETS ${posemix_rooms} posemix_umbrella EXPORT posemix-targets COMPONENT development)
install(EXPORT posemix-targets NAMESPACE posemix:: DESTINATION "${POSEMIX_CMAKE_DIR}" COMPONENT development)
install(TARGETS posemix_testing EXPORT posemix-testing-targets COMPONENT development)
install(EXPORT posemix-testing-targets NAMESPACE posemix:: DESTINATION "${POSEMIX_CMAKE_DIR}" COMPONENT development)

configure_package_config_file("${CMAKE_CURRENT_LIST_DIR}/posemix-config.cmake.in"
  "${PROJECT_BINARY_DIR}/posemix-config.cmake" INSTALL_DESTINATION "${POSEMIX_CMAKE_DIR}")
write_basic_package_version_file("${PROJECT_BINARY_DIR}/posemix-config-version.cmake"
  COMPATIBILITY SameMinorVersion)
install(FILES "${CMAKE_CURRENT_LIST_DIR}/posemix-nlopt.cmake" "${PROJECT_BINARY_DIR}/posemix-config.cmake"
  "${PROJECT_BINARY_DIR}/posemix-config-version.cmake" DESTINATION "${POSEMIX_CMAKE_DIR}"
  COMPONENT development)

# All that is installed, and nothing that is only tested.
add_custom_target(posemix_installed)
foreach(room IN LISTS posemix_rooms)
  get_target_property(kind ${room} TYPE)
  if(kind STREQUAL STATIC_LIBRARY)
    add_dependencies(posemix_installed ${room})
  endif()
endforeach()
if(TARGET posemix)
  include(PosemixManuals)
  add_dependencies(posemix_installed posemix_manuals)
  include(PosemixDebian)
endif()
