# SPDX-License-Identifier: BSD-3-Clause
# cmake -D PROGRAM=conceg -D FOLDER=man1 -P pages.cmake: one man page per word, sub-words too, as the programs print them.
function(conceg_pages page)
  execute_process(COMMAND ${PROGRAM} ${ARGN} --help=man OUTPUT_FILE ${FOLDER}/${page}.1 COMMAND_ERROR_IS_FATAL ANY)
  execute_process(COMMAND ${PROGRAM} ${ARGN} --help=list OUTPUT_VARIABLE list COMMAND_ERROR_IS_FATAL ANY)
  string(REGEX MATCHALL "(^|\n)word\t[^\t]+" words "${list}")
  foreach(word IN LISTS words)
    string(REGEX REPLACE "^\n?word\t" "" word "${word}")
    if(NOT word MATCHES "^(help|version)$")
      conceg_pages(${page}-${word} ${ARGN} ${word})
    endif()
  endforeach()
endfunction()
# A stage comes from the build, whatever PATH may hold.
get_filename_component(programs ${PROGRAM} DIRECTORY)
set(ENV{PATH} "${programs}:$ENV{PATH}")
file(REMOVE_RECURSE ${FOLDER})
file(MAKE_DIRECTORY ${FOLDER})
conceg_pages(conceg)
