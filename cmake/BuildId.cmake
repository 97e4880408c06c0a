# SPDX-License-Identifier: Apache-2.0
# Writes the header with the build id. Run with -P at every build, so that the revision is that of the sources that are
# built; the header is touched only when the id changes.
execute_process(COMMAND git -C ${SOURCE_DIR} describe --always --dirty --abbrev=12
                OUTPUT_VARIABLE revision OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
if(NOT revision)
  set(revision "unversioned")
endif()
set(SLEWRING_BUILD_ID "${VERSION}-${revision} ${COMPILER} ${INSTRUCTION_SET}")
configure_file(${TEMPLATE} ${HEADER} @ONLY)
