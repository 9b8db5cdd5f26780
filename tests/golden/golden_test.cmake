# SPDX-License-Identifier: Apache-2.0
# Runs the golden program and compares its output with the committed one, byte for byte.
# cmake -DPROGRAM="<emulator;…;>program" -DGOLDEN=<file> [-DUPDATE=ON] [-DEIGEN=<version>] -P golden_test.cmake
cmake_minimum_required(VERSION 3.22)
execute_process(COMMAND ${PROGRAM} OUTPUT_VARIABLE output RESULT_VARIABLE result)
if(NOT result EQUAL 0)
  message(FATAL_ERROR "${PROGRAM} ended with ${result}\n${output}")
endif()
if(UPDATE)
  file(WRITE ${GOLDEN} "${output}")
  return()
endif()
file(READ ${GOLDEN} golden)
if(output STREQUAL golden)
  return()
endif()

# Name the first line that differs, and on it the first column: the stage of the frame to look at.
string(REPLACE "\n" ";" output_lines "${output}")
string(REPLACE "\n" ";" golden_lines "${golden}")
list(GET golden_lines 0 header)
string(REPLACE " " ";" columns "${header}")
foreach(got expected IN ZIP_LISTS output_lines golden_lines)
  if(got STREQUAL expected)
    continue()
  endif()
  string(REPLACE " " ";" got_words "${got}")
  string(REPLACE " " ";" expected_words "${expected}")
  foreach(column got_word expected_word IN ZIP_LISTS columns got_words expected_words)
    if(NOT got_word STREQUAL expected_word)
      set(where ${column})
      break()
    endif()
  endforeach()
  list(GET expected_words 0 run)
  list(GET expected_words 1 frame)
  message(FATAL_ERROR "the bits differ\n  first in ${run}, frame ${frame}: ${where}\n"
    "  expected ${expected}\n  got      ${got}\n"
    "This build took its sums from Eigen ${EIGEN}; the golden file was made with ${GOLDEN_EIGEN}.\n"
    "If the algorithm was changed on purpose: cmake --build <build> --target update_golden, and read the difference.")
endforeach()
message(FATAL_ERROR "the output is longer or shorter than ${GOLDEN}")
