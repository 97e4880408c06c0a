# SPDX-License-Identifier: Apache-2.0
# cmake -DWRITER=program -DSOURCE=folder -DWORK=folder -P verify_known.cmake
#
# Writes a recording of every topic and lets verify.mjs read it with @mcap/core and @foxglove/omgidl-*. The packages go
# into WORK, never into the source tree. Prints "SKIPPED: reason" where Node.js or the package registry is missing.
find_program(NODE node)
find_program(NPM npm)
if(NOT NODE OR NOT NPM)
  message("SKIPPED: node and npm are needed to read a recording with @mcap/core")
  return()
endif()

file(MAKE_DIRECTORY ${WORK})
execute_process(COMMAND ${WRITER} ${WORK} COMMAND_ERROR_IS_FATAL ANY)

# packages only when the lock file is not the one that is installed
file(SHA256 ${SOURCE}/package-lock.json wanted)
set(installed "")
if(EXISTS ${WORK}/installed.sha256)
  file(READ ${WORK}/installed.sha256 installed)
endif()
file(COPY ${SOURCE}/package.json ${SOURCE}/package-lock.json ${SOURCE}/verify.mjs DESTINATION ${WORK})
if(NOT installed STREQUAL wanted)
  execute_process(COMMAND ${NPM} ci --no-audit --no-fund --ignore-scripts --fetch-retries=1
                  WORKING_DIRECTORY ${WORK} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    if(output MATCHES "ENOTFOUND|EAI_AGAIN|ECONNREFUSED|ECONNRESET|ETIMEDOUT|ENETUNREACH|EHOSTUNREACH|ERR_SOCKET|E[45][0-9][0-9]")
      message("SKIPPED: the npm registry does not deliver the packages:\n${output}")
      return()
    endif()
    message(FATAL_ERROR "npm ci failed:\n${output}")
  endif()
  file(WRITE ${WORK}/installed.sha256 ${wanted})
endif()

execute_process(COMMAND ${NODE} verify.mjs known.mcap known.json WORKING_DIRECTORY ${WORK} COMMAND_ERROR_IS_FATAL ANY)

# the comparison itself must be able to fail
file(READ ${WORK}/known.json expected)
string(REPLACE "Cyl_Lift.force" "Cyl_Lift.farce" wrong "${expected}")
file(WRITE ${WORK}/wrong.json "${wrong}")
execute_process(COMMAND ${NODE} verify.mjs known.mcap wrong.json WORKING_DIRECTORY ${WORK} RESULT_VARIABLE result
                OUTPUT_QUIET ERROR_VARIABLE output)
if(result EQUAL 0 OR NOT output MATCHES "entries\\[0\\].name: Cyl_Lift.force in the file, expected Cyl_Lift.farce")
  message(FATAL_ERROR "a wrong expectation was not found: ${output}")
endif()
message("every value is read by @mcap/core as it was written")
