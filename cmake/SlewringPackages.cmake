# SPDX-License-Identifier: Apache-2.0
# `cpack -G DEB` in the build folder: a Debian package of each component of SlewringInstall.cmake.
#
#   slewring                  programs, scenes, manual pages, completion, systemd unit
#   libslewring-client-dev    for controllers: library, headers, CMake package, pkg-config, Python module, message types
#   slewring-doc              documents and examples
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME slewring)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_CONTACT "The developers of Slewring <slewring@localhost>")
set(CPACK_PACKAGE_DIRECTORY ${PROJECT_BINARY_DIR}/packages)
# with DESTDIR the unit gets the path that the program has later
set(CPACK_SET_DESTDIR ON)
set(CPACK_INSTALL_PREFIX /usr)
set(CPACK_PRE_BUILD_SCRIPTS ${PROJECT_SOURCE_DIR}/cmake/packaging/forget_staged.cmake)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ
                                                WORLD_EXECUTE)
set(CPACK_COMPONENTS_ALL program client doc)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)

set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME slewring)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SUGGESTS "slewring-doc, libslewring-client-dev")
set(CPACK_COMPONENT_PROGRAM_DESCRIPTION "real-time co-simulation of hydraulically driven working machines
Mechanics, hydraulics, operator input and recording of a machine run as separate
processes, on one computer or several, and exchange forces, pressures and control
signals over DDS once per millisecond. A truck crane comes with it.
.
The programs are built for processors of the level ${SLEWRING_MARCH}.")

set(CPACK_DEBIAN_CLIENT_PACKAGE_NAME libslewring-client-dev)
set(CPACK_DEBIAN_CLIENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_CLIENT_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_CLIENT_PACKAGE_SUGGESTS "python3, pkg-config")
set(CPACK_COMPONENT_CLIENT_DESCRIPTION "controllers for Slewring sessions: library for C, C++ and Python
A controller reads variables of a running session and moves the machine's inputs.
Shared library, headers, CMake package, pkg-config file, Python module, and the
types of the messages for DDS and LCM.")

set(CPACK_DEBIAN_DOC_PACKAGE_NAME slewring-doc)
set(CPACK_DEBIAN_DOC_PACKAGE_SECTION doc)
set(CPACK_DEBIAN_DOC_PACKAGE_ARCHITECTURE all)
set(CPACK_COMPONENT_DOC_DESCRIPTION "documentation of Slewring
Tutorials, how-to guides, the formats of scenes and recordings, equations and
validity of every model, and examples of controllers.")

# what Debian expects of every package: its licence and its changes
foreach(component program client doc)
  string(TOUPPER ${component} upper)
  set(folder ${CMAKE_INSTALL_DATADIR}/doc/${CPACK_DEBIAN_${upper}_PACKAGE_NAME})
  install(FILES cmake/packaging/copyright DESTINATION ${folder} COMPONENT ${component})
  install(FILES ${PROJECT_BINARY_DIR}/changelog.gz DESTINATION ${folder} COMPONENT ${component})
endforeach()
find_program(GZIP_PROGRAM gzip REQUIRED)
execute_process(COMMAND ${GZIP_PROGRAM} -9nc ${PROJECT_SOURCE_DIR}/CHANGELOG.md
                OUTPUT_FILE ${PROJECT_BINARY_DIR}/changelog.gz COMMAND_ERROR_IS_FATAL ANY)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS CHANGELOG.md)

include(CPack)
