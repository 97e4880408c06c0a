# SPDX-License-Identifier: Apache-2.0
# Writes the systemd unit with the path of the program. Set: source, bindir.
set(PROGRAM_PATH ${CMAKE_INSTALL_PREFIX}/${bindir}/slewring)
set(unit ${CMAKE_INSTALL_PREFIX}/lib/systemd/system/slewring@.service)
configure_file(${source} $ENV{DESTDIR}${unit} @ONLY)
list(APPEND CMAKE_INSTALL_MANIFEST_FILES ${unit})
message(STATUS "Installing: $ENV{DESTDIR}${unit}")
