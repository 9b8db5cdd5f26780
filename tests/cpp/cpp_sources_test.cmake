# SPDX-License-Identifier: Apache-2.0
# The project of docs/user/cpp.md with the sources of plvo inside: once with the page's add_subdirectory, once with its FetchContent.
# The first is built and run, in a unity build without optimisation, which takes the least time. Of the second, whose core is the same,
# only the program is compiled.
# cmake -DPLVO=<source> -DPAGE=<folder with the page's programs> -DWORK=<folder> -DGENERATOR=<generator> -DCOMPILER=<c++> -P …
file(READ ${PAGE}/CMakeLists.txt project)
foreach(way subdirectory fetch)
  file(READ ${PAGE}/${way}.cmake lines)
  string(REGEX REPLACE "find_package[^\n]*\n" "${lines}" text "${project}")
  if(text STREQUAL project)
    message(FATAL_ERROR "the page's project has no find_package")
  endif()
  set(folder ${WORK}/${way})
  file(MAKE_DIRECTORY ${folder}/third_party)
  file(CREATE_LINK ${PLVO} ${folder}/third_party/plvo SYMBOLIC)
  if(way STREQUAL fetch)
    string(APPEND text "\nadd_library(compiled OBJECT track_own_camera.cpp)\ntarget_link_libraries(compiled PRIVATE plvo::core)\n")
  endif()
  file(WRITE ${folder}/CMakeLists.txt "${text}")
  file(COPY ${PAGE}/track_own_camera.cpp DESTINATION ${folder})
  execute_process(COMMAND ${CMAKE_COMMAND} -S ${folder} -B ${folder}/build -G ${GENERATOR} -DCMAKE_CXX_COMPILER=${COMPILER}
    -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS_DEBUG= -DCMAKE_UNITY_BUILD=ON -DCMAKE_UNITY_BUILD_BATCH_SIZE=12
    COMMAND_ERROR_IS_FATAL ANY)
endforeach()
execute_process(COMMAND ${CMAKE_COMMAND} --build ${WORK}/subdirectory/build COMMAND_ERROR_IS_FATAL ANY)
# Without a stream of frames it ends at once.
execute_process(COMMAND ${WORK}/subdirectory/build/track_own_camera INPUT_FILE /dev/null COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CMAKE_COMMAND} --build ${WORK}/fetch/build --target compiled COMMAND_ERROR_IS_FATAL ANY)
if(EXISTS ${WORK}/fetch/build/_deps/plvo-build/tests OR EXISTS ${WORK}/fetch/build/_deps/plvo-build/tools)
  message(FATAL_ERROR "more than the core was taken in")
endif()
