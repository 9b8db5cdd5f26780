# SPDX-License-Identifier: Apache-2.0
# cpack: Debian packages, one for each component of install.cmake. tools/setup/package.sh configures for it (prefix
# /usr), builds, and tests the packages in a clean root.
set(PLVO_PACKAGE_CONTACT "plvo maintainers <maintainers@plvo.invalid>" CACHE STRING "Whom the packages name as their maintainer")
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "${PLVO_PACKAGE_CONTACT}")
set(CPACK_PACKAGE_NAME plvo)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_SET_DESTDIR ON)  # the path of OpenNI2's driver folder is absolute
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
  OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_COMPONENTS_ALL library development tools)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
# The output of dpkg-shlibdeps on this machine, which cannot analyse packages of another architecture. package.sh compares
# the two.
set(needed_by_library "libbz2-1.0, libc6 (>= 2.36), libfmt9, libgcc-s1, liblz4-1, libspng0, libsqlite3-0,
  libstdc++6 (>= 12), libturbojpeg0, libyaml-cpp0.7, libzstd1")
set(needed_by_tools "${needed_by_library}, libfreenect0.5, libmicrohttpd12, libopenni2-0, libusb-1.0-0")
foreach(component library tools)
  string(REGEX REPLACE "\n *" " " needed_by_${component} "${needed_by_${component}}")
  file(WRITE ${PROJECT_BINARY_DIR}/packaging/needed_by_${component} "${needed_by_${component}}\n")
endforeach()
if(CMAKE_CROSSCOMPILING)
  set(CPACK_DEBIAN_LIBRARY_PACKAGE_DEPENDS "${needed_by_library}")
  set(CPACK_DEBIAN_TOOLS_PACKAGE_DEPENDS "${needed_by_tools}")
  set(CPACK_DEBIAN_PACKAGE_ARCHITECTURE ${debian_architecture})  # from the toolchain file
else()
  set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
endif()

# plvo_package(<component> <name> <section> <text>)
macro(plvo_package component name section text)
  string(TOUPPER ${component} upper)
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${name})
  set(CPACK_DEBIAN_${upper}_PACKAGE_SECTION ${section})
  set(CPACK_COMPONENT_${upper}_DESCRIPTION "plvo follows an RGB-D camera from point and line features and gives a pose
with its covariance for every frame, or says why there is none.\n${text}")
  install(FILES ${PROJECT_SOURCE_DIR}/tools/packaging/copyright ${PROJECT_BINARY_DIR}/packaging/changelog.gz
    DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${name} COMPONENT ${component})
endmacro()
plvo_package(library libplvo${PLVO_ABI_VERSION} libs "The shared library, for C and for languages that call C.")
plvo_package(development libplvo-dev libdevel
  "Headers for C and C++, the static core for C++, files for CMake and pkg-config.")
plvo_package(tools plvo-tools science
  "The command line tracks recordings and live sensors, evaluates and simulates.
With a udev rule, a driver of the Kinect v1 for OpenNI2, a service, and the pages of plvo.")
# shlibs names the package that a program linked with the library depends on; triggers updates the system's library cache.
file(WRITE ${PROJECT_BINARY_DIR}/packaging/shlibs "libplvo ${PLVO_ABI_VERSION} libplvo${PLVO_ABI_VERSION} (>= ${PROJECT_VERSION})\n")
file(WRITE ${PROJECT_BINARY_DIR}/packaging/triggers "activate-noawait ldconfig\n")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_CONTROL_EXTRA
  ${PROJECT_BINARY_DIR}/packaging/shlibs ${PROJECT_BINARY_DIR}/packaging/triggers)
foreach(component LIBRARY DEVELOPMENT PYTHON ROS1)
  set(CPACK_DEBIAN_${component}_PACKAGE_SUGGESTS plvo-tools)  # it has the pages that messages name
endforeach()
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "libplvo${PLVO_ABI_VERSION} (= ${PROJECT_VERSION}), libeigen3-dev")
if(TARGET plvo_python_odometry)
  list(APPEND CPACK_COMPONENTS_ALL python)
  plvo_package(python python3-plvo python "Odometry, recorded sequences and evaluation for Python, with NumPy arrays.")
  math(EXPR next_minor "${Python_VERSION_MINOR} + 1")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
    "python3 (>= 3.${Python_VERSION_MINOR}~), python3 (<< 3.${next_minor}), python3-numpy")
  if(CMAKE_CROSSCOMPILING)
    string(PREPEND CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "${needed_by_library}, ")
  endif()
  set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_STRICT_PERMISSION ON)
  configure_file(tools/packaging/python-postinst packaging/postinst COPYONLY)
  configure_file(tools/packaging/python-prerm packaging/prerm COPYONLY)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA ${PROJECT_BINARY_DIR}/packaging/postinst ${PROJECT_BINARY_DIR}/packaging/prerm)
endif()

if(TARGET plvo_ros1_node)
  list(APPEND CPACK_COMPONENTS_ALL ros1)
  plvo_package(ros1 ros-plvo misc "A node for ROS 1: odometry, tf and diagnostics from images, with a launch file.")
  set(CPACK_DEBIAN_ROS1_PACKAGE_DEPENDS python3-roslaunch)
endif()

# The date of the last commit, so that two builds of it are identical.
find_program(GIT git)
if(GIT)
  execute_process(COMMAND ${GIT} -C ${PROJECT_SOURCE_DIR} log -1 --format=%cD OUTPUT_VARIABLE day
    OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
endif()
if(NOT day)
  string(TIMESTAMP day "%a, %d %b %Y %H:%M:%S +0000" UTC)
endif()
file(WRITE ${PROJECT_BINARY_DIR}/packaging/changelog "plvo (${PROJECT_VERSION}) unstable; urgency=medium

  * plvo ${PROJECT_VERSION}; CHANGELOG.md of the sources says what changed.

 -- ${PLVO_PACKAGE_CONTACT}  ${day}
")
execute_process(COMMAND gzip -9nkf ${PROJECT_BINARY_DIR}/packaging/changelog)
install(FILES ${PROJECT_SOURCE_DIR}/tools/packaging/plvo-live.service DESTINATION lib/systemd/system COMPONENT tools)
# Its options, which an upgrade leaves as the administrator wrote them.
install(FILES ${PROJECT_SOURCE_DIR}/tools/packaging/plvo-live.default DESTINATION /etc/default RENAME plvo-live COMPONENT tools)
file(WRITE ${PROJECT_BINARY_DIR}/packaging/conffiles "/etc/default/plvo-live\n")
set(CPACK_DEBIAN_TOOLS_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_TOOLS_PACKAGE_CONTROL_EXTRA ${PROJECT_BINARY_DIR}/packaging/conffiles)
include(CPack)
