# SPDX-License-Identifier: Apache-2.0
# Counts the instructions of one call of a function of multibody with callgrind and compares them with a bound. Unlike a
# time the count depends on neither load nor clock, but on compiler and -march.
#   cmake -DVALGRIND=... -DPROGRAM=.../bin/counted_dynamics -DFUNCTION=forward_dynamics -DMECHANISM=crane -DMOST=4000
#         -P count_instructions.cmake
execute_process(
  COMMAND ${VALGRIND} --tool=callgrind --callgrind-out-file=/dev/null --collect-atstart=no
          "--toggle-collect=slew::multibody::${FUNCTION}(*)" ${PROGRAM} ${MECHANISM}
  OUTPUT_VARIABLE output ERROR_VARIABLE report RESULT_VARIABLE result)
if(NOT result EQUAL 0)
  message(FATAL_ERROR "valgrind failed (${result}):\n${report}")
endif()
if(NOT output MATCHES "calls ([0-9]+)" OR CMAKE_MATCH_1 EQUAL 0)
  message(FATAL_ERROR "no number of calls in: ${output}")
endif()
set(calls ${CMAKE_MATCH_1})
if(NOT report MATCHES "Collected : ([0-9]+)" OR CMAKE_MATCH_1 EQUAL 0)
  message(FATAL_ERROR "nothing was counted; ${FUNCTION}() was not found by its name:\n${report}")
endif()
math(EXPR each "${CMAKE_MATCH_1} / ${calls}")
message(STATUS "${MECHANISM}: ${each} instructions a call, at most ${MOST}")
if(each GREATER MOST)
  message(FATAL_ERROR "${MECHANISM}: ${each} instructions a call of ${FUNCTION}(), more than ${MOST}; "
                      "callgrind_annotate shows where: valgrind --tool=callgrind "
                      "--toggle-collect='slew::multibody::${FUNCTION}(*)' ${PROGRAM} ${MECHANISM}")
endif()
