# SPDX-License-Identifier: Apache-2.0
# cmake --install: the public headers of core and hal under include/plvo/<room>/, libplvo_core.a, the CMake package (find_package(plvo)
# gives plvo::core and plvo::hal) and the command line.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

target_include_directories(plvo_core PUBLIC $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
foreach(target core hal)
  set_target_properties(plvo_${target} PROPERTIES EXPORT_NAME ${target})
endforeach()
install(TARGETS plvo_core plvo_hal EXPORT plvoTargets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
if(PROJECT_IS_TOP_LEVEL AND NOT CMAKE_CXX_FLAGS MATCHES "-fsanitize|-flto" AND NOT CMAKE_INTERPROCEDURAL_OPTIMIZATION)
  install(CODE "
    execute_process(COMMAND ${CMAKE_COMMAND}
      -DARCHIVE=\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_LIBDIR}/$<TARGET_FILE_NAME:plvo_core>
      -DCXX=${CMAKE_CXX_COMPILER} \"-DFLAGS=${CMAKE_CXX_FLAGS}\" -DNM=${CMAKE_NM} -DOBJCOPY=${CMAKE_OBJCOPY}
      -DAR=${CMAKE_AR} -P ${PROJECT_SOURCE_DIR}/tools/cmake/seal_archive.cmake COMMAND_ERROR_IS_FATAL ANY)")
endif()
get_property(headers GLOBAL PROPERTY PLVO_PUBLIC_HEADERS)
foreach(header ${headers})
  string(REGEX REPLACE "^${PROJECT_SOURCE_DIR}/(core|hal)/(.*)/[^/]*$" "\\2" room ${header})
  install(FILES ${header} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/${room})
endforeach()

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/plvo)
install(EXPORT plvoTargets NAMESPACE plvo:: DESTINATION ${package_dir})
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/plvoConfig.cmake CONTENT [=[
include(CMakeFindDependencyMacro)
find_dependency(Eigen3 3.3 NO_MODULE)
include(${CMAKE_CURRENT_LIST_DIR}/plvoTargets.cmake)
]=] @ONLY)
# Before 1.0 a new minor version may change the interface.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/plvoConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/plvoConfig.cmake ${PROJECT_BINARY_DIR}/plvoConfigVersion.cmake DESTINATION ${package_dir})

if(TARGET plvo)
  install(TARGETS plvo RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()
