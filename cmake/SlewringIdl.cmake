# SPDX-License-Identifier: Apache-2.0
# slewring_idl_library(NAME FILE x.idl): a static library of the C types that idlc makes of an IDL file.
#
# The generated code is compiled once, in the build tree only. Cyclone's own idlc_generate makes an INTERFACE library,
# which compiles it again in every target that uses it.
find_package(CycloneDDS 0.10 REQUIRED)
find_program(IDLC_PROGRAM idlc REQUIRED)

function(slewring_idl_library name)
  cmake_parse_arguments(ARG "" "FILE" "" ${ARGN})
  get_filename_component(stem ${ARG_FILE} NAME_WE)
  set(directory ${CMAKE_CURRENT_BINARY_DIR}/${name})
  file(MAKE_DIRECTORY ${directory})
  set(generated ${directory}/${stem}.c ${directory}/${stem}.h)
  add_custom_command(
    OUTPUT ${generated}
    COMMAND ${IDLC_PROGRAM} -o${directory} ${ARG_FILE}
    DEPENDS ${ARG_FILE}
    COMMENT "Generating C types of ${stem}.idl"
    VERBATIM)
  add_library(${name} STATIC ${generated})
  target_include_directories(${name} SYSTEM PUBLIC ${directory})
  target_link_libraries(${name} PUBLIC slewring_flags CycloneDDS::ddsc)
endfunction()
