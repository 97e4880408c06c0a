# SPDX-License-Identifier: Apache-2.0
# Compiler settings of every target and the two helpers that declare a library and a test program.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)

if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Build type" FORCE)
endif()

set(SLEWRING_MARCH "x86-64-v3" CACHE STRING "Instruction set of all code of ours (-march)")
set(SLEWRING_SANITIZE "" CACHE STRING "Value of -fsanitize=, empty for none")

# what one clone has compiled, another one on the same machine need not compile again
find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_CURRENT_LIST_DIR}/cached ${CCACHE_PROGRAM})
  set(CMAKE_C_COMPILER_LAUNCHER ${CMAKE_CXX_COMPILER_LAUNCHER})
endif()

# Tests are compiled without optimisation, which clang does in half of g++'s time, with the same standard library and the
# same calls: where it is there, it compiles the tests of a Release build.
find_program(SLEWRING_COMPILER_OF_TESTS clang++-14)
set(test_launcher "")
if(SLEWRING_COMPILER_OF_TESTS AND CMAKE_BUILD_TYPE STREQUAL Release AND CMAKE_CXX_COMPILER_ID STREQUAL GNU)
  set(test_launcher ${CMAKE_CURRENT_LIST_DIR}/compile_with ${SLEWRING_COMPILER_OF_TESTS} ${CMAKE_CXX_COMPILER}
                    ${CMAKE_CXX_COMPILER_LAUNCHER})
endif()
function(slewring_compile_as_test target)
  target_compile_options(${target} PRIVATE ${SLEWRING_QUICKEST_TO_COMPILE})
  if(test_launcher)
    set_target_properties(${target} PROPERTIES CXX_COMPILER_LAUNCHER "${test_launcher}")
  endif()
endfunction()

# position-independent programs, not only libraries
include(CheckPIESupported)
check_pie_supported(LANGUAGES C CXX)

# the same bits in every build: no contraction to fused multiply-add, no value-changing optimisation
add_library(slewring_flags INTERFACE)
target_compile_options(slewring_flags INTERFACE -march=${SLEWRING_MARCH} -ffp-contract=off)
target_compile_options(slewring_flags INTERFACE
  $<$<COMPILE_LANGUAGE:CXX>:-Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Woverloaded-virtual -Wdouble-promotion -Werror>
  # g++ 12 reports overlaps inside std::string's operator+ that do not exist (GCC bug 105651)
  $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>
  # clang takes the C macro INFINITY for a float; ccache takes precompiled headers of clang without their time alone
  $<$<CXX_COMPILER_ID:Clang>:-Wno-double-promotion> $<$<COMPILE_LANG_AND_ID:CXX,Clang>:SHELL:-Xclang -fno-pch-timestamp>)
# of the same kind, and shown for standard headers only where they are precompiled
target_compile_options(slewring_flags INTERFACE
  $<$<COMPILE_LANG_AND_ID:CXX,GNU>:-Wno-array-bounds -Wno-stringop-overflow -Wno-stringop-overread>)
target_include_directories(slewring_flags INTERFACE ${PROJECT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/libs)
# as fmt::fmt does: with the same definitions everywhere all targets can share the precompiled headers
target_compile_definitions(slewring_flags INTERFACE FMT_SHARED)
# fmt sets some optimisation of its own where there is none; after it in a precompiled header g++ 12 takes everything
# for optimised, and its vector instructions do not compile
target_compile_options(slewring_flags INTERFACE "-DFMT_GCC_PRAGMA(text)=")
# what a damaged stack, a wrong length or an overwritten table of functions must not become; docs/security.md. The
# sanitizers bring checks of their own. In libraries with the property SLEWRING_COMPUTES guarded stacks would cost 1.5
# to 3 % of the forward dynamics' instructions; they read no bytes of others.
if(NOT SLEWRING_SANITIZE)
  target_compile_options(slewring_flags INTERFACE
    $<$<NOT:$<BOOL:$<TARGET_PROPERTY:SLEWRING_COMPUTES>>>:-fstack-protector-strong> -fstack-clash-protection)
  target_compile_definitions(slewring_flags INTERFACE $<$<NOT:$<CONFIG:Debug>>:_FORTIFY_SOURCE=2>)
  target_link_options(slewring_flags INTERFACE -Wl,-z,relro -Wl,-z,now -Wl,-z,noexecstack)
endif()
if(SLEWRING_SANITIZE)
  target_compile_options(slewring_flags INTERFACE -fsanitize=${SLEWRING_SANITIZE} -fno-sanitize-recover=all
    -fno-omit-frame-pointer)
  target_compile_definitions(slewring_flags INTERFACE SLEWRING_SANITIZED)
  # their checks double what the optimiser has to do: only fuzzers, and what computes, are worth the wait
  if(NOT SLEWRING_BUILD_FUZZERS)
    target_compile_options(slewring_flags INTERFACE $<$<NOT:$<BOOL:$<TARGET_PROPERTY:SLEWRING_COMPUTES>>>:-O1;-g1>)
  endif()
  target_link_options(slewring_flags INTERFACE -fsanitize=${SLEWRING_SANITIZE})
endif()

# What is compiled more often than its loops turn: a third less to wait for a build, the same bits.
set(SLEWRING_QUICK_TO_COMPILE $<$<CONFIG:Release>:-O1>)
set(SLEWRING_QUICKEST_TO_COMPILE $<$<CONFIG:Release>:-O0>)

# Standard headers, parsed once for each set of compiler options: a third to a half of the time of most units. Every
# source still includes what it uses. KIND: usual, computes or texts (see slewring_library), or tests.
set(SLEWRING_STANDARD_HEADERS
    <algorithm> <array> <cmath> <cstdint> <cstdio> <filesystem> <functional> <limits> <map> <memory> <numbers> <numeric>
    <optional> <set> <span> <sstream> <stdexcept> <string> <string_view> <utility> <vector>
    ${PROJECT_SOURCE_DIR}/libs/core/fmt_once.h)
function(slewring_precompile target kind)
  set(owner slewring_precompiled_${kind})
  if(NOT TARGET ${owner})
    file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/generated/${owner}.cpp CONTENT "int main() {}\n")
    if(kind STREQUAL tests)
      add_executable(${owner} EXCLUDE_FROM_ALL ${PROJECT_BINARY_DIR}/generated/${owner}.cpp)
      target_link_libraries(${owner} PRIVATE GTest::gtest)
      target_precompile_headers(${owner} PRIVATE <gtest/gtest.h>)
    else()
      add_library(${owner} OBJECT EXCLUDE_FROM_ALL ${PROJECT_BINARY_DIR}/generated/${owner}.cpp)
    endif()
    target_link_libraries(${owner} PRIVATE slewring_flags)
    if(kind STREQUAL texts)
      target_compile_options(${owner} PRIVATE ${SLEWRING_QUICK_TO_COMPILE})
    elseif(kind STREQUAL tests)
      slewring_compile_as_test(${owner})
    endif()
    if(kind STREQUAL computes)
      set_target_properties(${owner} PROPERTIES SLEWRING_COMPUTES ON)
    endif()
    target_precompile_headers(${owner} PRIVATE ${SLEWRING_STANDARD_HEADERS})
  endif()
  target_precompile_headers(${target} REUSE_FROM ${owner})
endfunction()

# Sources that are compiled otherwise than their target; g++ crashes on a precompiled header of other options.
function(slewring_compile_apart options)
  set_source_files_properties(${ARGN} PROPERTIES COMPILE_OPTIONS "${options}" SKIP_PRECOMPILE_HEADERS ON
                                                 SKIP_UNITY_BUILD_INCLUSION ON)
endfunction()

# Headers and instances of templates are compiled once for twelve files. The sources of a library therefore name no two
# things of their unnamed namespaces alike, and each test file has a namespace of its own; the nightly tests compile every
# file alone (tests/architecture/each_alone.py). Sources that are long to compile stay alone with slewring_compile_alone.
function(slewring_compile_together target)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 12)
endfunction()
function(slewring_compile_alone)
  set_source_files_properties(${ARGN} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
endfunction()

# slewring_library(NAME [COMPUTES | TEXTS | TESTS] SOURCES ... DEPENDS lib ... LINK target ... PRECOMPILE <header> ...)
# DEPENDS names libraries of ours; tests/architecture/edges.txt must allow each of them. COMPUTES: with numbers alone, in
# every step. TEXTS: options, reports and what is done once. TESTS: what test programs share. PRECOMPILE: heavy headers
# of most of its units, beside the standard ones.
function(slewring_library name)
  cmake_parse_arguments(ARG "COMPUTES;TEXTS;TESTS" "" "SOURCES;DEPENDS;LINK;PRECOMPILE" ${ARGN})
  add_library(slewring_${name} STATIC ${ARG_SOURCES})
  slewring_compile_together(slewring_${name})
  if(ARG_TEXTS)
    target_compile_options(slewring_${name} PRIVATE ${SLEWRING_QUICK_TO_COMPILE})
  elseif(ARG_TESTS)
    # as the test programs, whose precompiled headers it takes
    set_target_properties(slewring_${name} PROPERTIES POSITION_INDEPENDENT_CODE OFF)
    target_compile_options(slewring_${name} PRIVATE -fPIE)
    slewring_compile_as_test(slewring_${name})
  endif()
  if(ARG_PRECOMPILE)
    target_precompile_headers(slewring_${name} PRIVATE ${SLEWRING_STANDARD_HEADERS} ${ARG_PRECOMPILE})
  elseif(ARG_TEXTS)
    slewring_precompile(slewring_${name} texts)
  elseif(ARG_TESTS)
    target_link_libraries(slewring_${name} PUBLIC GTest::gtest)
    slewring_precompile(slewring_${name} tests)
  elseif(ARG_COMPUTES)
    slewring_precompile(slewring_${name} computes)
  else()
    slewring_precompile(slewring_${name} usual)
  endif()
  set_target_properties(slewring_${name} PROPERTIES SLEWRING_COMPUTES ${ARG_COMPUTES})
  target_link_libraries(slewring_${name} PUBLIC slewring_flags)
  foreach(dependency ${ARG_DEPENDS})
    target_link_libraries(slewring_${name} PUBLIC slewring_${dependency})
  endforeach()
  target_link_libraries(slewring_${name} PUBLIC ${ARG_LINK})
endfunction()

# A shared library that shows nothing of what it links statically, and has all that it needs; under the sanitizers
# their functions are in the program.
function(slewring_closed_library target)
  set_target_properties(${target} PROPERTIES CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
  target_link_options(${target} PRIVATE LINKER:--exclude-libs,ALL LINKER:--as-needed)
  if(NOT SLEWRING_SANITIZE)
    target_link_options(${target} PRIVATE LINKER:--no-undefined)
  endif()
endfunction()

# slewring_program(NAME SOURCES ... DEPENDS lib ... LINK target ...)
function(slewring_program name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPENDS;LINK" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE slewring_flags)
  foreach(dependency ${ARG_DEPENDS})
    target_link_libraries(${name} PRIVATE slewring_${dependency})
  endforeach()
  target_link_libraries(${name} PRIVATE ${ARG_LINK})
endfunction()

# slewring_test(NAME LABEL unit SOURCES ... DEPENDS lib ... LINK target ... TIMEOUT s LOCK resource)
# One GoogleTest program; every case in it becomes one ctest entry with the label. LOCK: what one of them at a time uses.
function(slewring_test name)
  cmake_parse_arguments(ARG "SERIAL" "LABEL;TIMEOUT;LOCK" "SOURCES;DEPENDS;LINK" ${ARGN})
  slewring_program(${name} SOURCES ${ARG_SOURCES} DEPENDS ${ARG_DEPENDS}
                   LINK ${ARG_LINK} slewring_build_paths GTest::gtest_main)
  slewring_compile_as_test(${name})
  slewring_compile_together(${name})
  if(NOT "${ARG_SOURCES}" MATCHES "\\.c(;|$)")  # the headers are those of C++
    slewring_precompile(${name} tests)
  endif()
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 600)  # ends what hangs, in Debug beside other work too
  endif()
  set(lock "")
  if(ARG_LOCK)
    set(lock RESOURCE_LOCK ${ARG_LOCK})
  endif()
  gtest_discover_tests(${name} DISCOVERY_TIMEOUT 60 PROPERTIES LABELS ${ARG_LABEL} TIMEOUT ${ARG_TIMEOUT}
                       RUN_SERIAL $<BOOL:${ARG_SERIAL}> ${lock})
endfunction()
