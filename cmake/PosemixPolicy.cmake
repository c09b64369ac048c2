# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
#
# Compile options for the targets of the project. Users of the installed package do not get them.
if(PROJECT_IS_TOP_LEVEL AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  find_program(POSEMIX_CCACHE ccache)
  if(POSEMIX_CCACHE)
    # ccache caches compilations with precompiled headers only with these settings.
    set(CMAKE_CXX_COMPILER_LAUNCHER "${CMAKE_COMMAND}" -E env
      CCACHE_SLOPPINESS=pch_defines,time_macros "${POSEMIX_CCACHE}")
  endif()
endif()

# The sources of a room do not wait for the libraries of the rooms that it uses.
set(CMAKE_OPTIMIZE_DEPENDENCIES ON)

set(POSEMIX_WARNINGS -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion
    -Wnon-virtual-dtor -Wold-style-cast -Wimplicit-fallthrough)
if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
  # Files that are built in are longer strings than the least that a compiler has to support.
  list(APPEND POSEMIX_WARNINGS -Wno-overlength-strings)
endif()
if(POSEMIX_WERROR)
  list(APPEND POSEMIX_WARNINGS -Werror)
endif()
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  # Flow analysis of g++ 12 gives false positives inside inlined Eigen kernels.
  list(APPEND POSEMIX_WARNINGS -Wno-maybe-uninitialized -Wno-array-bounds -Wno-stringop-overflow -Wno-stringop-overread)
elseif(POSEMIX_WERROR AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  list(APPEND POSEMIX_WARNINGS -Wno-error=maybe-uninitialized -Wno-error=array-bounds
       -Wno-error=stringop-overflow -Wno-error=stringop-overread)
endif()

# Executables are position-independent where the linker can do it.
include(CheckPIESupported)
check_pie_supported(LANGUAGES CXX)

# posemix_harden(<target>): what makes a fault of memory an end of the program and not a way into it. The checks of
# glibc's functions need an optimised build; sanitizers have their own.
function(posemix_harden target)
  target_compile_options(${target} PRIVATE -fstack-protector-strong
    "$<$<CONFIG:Release,RelWithDebInfo>:-U_FORTIFY_SOURCE;-D_FORTIFY_SOURCE=3>")
  target_link_options(${target} PRIVATE "LINKER:-z,relro,-z,now,-z,noexecstack")
endfunction()

# posemix_sanitize(<target> <sanitizers>): compiles with sanitizers, a list separated by commas, and with the assertions of
# the standard library. What Eigen leaves uninitialised is NaN.
function(posemix_sanitize target sanitizers)
  target_compile_options(${target} PRIVATE -fsanitize=${sanitizers} -fno-sanitize-recover=all -fno-omit-frame-pointer
    -U_FORTIFY_SOURCE -D_GLIBCXX_ASSERTIONS -DEIGEN_INITIALIZE_MATRICES_BY_NAN)
  if(sanitizers MATCHES "undefined")
    # Eigen takes blocks of matrices without columns.
    target_compile_options(${target} PRIVATE -fno-sanitize=pointer-overflow)
  endif()
  target_link_options(${target} PRIVATE -fsanitize=${sanitizers})
endfunction()

# posemix_apply_policy(<target>): sets warnings, hardening, sanitizers and coverage, all PRIVATE.
function(posemix_apply_policy target)
  target_compile_features(${target} PUBLIC cxx_std_20)
  set_target_properties(${target} PROPERTIES CXX_EXTENSIONS OFF POSITION_INDEPENDENT_CODE ON)
  # Contraction into fused multiply-adds would make results depend on the machine.
  target_compile_options(${target} PRIVATE ${POSEMIX_WARNINGS} -ffp-contract=off)
  if(POSEMIX_HARDEN)
    posemix_harden(${target})
  endif()
  if(POSEMIX_SANITIZE)
    posemix_sanitize(${target} "${POSEMIX_SANITIZE}")
  endif()
  if(POSEMIX_COVERAGE)
    target_compile_options(${target} PRIVATE --coverage)
    target_link_options(${target} PRIVATE --coverage)
  endif()
endfunction()

# posemix_apply_test_policy(<target>): as posemix_apply_policy, with little optimisation, because tests take longer to
# compile than to run; the code under test is optimised in full. Tests have the assertions of the standard library.
function(posemix_apply_test_policy target)
  posemix_apply_policy(${target})
  target_compile_options(${target} PRIVATE "$<$<CONFIG:Release>:-O1>" -D_GLIBCXX_ASSERTIONS)
endfunction()

# posemix_precompile(<target> FROM <owner> [HEADERS <header>...])
#
# Compiles the target with the headers that the owner, a target with the same compile options, has precompiled; the
# owner itself names them. Parsing Eigen and GoogleTest takes half of the compile time of most files.
function(posemix_precompile target)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "FROM" "HEADERS")
  if(NOT POSEMIX_PRECOMPILE)
    return()
  endif()
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_compile_options(${target} PRIVATE -fpch-preprocess)
  endif()
  if(target STREQUAL arg_FROM)
    target_precompile_headers(${target} PRIVATE ${arg_HEADERS})
  else()
    target_precompile_headers(${target} REUSE_FROM ${arg_FROM})
  endif()
endfunction()

# posemix_unite(<target> <count>): compiles so many sources at a time, because sources are small compared with the
# templates that they instantiate. A name in an unnamed namespace then occurs once per target. Clang takes all of them at a
# time, and clang-tidy with it; g++ takes longer per source, the more templates it has seen.
function(posemix_unite target count)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
    set(count 0)
  endif()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${POSEMIX_UNITY} UNITY_BUILD_BATCH_SIZE ${count})
  if(POSEMIX_UNITY AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # In a unity build g++ treats every source as an included header and warns about types with unnamed namespaces.
    target_compile_options(${target} PRIVATE -Wno-subobject-linkage)
  endif()
  if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
    # clang-tidy runs on these files too (preset tidy): here alone a .cpp file is meant to be included.
    set_target_properties(${target} PROPERTIES
      UNITY_BUILD_CODE_BEFORE_INCLUDE "// NOLINTNEXTLINE(bugprone-suspicious-include)")
  endif()
endfunction()
