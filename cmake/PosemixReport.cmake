# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
#
# The page of reports: npm bundles report/ into one HTML file, which is compiled into the library.
find_program(POSEMIX_NODE node DOC "Node.js, 18 or later")
find_program(POSEMIX_NPM npm DOC "npm, which comes with Node.js")
mark_as_advanced(POSEMIX_NODE POSEMIX_NPM)

# posemix_find_node(<variable>): sets the variable to whether npm and a recent enough Node.js are installed.
function(posemix_find_node variable)
  set(${variable} OFF PARENT_SCOPE)
  if(POSEMIX_NODE AND POSEMIX_NPM)
    execute_process(COMMAND "${POSEMIX_NODE}" --version OUTPUT_VARIABLE version ERROR_QUIET OUTPUT_STRIP_TRAILING_WHITESPACE)
    if(version MATCHES "^v([0-9]+)" AND CMAKE_MATCH_1 GREATER_EQUAL 18)
      set(${variable} ON PARENT_SCOPE)
    endif()
  endif()
endfunction()

posemix_find_node(POSEMIX_NODE_FOUND)
option(POSEMIX_REPORT "Bundle the page of reports with npm and put it into the library" ${POSEMIX_NODE_FOUND})
if(POSEMIX_REPORT AND NOT POSEMIX_NODE_FOUND)
  message(FATAL_ERROR "POSEMIX_REPORT needs Node.js 18 or later and npm on the PATH; without the page: -DPOSEMIX_REPORT=OFF")
endif()

# posemix_add_report_page(<variable>): sets the variable to the source with the page, or in a build without the page to
# the source with the error about that.
function(posemix_add_report_page variable)
  if(NOT POSEMIX_REPORT)
    set(${variable} report_no_page.cpp PARENT_SCOPE)
    return()
  endif()
  set(report "${PROJECT_SOURCE_DIR}/report")
  set(out "${CMAKE_CURRENT_BINARY_DIR}/report")
  set(packages "${report}/node_modules/.package-lock.json")
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS "${report}/src/*")
  set(npm "${CMAKE_COMMAND}" "-DNPM=${POSEMIX_NPM}" -P "${PROJECT_SOURCE_DIR}/cmake/run_npm.cmake" --)
  add_custom_command(OUTPUT "${packages}"
    COMMAND ${npm} ci --no-audit --no-fund --loglevel=error
    COMMAND "${CMAKE_COMMAND}" -E touch "${packages}"
    DEPENDS "${report}/package.json" "${report}/package-lock.json"
    WORKING_DIRECTORY "${report}" VERBATIM COMMENT "Packages of the report page")
  add_custom_command(OUTPUT "${out}/report.html"
    COMMAND ${npm} run --silent build -- --outdir "${out}"
    COMMAND "${CMAKE_COMMAND}" -E touch "${out}/report.html"
    DEPENDS "${packages}" "${report}/build.mjs" "${report}/tsconfig.json" ${sources}
    WORKING_DIRECTORY "${report}" VERBATIM COMMENT "Bundling the report page")
  add_custom_command(OUTPUT "${out}/report_page_data.cpp"
    COMMAND "${POSEMIX_NODE}" "${PROJECT_SOURCE_DIR}/cmake/embed_page.mjs" "${out}/report.html" "${out}/report_page_data.cpp"
    DEPENDS "${out}/report.html" "${PROJECT_SOURCE_DIR}/cmake/embed_page.mjs"
    VERBATIM COMMENT "Embedding the report page")
  add_custom_target(posemix_report_page DEPENDS "${out}/report_page_data.cpp")
  set_source_files_properties("${out}/report_page_data.cpp" PROPERTIES
    SKIP_PRECOMPILE_HEADERS ON SKIP_UNITY_BUILD_INCLUSION ON)
  set(${variable} "${out}/report_page_data.cpp" PARENT_SCOPE)
endfunction()

# posemix_use_report_page(<target>): include directory and dependency of the library that compiles this source.
function(posemix_use_report_page target)
  target_include_directories(${target} PRIVATE "${CMAKE_CURRENT_SOURCE_DIR}")
  if(TARGET posemix_report_page)
    add_dependencies(${target} posemix_report_page)
  endif()
endfunction()
