# SPDX-License-Identifier: Apache-2.0
# Included by the modules of the Python package: finds pybind11 in the including directory, to which its targets then belong,
# and decides whether the package is built (PLVO_BUILD_PYTHON).

# Prefers the distribution's Python, to which its numpy belongs, to another one that is earlier in PATH.
if(NOT DEFINED Python_EXECUTABLE AND EXISTS /usr/bin/python3)
  set(Python_EXECUTABLE /usr/bin/python3)
endif()
find_package(Python COMPONENTS Interpreter Development.Module QUIET)
set(PYBIND11_FINDPYTHON ON)
find_package(pybind11 QUIET)
set(python_can_be_built ${pybind11_FOUND})
if(CMAKE_CXX_FLAGS MATCHES "-fsanitize" OR CMAKE_CROSSCOMPILING)
  set(python_can_be_built OFF)  # a sanitizer would have to be loaded before Python itself; tests run this machine's Python
endif()
option(PLVO_BUILD_PYTHON "Build the Python package" ${python_can_be_built})
if(PLVO_BUILD_PYTHON AND NOT pybind11_FOUND)
  message(FATAL_ERROR "PLVO_BUILD_PYTHON is on, and pybind11 was not found (sudo apt install pybind11-dev python3-dev)")
endif()

set(PLVO_PYTHON_DIR ${PROJECT_BINARY_DIR}/python)
# plvo_python_module(<target> <name> SOURCE.cpp…): builds plvo/<name>.so, optimised for size because a frame spends no time
# in it.
function(plvo_python_module target name)
  pybind11_add_module(${target} MODULE NO_EXTRAS ${ARGN})
  set_target_properties(${target} PROPERTIES OUTPUT_NAME ${name} LIBRARY_OUTPUT_DIRECTORY ${PLVO_PYTHON_DIR}/plvo)
  target_compile_options(${target} PRIVATE $<$<NOT:$<CONFIG:Debug>>:-Os>)
  target_link_libraries(${target} PRIVATE plvo_warnings)
  if(CMAKE_CROSSCOMPILING)  # CMake derives the suffix from this machine's interpreter
    set_target_properties(${target} PROPERTIES
      SUFFIX .cpython-${Python_VERSION_MAJOR}${Python_VERSION_MINOR}-${CMAKE_LIBRARY_ARCHITECTURE}.so)
  endif()
endfunction()
