# SPDX-License-Identifier: Apache-2.0
# Builds another project that includes plvo by add_subdirectory, and compares its golden run with the stored one.
# A unity build takes a third of the time.
# cmake -DPLVO=<source> -DWORK=<folder> -DGENERATOR=<generator> -DCOMPILER=<c++> -P embedding_test.cmake
foreach(step
    "-S;${PLVO}/tests/architecture/embedding;-B;${WORK};-G;${GENERATOR};-DPLVO=${PLVO};-DCMAKE_CXX_COMPILER=${COMPILER};-DCMAKE_BUILD_TYPE=Debug;-DCMAKE_UNITY_BUILD=ON;-DCMAKE_UNITY_BUILD_BATCH_SIZE=12"
    "--build;${WORK}")
  execute_process(COMMAND ${CMAKE_COMMAND} ${step} RESULT_VARIABLE result)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "failed: ${step}")
  endif()
endforeach()
set(PROGRAM ${WORK}/embedding)
set(EIGEN "the consumer's project")
set(GOLDEN_EIGEN "the one named in tools/cmake/plvo.cmake")
set(GOLDEN ${PLVO}/tests/golden/golden.txt)
include(${PLVO}/tests/golden/golden_test.cmake)
