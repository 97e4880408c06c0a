# SPDX-License-Identifier: Apache-2.0
# Writes the pkg-config file; its prefix follows the file's own folder. Set: source, destination, libdir, includedir,
# version.
set(file ${CMAKE_INSTALL_PREFIX}/${destination}/slewring-client.pc)
file(RELATIVE_PATH prefix /prefix/${destination} /prefix)
configure_file(${source} $ENV{DESTDIR}${file} @ONLY)
list(APPEND CMAKE_INSTALL_MANIFEST_FILES ${file})
message(STATUS "Installing: $ENV{DESTDIR}${file}")
