# SPDX-License-Identifier: Apache-2.0
# Installs the packages of the page and bundles it:  cmake -DSOURCES=web -DPACKAGES=FOLDER -DPAGE=FOLDER -P build.cmake
#
# A missing program or registry is a message, not an error; an error in the page's sources is one.
set(most_seconds 120)  # for the packages; a registry that does not answer must not hold the build

find_program(NODE_PROGRAM node)
find_program(NPM_PROGRAM npm)
set(without "`slewring window` serves its built-in table instead of the page")
if(NOT NODE_PROGRAM OR NOT NPM_PROGRAM)
  message("The page was not built: ${without}. Install nodejs (18 or newer) and npm, then build again.")
  return()
endif()
execute_process(COMMAND ${NODE_PROGRAM} -p "process.versions.node.split('.')[0]" OUTPUT_VARIABLE version
                OUTPUT_STRIP_TRAILING_WHITESPACE)
if(version LESS 18)
  message("The page was not built: ${without}. Node is of version ${version}; install nodejs 18 or newer.")
  return()
endif()

# the packages stand beside a copy of the sources, so that the source tree stays as it is
file(COPY ${SOURCES}/build.mjs ${SOURCES}/index.html ${SOURCES}/package.json DESTINATION ${PACKAGES})
file(REMOVE_RECURSE ${PACKAGES}/src)
file(COPY ${SOURCES}/src DESTINATION ${PACKAGES})
file(SHA256 ${SOURCES}/package-lock.json wanted)
set(installed "")
if(EXISTS ${PACKAGES}/installed.sha256)
  file(READ ${PACKAGES}/installed.sha256 installed)
endif()
if(NOT installed STREQUAL wanted)
  file(COPY ${SOURCES}/package-lock.json DESTINATION ${PACKAGES})
  execute_process(
    COMMAND ${NPM_PROGRAM} ci --omit=dev --no-audit --no-fund --ignore-scripts --fetch-retries=1
    WORKING_DIRECTORY ${PACKAGES} TIMEOUT ${most_seconds} RESULT_VARIABLE result OUTPUT_VARIABLE output
    ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    string(REGEX MATCH "npm (error|ERR!)[^\n]*" reason "${output}")
    message("The page was not built: ${without}. npm has not installed its packages (${reason}); build again when its "
            "registry can be reached.")
    return()
  endif()
  file(WRITE ${PACKAGES}/installed.sha256 ${wanted})
endif()
execute_process(COMMAND ${NODE_PROGRAM} build.mjs ${PAGE} WORKING_DIRECTORY ${PACKAGES} COMMAND_ERROR_IS_FATAL ANY)
