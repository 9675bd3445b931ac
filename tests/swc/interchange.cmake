# SPDX-License-Identifier: BSD-3-Clause
# Documents as folders of SWC-plus files.
if(TARGET conceg-import AND TARGET conceg-export AND TARGET conceg-relax)
  add_test(NAME swc.interchange COMMAND sh ${CMAKE_CURRENT_SOURCE_DIR}/interchange.sh ${CMAKE_BINARY_DIR}/bin ${CMAKE_SOURCE_DIR})
  set_tests_properties(swc.interchange PROPERTIES LABELS swc SKIP_RETURN_CODE 77 TIMEOUT 300)
  set_property(TEST swc.interchange APPEND PROPERTY ENVIRONMENT "CONCEG_SHARED=${CONCEG_SHARED}")
endif()
