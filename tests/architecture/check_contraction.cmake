# SPDX-License-Identifier: Apache-2.0
# No library of ours holds a multiply-add that the compiler made of alternating sums: g++ 12 does so also where contraction
# is off, and bits of Debug and Release would differ. BUILD: the build folder; OBJDUMP: the program, or ...-NOTFOUND.
if(NOT OBJDUMP)
  message("SKIPPED: there is no objdump")
  return()
endif()
file(GLOB libraries ${BUILD}/libs/*/*.a)
list(LENGTH libraries count)
if(count LESS 5)
  message(FATAL_ERROR "only ${count} libraries were found in ${BUILD}/libs")
endif()
foreach(library ${libraries})
  # a pipe: the text of the larger libraries is some hundred MB
  execute_process(COMMAND ${OBJDUMP} --disassemble --no-show-raw-insn ${library}
                  COMMAND awk "/^[0-9a-f]+ </ { place = $2 } !found && /vfm(addsub|subadd)/ { found = 1; print place }"
                  OUTPUT_VARIABLE found RESULTS_VARIABLE results OUTPUT_STRIP_TRAILING_WHITESPACE)
  if(NOT results STREQUAL "0;0")
    message(FATAL_ERROR "${OBJDUMP} could not read ${library}")
  endif()
  if(found)
    string(REGEX REPLACE "^<(.*)>:$" "\\1" place "${found}")
    message(FATAL_ERROR "${library} contracts products and sums in ${place}.\n"
                        "Give its source -fno-tree-slp-vectorize, as libs/math/CMakeLists.txt does.")
  endif()
endforeach()
