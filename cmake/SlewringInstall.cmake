# SPDX-License-Identifier: Apache-2.0
# What an installation holds, in three components that are the Debian packages too (SlewringPackages.cmake):
#
#   program   bin/slewring, its nodes and private libraries in lib/slewring, scenes, page, manual pages, completion,
#             the unit
#   client    the client library with headers, CMake package, pkg-config file and Python module, the message types
#   doc       documents and examples
#
# The prefix may be moved: programs find each other and the scenes from where they lie (core/installation.h).
include(GNUInstallDirs)

set(private lib/slewring)  # of Slewring alone: no part of the library path, and not named after the processor
set(shared ${CMAKE_INSTALL_DATADIR})
# every folder X_node has a program of its name
file(GLOB nodes LIST_DIRECTORIES true CONFIGURE_DEPENDS RELATIVE ${PROJECT_SOURCE_DIR} *_node)

# ---- program
install(TARGETS slewring RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program)
install(TARGETS ${nodes} RUNTIME DESTINATION ${private} COMPONENT program)
install(TARGETS slewring_fcl LIBRARY DESTINATION ${private} COMPONENT program)
if(TARGET slewring_fastdds)
  install(TARGETS slewring_fastdds LIBRARY DESTINATION ${private} COMPONENT program)
endif()
set_target_properties(slewring PROPERTIES INSTALL_RPATH "$ORIGIN/../${private}")
set_target_properties(${nodes} PROPERTIES INSTALL_RPATH "$ORIGIN")

install(DIRECTORY scenes DESTINATION ${shared}/slewring COMPONENT program)
# without it the window has a built-in page
install(DIRECTORY ${PROJECT_BINARY_DIR}/web DESTINATION ${shared}/slewring COMPONENT program OPTIONAL)
install(FILES cli/completion/slewring.bash RENAME slewring DESTINATION ${shared}/bash-completion/completions
        COMPONENT program)
install(FILES cli/completion/_slewring DESTINATION ${shared}/zsh/vendor-completions COMPONENT program)
install(FILES cli/completion/slewring.fish DESTINATION ${shared}/fish/vendor_completions.d COMPONENT program)

# manual pages, by the programs themselves
set(manual ${PROJECT_BINARY_DIR}/man)
file(MAKE_DIRECTORY ${manual})
set(write_manual "")
foreach(program slewring ${nodes})
  list(APPEND write_manual COMMAND ${program} --write-manual ${manual})
endforeach()
add_custom_command(OUTPUT ${manual}/slewring.1 ${write_manual} DEPENDS slewring ${nodes}
                   COMMENT "Writing the manual pages" VERBATIM)
add_custom_target(slewring_manual ALL DEPENDS ${manual}/slewring.1)
install(DIRECTORY ${manual}/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT program FILES_MATCHING PATTERN "*.1")

# the unit names the program by its whole path, which is known when it is installed
install(CODE "set(source \"${PROJECT_SOURCE_DIR}/cmake/packaging/slewring@.service.in\")
set(bindir \"${CMAKE_INSTALL_BINDIR}\")" COMPONENT program)
install(SCRIPT cmake/packaging/install_unit.cmake COMPONENT program)

# ---- client; the library itself in libs/client
install(CODE "set(source \"${PROJECT_SOURCE_DIR}/cmake/packaging/slewring-client.pc.in\")
set(destination \"${CMAKE_INSTALL_LIBDIR}/pkgconfig\")
set(libdir \"${CMAKE_INSTALL_LIBDIR}\")
set(includedir \"${CMAKE_INSTALL_INCLUDEDIR}\")
set(version \"${PROJECT_VERSION}\")" COMPONENT client)
install(SCRIPT cmake/packaging/install_pkgconfig.cmake COMPONENT client)
install(FILES examples/python/slewring_client.py DESTINATION lib/python3/dist-packages COMPONENT client)

# ---- doc
set(documents ${CMAKE_INSTALL_DATADIR}/doc/slewring)
install(FILES README.md CHANGELOG.md CONTRIBUTING.md LICENSE DESTINATION ${documents} COMPONENT doc)
install(DIRECTORY docs examples DESTINATION ${documents} COMPONENT doc)
install(FILES idl/README.md DESTINATION ${documents}/idl COMPONENT doc)

# ---- uninstall
add_custom_target(uninstall COMMAND ${CMAKE_COMMAND} -DBUILD=${PROJECT_BINARY_DIR}
                                    -P ${PROJECT_SOURCE_DIR}/cmake/Uninstall.cmake VERBATIM)
