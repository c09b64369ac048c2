# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
#
# Run by CPack on what it is about to pack. Debian has a changelog of its own form, which points to the project's here,
# manual pages are compressed, and zsh looks elsewhere for the completion of packages.
string(TIMESTAMP date "%a, %d %b %Y %H:%M:%S +0000" UTC)
file(GLOB changelogs "${CPACK_TEMPORARY_DIRECTORY}/*/usr/share/doc/*/CHANGELOG.md")
foreach(changelog IN LISTS changelogs)
  cmake_path(GET changelog PARENT_PATH folder)
  file(WRITE "${folder}/changelog" "posemix (${CPACK_POSEMIX_VERSION}) stable; urgency=medium\n\n"
    "  * The changes are in CHANGELOG.md.\n\n -- ${CPACK_PACKAGE_CONTACT}  ${date}\n")
  execute_process(COMMAND gzip -9nf "${folder}/changelog" COMMAND_ERROR_IS_FATAL ANY)
endforeach()
file(GLOB pages "${CPACK_TEMPORARY_DIRECTORY}/*/usr/share/man/man1/*.1")
foreach(page IN LISTS pages)
  execute_process(COMMAND gzip -9nf "${page}" COMMAND_ERROR_IS_FATAL ANY)
endforeach()
file(GLOB folders "${CPACK_TEMPORARY_DIRECTORY}/*/usr/share/zsh/site-functions")
foreach(folder IN LISTS folders)
  cmake_path(GET folder PARENT_PATH zsh)
  file(RENAME "${folder}" "${zsh}/vendor-completions")
endforeach()
# Nobody but the owner needs to write, whatever the umask was.
execute_process(COMMAND chmod -R u=rwX,go=rX "${CPACK_TEMPORARY_DIRECTORY}" COMMAND_ERROR_IS_FATAL ANY)
