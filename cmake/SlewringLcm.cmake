# SPDX-License-Identifier: Apache-2.0
# LCM is optional: without it `slewring bridge lcm`, `export --lcm` and `--input FILE.lcm` are errors that name the
# packages. SLEWRING_HAS_LCM; slewring_lcm_types: the C++ types that lcm-gen makes of idl/slewring.lcm.
option(SLEWRING_LCM "Use LCM where it is installed" ON)

find_path(LCM_INCLUDE_DIR lcm/lcm.h)
find_library(LCM_LIBRARY lcm)
find_program(LCM_GEN lcm-gen)
set(SLEWRING_HAS_LCM OFF)
if(SLEWRING_LCM AND LCM_INCLUDE_DIR AND LCM_LIBRARY AND LCM_GEN)
  set(SLEWRING_HAS_LCM ON)
endif()
message(STATUS "LCM: ${SLEWRING_HAS_LCM}")

if(SLEWRING_HAS_LCM)
  set(types ${PROJECT_SOURCE_DIR}/idl/slewring.lcm)
  set(generated ${PROJECT_BINARY_DIR}/generated/lcm)
  file(STRINGS ${types} structs REGEX "^struct ")
  set(headers)
  foreach(struct ${structs})
    string(REGEX REPLACE "^struct ([a-z_]+) .*" "\\1" name ${struct})
    list(APPEND headers ${generated}/slewring/${name}.hpp)
  endforeach()
  add_custom_command(
    OUTPUT ${headers}
    COMMAND ${LCM_GEN} --cpp --cpp-std c++11 --cpp-hpath ${generated} ${types}
    DEPENDS ${types}
    COMMENT "Generating C++ types of slewring.lcm"
    VERBATIM)
  add_custom_target(slewring_lcm_headers DEPENDS ${headers})
  add_library(slewring_lcm_types INTERFACE)
  add_dependencies(slewring_lcm_types slewring_lcm_headers)
  target_include_directories(slewring_lcm_types SYSTEM INTERFACE ${generated} ${LCM_INCLUDE_DIR})
endif()
