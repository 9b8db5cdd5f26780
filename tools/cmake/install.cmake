# SPDX-License-Identifier: Apache-2.0
# cmake --install: the public headers under include/plvo/<module>/, libplvo_core.a, the CMake package (find_package(plvo)
# defines plvo::core, plvo::hal and plvo::plvo, the shared library for C), the files for pkg-config, and the command line.
# The components are the Debian packages of debian/rules: library, development, python, ros1, and tools, which is the default.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

target_include_directories(plvo_core PUBLIC $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
foreach(target core hal)
  set_target_properties(plvo_${target} PROPERTIES EXPORT_NAME ${target})
endforeach()
install(TARGETS plvo_core plvo_hal EXPORT plvoTargets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development)
if(PROJECT_IS_TOP_LEVEL AND NOT CMAKE_CXX_FLAGS MATCHES "-fsanitize|-flto" AND NOT CMAKE_INTERPROCEDURAL_OPTIMIZATION)
  install(CODE "
    execute_process(COMMAND ${CMAKE_COMMAND}
      -DARCHIVE=\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_LIBDIR}/$<TARGET_FILE_NAME:plvo_core>
      -DCXX=${CMAKE_CXX_COMPILER} \"-DFLAGS=${CMAKE_CXX_FLAGS}\" -DNM=${CMAKE_NM} -DOBJCOPY=${CMAKE_OBJCOPY}
      -DAR=${CMAKE_AR} -P ${PROJECT_SOURCE_DIR}/tools/cmake/seal_archive.cmake COMMAND_ERROR_IS_FATAL ANY)" COMPONENT development)
endif()
get_property(headers GLOBAL PROPERTY PLVO_PUBLIC_HEADERS)
foreach(header ${headers})
  string(REGEX REPLACE "^${PROJECT_SOURCE_DIR}/(core|hal|platform)/(.*)/[^/]*$" "\\2" module ${header})
  install(FILES ${header} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/${module} COMPONENT development)
endforeach()
if(TARGET plvo_shared)
  target_include_directories(plvo_shared INTERFACE $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  install(TARGETS plvo_shared EXPORT plvoTargets
    LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT library NAMELINK_COMPONENT development)
endif()

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/plvo)
install(EXPORT plvoTargets NAMESPACE plvo:: DESTINATION ${package_dir} COMPONENT development)
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/plvoConfig.cmake CONTENT [=[
include(CMakeFindDependencyMacro)
find_dependency(Eigen3 3.3 NO_MODULE)
include(${CMAKE_CURRENT_LIST_DIR}/plvoTargets.cmake)
]=] @ONLY)
# Before version 1.0, a new minor version may change the interface.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/plvoConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/plvoConfig.cmake ${PROJECT_BINARY_DIR}/plvoConfigVersion.cmake DESTINATION ${package_dir}
  COMPONENT development)

# pkg-config: plvo is the shared library, plvo-core the static one for C++.
file(RELATIVE_PATH up /prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig /prefix)
function(plvo_pkg_config name description lines)
  set(file ${PROJECT_BINARY_DIR}/${name}.pc)
  file(CONFIGURE OUTPUT ${file} @ONLY CONTENT "prefix=\${pcfiledir}/${up}
libdir=\${prefix}/${CMAKE_INSTALL_LIBDIR}
includedir=\${prefix}/${CMAKE_INSTALL_INCLUDEDIR}

Name: ${name}
Description: ${description}
Version: ${PROJECT_VERSION}
Cflags: -I\${includedir}
Libs: -L\${libdir} -l${lines}\n")
  install(FILES ${file} DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT development)
endfunction()
plvo_pkg_config(plvo-core "${PROJECT_DESCRIPTION}, for C++" "plvo_core\nRequires: eigen3")
if(TARGET plvo_shared)
  plvo_pkg_config(plvo "${PROJECT_DESCRIPTION}, for C" plvo)
endif()

if(TARGET plvo_python_odometry)
  include(tools/cmake/python.cmake)
  set(PLVO_PYTHON_INSTALL_DIR lib/python3/dist-packages CACHE STRING "Where the Python package goes, under the prefix or absolute")
  set(python_source ${PROJECT_SOURCE_DIR}/platform/plvo/python/plvo)
  install(TARGETS plvo_python_odometry plvo_python_evaluation
    LIBRARY DESTINATION ${PLVO_PYTHON_INSTALL_DIR}/plvo COMPONENT python)
  install(FILES ${python_source}/__init__.py ${python_source}/__init__.pyi ${python_source}/py.typed
    DESTINATION ${PLVO_PYTHON_INSTALL_DIR}/plvo COMPONENT python)
endif()

# A package of ROS, where roslaunch looks for it.
if(TARGET plvo_ros1_node)
  install(TARGETS plvo_ros1_node RUNTIME DESTINATION lib/plvo COMPONENT ros1)
  install(FILES ${PROJECT_BINARY_DIR}/ros1/plvo/package.xml DESTINATION ${CMAKE_INSTALL_DATADIR}/plvo COMPONENT ros1)
  install(FILES ${PROJECT_SOURCE_DIR}/platform/plvo/ros1/plvo.launch DESTINATION ${CMAKE_INSTALL_DATADIR}/plvo/launch
    COMPONENT ros1)
endif()

# The sources of the package of ROS 2, which a workspace of colcon builds.
if(TARGET plvo_ros AND TARGET plvo_shared)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/platform/plvo/ros2/ DESTINATION src/plvo_ros COMPONENT development)
endif()

# The pages. Messages name them by this path below the prefix; the link makes it right in the build folder, too.
install(DIRECTORY ${PROJECT_SOURCE_DIR}/docs/ DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/plvo)
file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/share/doc)
file(CREATE_LINK ${PROJECT_SOURCE_DIR}/docs ${PROJECT_BINARY_DIR}/share/doc/plvo SYMBOLIC)

if(TARGET plvo)
  install(TARGETS plvo RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()
