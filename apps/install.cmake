# SPDX-License-Identifier: BSD-3-Clause
# cmake --install: libraries, headers, folder of plugins, CMake package and pkg-config file. The CMake package also works
# from the build folder: cmake -Dconceg_DIR=<build folder>/cmake.
include(CMakePackageConfigHelpers)

set(conceg_libraries_to_install conceg)
if(TARGET conceg_query)
  list(APPEND conceg_libraries_to_install conceg_query)
endif()
set(package ${CMAKE_INSTALL_LIBDIR}/cmake/conceg)
install(TARGETS ${conceg_libraries_to_install} EXPORT conceg-targets LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(EXPORT conceg-targets NAMESPACE conceg:: DESTINATION ${package})
export(EXPORT conceg-targets NAMESPACE conceg:: FILE ${CMAKE_BINARY_DIR}/cmake/conceg-targets.cmake)

install(DIRECTORY ${CMAKE_SOURCE_DIR}/libconceg/include/conceg DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} FILES_MATCHING PATTERN "*.h")
# Header-only helpers for stages in C++: exceptions, views, parallel loops, the periodic box.
install(DIRECTORY ${CMAKE_SOURCE_DIR}/stages/common/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/conceg/stage FILES_MATCHING PATTERN "*.hpp"
        PATTERN tests EXCLUDE)
install(DIRECTORY DESTINATION ${CMAKE_INSTALL_LIBDIR}/conceg/plugins)

file(WRITE ${CMAKE_BINARY_DIR}/cmake/conceg-config.cmake "include(\${CMAKE_CURRENT_LIST_DIR}/conceg-targets.cmake)\n")
write_basic_package_version_file(${CMAKE_BINARY_DIR}/cmake/conceg-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/cmake/conceg-config.cmake ${CMAKE_BINARY_DIR}/cmake/conceg-config-version.cmake DESTINATION ${package})

# The pkg-config file names its own folder, so that an install can be moved.
set(pc_folder ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
string(REGEX MATCHALL "/" pc_levels "/${pc_folder}")
list(LENGTH pc_levels pc_depth)
string(REPEAT "/.." ${pc_depth} pc_up)
file(WRITE ${CMAKE_CURRENT_BINARY_DIR}/conceg.pc "prefix=\${pcfiledir}${pc_up}
libdir=\${prefix}/${CMAKE_INSTALL_LIBDIR}
includedir=\${prefix}/${CMAKE_INSTALL_INCLUDEDIR}
plugindir=\${libdir}/conceg/plugins

Name: conceg
Description: Dense grey-matter substrates: documents, recipes, stages
Version: ${PROJECT_VERSION}
Libs: -L\${libdir} -lconceg
Cflags: -I\${includedir}
")
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/conceg.pc DESTINATION ${pc_folder})
