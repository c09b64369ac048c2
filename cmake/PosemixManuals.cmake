# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
#
# Manual pages and completion for shells, which the program itself writes.
set(manuals "${PROJECT_BINARY_DIR}/manuals")
set(data "${CMAKE_INSTALL_DATAROOTDIR}")
add_custom_command(OUTPUT "${manuals}/done"
  COMMAND "${CMAKE_COMMAND}" -E rm -rf "${manuals}"
  COMMAND posemix manual --out "${manuals}/man1"
  COMMAND posemix completion bash > "${manuals}/posemix"
  COMMAND posemix completion zsh > "${manuals}/_posemix"
  COMMAND posemix completion fish > "${manuals}/posemix.fish"
  COMMAND "${CMAKE_COMMAND}" -E touch "${manuals}/done"
  DEPENDS posemix VERBATIM COMMENT "Manual pages and completion")
add_custom_target(posemix_manuals ALL DEPENDS "${manuals}/done")

install(DIRECTORY "${manuals}/man1" DESTINATION "${CMAKE_INSTALL_MANDIR}" COMPONENT program)
install(FILES "${manuals}/posemix" DESTINATION "${data}/bash-completion/completions" COMPONENT program)
install(FILES "${manuals}/_posemix" DESTINATION "${data}/zsh/site-functions" COMPONENT program)
install(FILES "${manuals}/posemix.fish" DESTINATION "${data}/fish/vendor_completions.d" COMPONENT program)
