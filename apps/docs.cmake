# SPDX-License-Identifier: BSD-3-Clause
# Man pages, the reference of the C API and shell completion, made by the build and installed. Nothing here names a word:
# the programs say what they are.
foreach(name cli cgx schema stream stage-abi swc-plus)
  file(GLOB source ${CMAKE_SOURCE_DIR}/spec/${name}.*)
  string(REPLACE "-" "_" symbol conceg_spec_${name})
  set(text ${CMAKE_CURRENT_BINARY_DIR}/${symbol}.c)
  add_custom_command(
    OUTPUT ${text}
    COMMAND ${CMAKE_COMMAND} -D INPUT=${source} -D OUTPUT=${text} -D NAME=${symbol} -P ${CMAKE_SOURCE_DIR}/libconceg/embed.cmake
    DEPENDS ${source} ${CMAKE_SOURCE_DIR}/libconceg/embed.cmake)
  target_sources(conceg-bin PRIVATE ${text})
endforeach()

set(docs ${CMAKE_BINARY_DIR}/docs)
set(stage_programs)
foreach(kind IN LISTS programs)
  list(APPEND stage_programs conceg-${kind})
endforeach()
add_custom_command(
  OUTPUT ${docs}/man1.done
  COMMAND ${CMAKE_COMMAND} -D PROGRAM=$<TARGET_FILE:conceg-bin> -D FOLDER=${docs}/man1 -P ${CMAKE_CURRENT_SOURCE_DIR}/docs/pages.cmake
  COMMAND ${CMAKE_COMMAND} -E touch ${docs}/man1.done
  DEPENDS conceg-bin ${stage_programs} docs/pages.cmake)

file(GLOB headers CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/libconceg/include/conceg/*.h)
set(reference ${CMAKE_SOURCE_DIR}/libconceg/docs/reference.awk)
add_custom_command(
  OUTPUT ${docs}/reference.done
  COMMAND ${CMAKE_COMMAND} -E rm -rf ${docs}/man3
  COMMAND ${CMAKE_COMMAND} -E make_directory ${docs}/man3
  COMMAND awk -v folder=${docs}/man3 -v html=${docs}/api.html -v symbols=${CMAKE_SOURCE_DIR}/spec/symbols.tsv -f ${reference} ${headers}
  COMMAND ${CMAKE_COMMAND} -E touch ${docs}/reference.done
  DEPENDS ${headers} ${reference} ${CMAKE_SOURCE_DIR}/spec/symbols.tsv)
add_custom_target(conceg-docs ALL DEPENDS ${docs}/man1.done ${docs}/reference.done)

install(DIRECTORY ${docs}/man1 ${docs}/man3 DESTINATION ${CMAKE_INSTALL_MANDIR})
install(FILES ${docs}/api.html DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES docs/conceg.bash RENAME conceg DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
install(FILES docs/_conceg DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/site-functions)
