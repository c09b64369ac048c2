# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
#
# cmake -DNPM=<npm> -P run_npm.cmake -- <arguments>: runs npm; its error message names the option for builds without npm.
set(arguments "")
set(is_argument OFF)
math(EXPR last "${CMAKE_ARGC} - 1")
foreach(i RANGE ${last})
  if(is_argument)
    list(APPEND arguments "${CMAKE_ARGV${i}}")
  elseif(CMAKE_ARGV${i} STREQUAL "--")
    set(is_argument ON)
  endif()
endforeach()
execute_process(COMMAND "${NPM}" ${arguments} RESULT_VARIABLE result)
if(NOT result EQUAL 0)
  list(JOIN arguments " " words)
  message(FATAL_ERROR "npm ${words} failed (${result}). It needs the npm registry; to build posemix without the page of "
    "reports: cmake -DPOSEMIX_REPORT=OFF")
endif()
