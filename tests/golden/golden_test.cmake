# SPDX-License-Identifier: Apache-2.0
# Runs the golden program and compares its output with the committed one, byte for byte.
# cmake -DPROGRAM="<emulator;…;>program" -DGOLDEN=<file> [-DUPDATE=ON] [-DEIGEN=<version>] -P golden_test.cmake
execute_process(COMMAND ${PROGRAM} OUTPUT_VARIABLE output RESULT_VARIABLE result)
if(NOT result EQUAL 0)
  message(FATAL_ERROR "${PROGRAM} ended with ${result}")
endif()
if(UPDATE)
  file(WRITE ${GOLDEN} "${output}")
  return()
endif()
file(READ ${GOLDEN} golden)
if(output STREQUAL golden)
  return()
endif()
# Name the first line that differs: it says which stage of the run to look at.
string(REPLACE "\n" ";" output_lines "${output}")
string(REPLACE "\n" ";" golden_lines "${golden}")
foreach(got expected IN ZIP_LISTS output_lines golden_lines)
  if(NOT got STREQUAL expected)
    message(FATAL_ERROR "the bits differ.\n  expected ${expected}\n  got      ${got}\n"
      "This build took its sums from Eigen ${EIGEN}; the golden file was made with ${GOLDEN_EIGEN}.\n"
      "If the algorithm was changed on purpose: cmake --build <build> --target update_golden, and read the difference.")
  endif()
endforeach()
message(FATAL_ERROR "the output is longer or shorter than ${GOLDEN}")
