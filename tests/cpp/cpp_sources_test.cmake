# SPDX-License-Identifier: Apache-2.0
# The project of docs/user/cpp.md with the sources of plvo inside: once with the page's add_subdirectory, once with its FetchContent.
# Only the program is compiled, in both: architecture_embedding builds and runs a project with the sources inside, architecture_install
# the page's project with the installed library.
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
  string(APPEND text "\nadd_library(compiled OBJECT track_own_camera.cpp)\ntarget_link_libraries(compiled PRIVATE plvo::core)\n")
  file(WRITE ${folder}/CMakeLists.txt "${text}")
  file(COPY ${PAGE}/track_own_camera.cpp DESTINATION ${folder})
  execute_process(COMMAND ${CMAKE_COMMAND} -S ${folder} -B ${folder}/build -G ${GENERATOR} -DCMAKE_CXX_COMPILER=${COMPILER}
    -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS_DEBUG= COMMAND_ERROR_IS_FATAL ANY)
  execute_process(COMMAND ${CMAKE_COMMAND} --build ${folder}/build --target compiled COMMAND_ERROR_IS_FATAL ANY)
endforeach()
if(EXISTS ${WORK}/fetch/build/_deps/plvo-build/tests OR EXISTS ${WORK}/fetch/build/_deps/plvo-build/tools)
  message(FATAL_ERROR "more than the core was taken in")
endif()
