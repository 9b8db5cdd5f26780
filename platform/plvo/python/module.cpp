// SPDX-License-Identifier: Apache-2.0
// plvo._plvo: cameras, recorded sequences and the odometry for Python. What a user sees is described in
// plvo/__init__.pyi and docs/user/python.md.
#include <pybind11/numpy.h>

#include "plvo/python/bindings.hpp"

PYBIND11_MODULE(_plvo, module) {
  using namespace plvo::python;
  // pybind11 finds NumPy when an array is made for the first time, into a static variable, and Python may let
  // another thread run meanwhile; that one would wait for the variable, and keep Python to itself, for ever.
  // Here no other thread has the module yet.
  py::dtype::of<double>();
  module.attr("__version__") = PLVO_VERSION;
  make_error_type(module);
  bind_camera(module);
  bind_config(module);
  bind_result(module);
  bind_prior(module);
  bind_odometry(module);
  bind_map(module);
  bind_sequence(module);
}
