# SPDX-License-Identifier: BSD-3-Clause
# The reader's table, and conceg swc check and repair over it, over damaged files, over real cells and before other readers.
add_executable(test_swc_reader_table reader_table.c)
set_target_properties(test_swc_reader_table PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
target_include_directories(test_swc_reader_table PRIVATE ${CMAKE_SOURCE_DIR}/tests)
target_link_libraries(test_swc_reader_table PRIVATE conceg)
set(table ${CMAKE_CURRENT_SOURCE_DIR}/reader_table.tsv ${CMAKE_CURRENT_SOURCE_DIR}/fixtures)
add_test(NAME swc.reader_table COMMAND test_swc_reader_table ${table})
conceg_test(swc_hostile LABEL swc SOURCES hostile.c LIBRARIES conceg)
conceg_test(swc_no_memory LABEL swc SOURCES no_memory.c LIBRARIES conceg)
foreach(name check repair shared peers)
  add_test(NAME swc.${name} COMMAND sh ${CMAKE_CURRENT_SOURCE_DIR}/check_${name}.sh $<TARGET_FILE_DIR:conceg-bin>
                                    $<TARGET_FILE:test_swc_reader_table> ${table})
  if(EXISTS ${CONCEG_SHARED})
    set_tests_properties(swc.${name} PROPERTIES ENVIRONMENT "CONCEG_SHARED=${CONCEG_SHARED}")
  endif()
endforeach()
set_tests_properties(swc.reader_table swc.check swc.repair swc.shared swc.peers PROPERTIES LABELS swc SKIP_RETURN_CODE 77 TIMEOUT 120)
