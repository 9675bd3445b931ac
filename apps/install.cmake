# SPDX-License-Identifier: BSD-3-Clause
# cmake --install: libraries, headers, folder of plugins, examples, CMake package and pkg-config files. All of it finds its
# parts from where it lies, so that an install can be moved. The CMake package and the pkg-config files also work from the
# build folder: cmake -Dconceg_DIR=<build folder>/cmake, PKG_CONFIG_PATH=<build folder>/pkgconfig.
include(CMakePackageConfigHelpers)

set(package ${CMAKE_INSTALL_LIBDIR}/cmake/conceg)
# A library looks for the other one beside itself.
set_target_properties(conceg conceg_query PROPERTIES INSTALL_RPATH "$ORIGIN")
install(TARGETS conceg conceg_query EXPORT conceg-targets LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(EXPORT conceg-targets NAMESPACE conceg:: DESTINATION ${package})
export(EXPORT conceg-targets NAMESPACE conceg:: FILE ${CMAKE_BINARY_DIR}/cmake/conceg-targets.cmake)

install(DIRECTORY ${CMAKE_SOURCE_DIR}/libconceg/include/conceg DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} FILES_MATCHING PATTERN "*.h")
# Header-only helpers for stages in C++: exceptions, views, parallel loops, the periodic box.
install(DIRECTORY ${CMAKE_SOURCE_DIR}/stages/common/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/conceg/stage FILES_MATCHING PATTERN "*.hpp"
        PATTERN tests EXCLUDE PATTERN metrics.hpp EXCLUDE PATTERN statistics_table.hpp EXCLUDE
        PATTERN swc_document.hpp EXCLUDE)
install(DIRECTORY DESTINATION ${CMAKE_INSTALL_LIBDIR}/conceg/plugins)
install(DIRECTORY examples/ DESTINATION ${CMAKE_INSTALL_DATADIR}/conceg/examples)

set(config ${CMAKE_BINARY_DIR}/cmake/conceg-config.cmake)
configure_file(conceg-config.cmake.in ${config} @ONLY)
write_basic_package_version_file(${CMAKE_BINARY_DIR}/cmake/conceg-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${config} ${CMAKE_BINARY_DIR}/cmake/conceg-config-version.cmake DESTINATION ${package})

# conceg_pkg_config(<file> <prefix> <libdir> <includedirs> <plugindir>): conceg.pc and conceg-query.pc in a folder.
function(conceg_pkg_config folder prefix libdir includedir plugindir)
  file(WRITE ${folder}/conceg.pc "prefix=${prefix}
libdir=${libdir}
includedir=${includedir}
plugindir=${plugindir}

Name: conceg
Description: Dense grey-matter substrates: documents, recipes, stages
Version: ${PROJECT_VERSION}
Libs: -L\${libdir} -lconceg
Cflags: -I\${includedir}
")
  file(WRITE ${folder}/conceg-query.pc "prefix=${prefix}
libdir=${libdir}

Name: conceg-query
Description: Points and rays in the meshes of a grey-matter substrate
Version: ${PROJECT_VERSION}
Requires: conceg = ${PROJECT_VERSION}
Libs: -L\${libdir} -lconceg_query
")
endfunction()
set(pc_folder ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
string(REGEX MATCHALL "/" pc_levels "/${pc_folder}")
list(LENGTH pc_levels pc_depth)
string(REPEAT "/.." ${pc_depth} pc_up)
conceg_pkg_config(${CMAKE_CURRENT_BINARY_DIR}/pkgconfig "\${pcfiledir}${pc_up}" "\${prefix}/${CMAKE_INSTALL_LIBDIR}"
                  "\${prefix}/${CMAKE_INSTALL_INCLUDEDIR}" "\${libdir}/conceg/plugins")
conceg_pkg_config(${CMAKE_BINARY_DIR}/pkgconfig "${CMAKE_BINARY_DIR}" "\${prefix}/lib" "${CMAKE_SOURCE_DIR}/libconceg/include"
                  "\${libdir}/conceg/plugins")
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/pkgconfig/conceg.pc ${CMAKE_CURRENT_BINARY_DIR}/pkgconfig/conceg-query.pc DESTINATION ${pc_folder})
