# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
include(GoogleTest)

# posemix_add_room(<room>
#   [SOURCES <file>...]      none: the room is header-only, an INTERFACE library
#   [DEPENDS <target>...]    libraries that the room's headers use (posemix::<room>, Eigen3::Eigen, ...)
#   [PRIVATE <target>...]    compiled libraries that only the sources use (fmt::fmt, ...); users still link them
#   [BUILD_ONLY <target>...] header-only libraries that only the sources use; users do not need them
#   [INTERNAL])              neither installed nor part of posemix::posemix
#
# Defines the library posemix_<room> with the alias posemix::<room>.
function(posemix_add_room room)
  cmake_parse_arguments(PARSE_ARGV 1 arg "INTERNAL" "" "SOURCES;DEPENDS;PRIVATE;BUILD_ONLY")
  if(arg_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "posemix_add_room(${room}): unknown arguments ${arg_UNPARSED_ARGUMENTS}")
  endif()
  set(target posemix_${room})
  if(arg_SOURCES)
    add_library(${target} STATIC ${arg_SOURCES})
    posemix_apply_policy(${target})
    posemix_precompile(${target} FROM posemix_room_headers)
    posemix_unite(${target} 9)
    if(room IN_LIST POSEMIX_SMALL)
      target_compile_options(${target} PRIVATE -Oz)
    endif()
    set(scope PUBLIC)
  else()
    add_library(${target} INTERFACE)
    target_compile_features(${target} INTERFACE cxx_std_20)
    set(scope INTERFACE)
  endif()
  add_library(posemix::${room} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${room})
  target_include_directories(${target} ${scope}
    "$<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include>"
    "$<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>")
  target_link_libraries(${target} ${scope} ${arg_DEPENDS})
  if(arg_SOURCES)
    # Private headers that rooms share are included by their path relative to src/.
    target_include_directories(${target} PRIVATE "${PROJECT_SOURCE_DIR}/src")
    target_link_libraries(${target} PRIVATE ${arg_PRIVATE})
    foreach(library IN LISTS arg_BUILD_ONLY)
      target_link_libraries(${target} PRIVATE "$<BUILD_INTERFACE:${library}>")
    endforeach()
  endif()
  if(NOT arg_INTERNAL)
    set_property(GLOBAL APPEND PROPERTY POSEMIX_EXPORTED_ROOMS ${target})
  endif()
endfunction()

# posemix_vector_kernels(<file>...)
#
# Sources that Highway compiles once for every set of vector instructions: such a file includes itself, by its name alone
# and before other headers.
function(posemix_vector_kernels)
  set_source_files_properties(${ARGN} PROPERTIES
    INCLUDE_DIRECTORIES "${CMAKE_CURRENT_SOURCE_DIR}" SKIP_PRECOMPILE_HEADERS ON)
endfunction()

# posemix_add_program(SOURCES <file>... [DEPENDS <target>...])
#
# Defines the program posemix, at the top of the build folder.
function(posemix_add_program)
  cmake_parse_arguments(PARSE_ARGV 0 arg "" "" "SOURCES;DEPENDS")
  add_executable(posemix ${arg_SOURCES})
  posemix_apply_policy(posemix)
  target_link_libraries(posemix PRIVATE ${arg_DEPENDS})
  set_target_properties(posemix PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}")
  if(POSEMIX_INSTALL)
    install(TARGETS posemix RUNTIME COMPONENT program)
  endif()
endfunction()

# posemix_add_tests(<room>
#   SOURCES <file>...
#   [DEPENDS <target>...]  libraries under test
#   [LABEL <label>]        slow, damage, faults: left out of coverage
#   [TIMEOUT <seconds>])   of one test case, 300 unless given
#
# Defines the program tests_<room>, or tests_<room>_<label>, linked with gtest_main, rapidcheck and posemix::testing, and
# one ctest test <room>.<suite>.<case> per case.
# Helpers that rooms share are included by their path relative to tests/ ("filter/scenario.hpp").
# Property tests use a fixed RapidCheck seed; RC_PARAMS="seed=7" in the environment of ctest overrides it.
function(posemix_add_tests room)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "TIMEOUT;LABEL" "SOURCES;DEPENDS")
  if(arg_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "posemix_add_tests(${room}): unknown arguments ${arg_UNPARSED_ARGUMENTS}")
  endif()
  if(NOT arg_TIMEOUT)
    set(arg_TIMEOUT 300)
  endif()
  set(name tests_${room})
  set(label)
  if(arg_LABEL)
    string(APPEND name _${arg_LABEL})
    set(label LABELS ${arg_LABEL})
    if(arg_LABEL STREQUAL "slow")
      list(APPEND label COST 100)  # they begin first, so that no processor waits for the last of them
    endif()
  endif()
  add_executable(${name} ${arg_SOURCES})
  posemix_apply_test_policy(${name})
  posemix_precompile(${name} FROM posemix_test_headers)
  posemix_unite(${name} 6)
  target_link_libraries(${name} PRIVATE posemix_test_support ${arg_DEPENDS} posemix::testing GTest::gtest_main)
  target_include_directories(${name} PRIVATE "${PROJECT_SOURCE_DIR}/tests" "${PROJECT_SOURCE_DIR}/src")
  target_compile_definitions(${name} PRIVATE POSEMIX_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  gtest_discover_tests(${name} TEST_PREFIX ${room}. DISCOVERY_MODE PRE_TEST DISCOVERY_TIMEOUT 60
    PROPERTIES TIMEOUT ${arg_TIMEOUT} ${label}
    ENVIRONMENT_MODIFICATION "RC_PARAMS=string_prepend:seed=20221124 ")
endfunction()

# posemix_add_bench(bench_<x> SOURCES <file>... [DEPENDS <target>...])
#
# Defines a Google Benchmark program that `make bench` runs.
function(posemix_add_bench name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "SOURCES;DEPENDS")
  add_executable(${name} ${arg_SOURCES})
  posemix_apply_policy(${name})
  target_include_directories(${name} PRIVATE "${PROJECT_SOURCE_DIR}/src")
  target_link_libraries(${name} PRIVATE ${arg_DEPENDS} benchmark::benchmark_main)
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/bench")
  set_property(GLOBAL APPEND PROPERTY POSEMIX_BENCHMARKS ${name})
endfunction()
