# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
#
# NLopt::nlopt after find_package(NLopt). Debian has the library a second time, as nlopt_cxx with more algorithms, and
# CMake 4 finds that one first.
if(TARGET NLopt::nlopt_cxx AND NOT TARGET NLopt::nlopt)
  add_library(NLopt::nlopt INTERFACE IMPORTED)
  set_target_properties(NLopt::nlopt PROPERTIES INTERFACE_LINK_LIBRARIES NLopt::nlopt_cxx)
endif()
