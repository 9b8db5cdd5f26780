# SPDX-License-Identifier: Apache-2.0
# Installs the build to a fresh prefix and builds a stranger's project against it.
# cmake -DBUILD=<build> -DWORK=<folder> -DCONSUMER=<folder> -DCOMPILER=<c++> -DFLAGS=<flags> -P install_test.cmake
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "failed: ${ARGN}")
  endif()
endfunction()

file(REMOVE_RECURSE ${WORK})
run(${CMAKE_COMMAND} -E env --unset=DESTDIR ${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/prefix)
foreach(header base/status.hpp math/se3.hpp camera/camera_model.hpp odometry/odometry.hpp hal/rgbd_camera.hpp)
  if(NOT EXISTS ${WORK}/prefix/include/plvo/${header})
    message(FATAL_ERROR "not installed: include/plvo/${header}")
  endif()
endforeach()
run(${CMAKE_COMMAND} -S ${CONSUMER} -B ${WORK}/build -DCMAKE_PREFIX_PATH=${WORK}/prefix -DCMAKE_CXX_COMPILER=${COMPILER}
  -DCMAKE_CXX_FLAGS=${FLAGS} -DCMAKE_CXX_STANDARD=20)
run(${CMAKE_COMMAND} --build ${WORK}/build)
run(${WORK}/build/consumer)
if(TOOL)
  run(${WORK}/prefix/bin/plvo --version)
endif()
