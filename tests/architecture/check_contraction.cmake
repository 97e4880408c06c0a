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
  execute_process(COMMAND ${OBJDUMP} --disassemble --no-show-raw-insn ${library}
                  OUTPUT_VARIABLE code RESULT_VARIABLE result)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "${OBJDUMP} could not read ${library}")
  endif()
  if(code MATCHES "vfm(addsub|subadd)")
    string(REGEX MATCH "\n[0-9a-f]+ <([^>]*)>:\n[^<]*vfm(addsub|subadd)" found "${code}")
    message(FATAL_ERROR "${library} contracts products and sums in ${CMAKE_MATCH_1}.\n"
                        "Give its source -fno-tree-slp-vectorize, as libs/math/CMakeLists.txt does.")
  endif()
endforeach()
