// SPDX-License-Identifier: Apache-2.0
// plvo._plvo: cameras, recorded sequences and the odometry for Python. What a user sees is described in
// plvo/__init__.pyi and docs/user/python.md.
#include <pybind11/numpy.h>

#include <stdexcept>
#include <string>

#include "plvo/python/bindings.hpp"

namespace plvo::python {

const char* docstring(const std::string& name) {
  if (const auto known = kDocstrings.find(name); known != kDocstrings.end()) return known->second;
  if (name.find("__") != std::string::npos) return nullptr;
  throw std::logic_error("plvo." + name + " has no docstring in __init__.pyi");
}

}  // namespace plvo::python

PYBIND11_MODULE(_plvo, module) {
  using namespace plvo::python;
  using namespace py::literals;
  // pybind11 finds NumPy when an array is made for the first time, into a static variable, and Python may let
  // another thread run meanwhile; that one would wait for the variable, and keep Python to itself, for ever.
  // Here no other thread has the module yet.
  py::dtype::of<double>();
  module.attr("__version__") = PLVO_VERSION;
  make_error_type(module, docstring("Error"));
  module.def("_docstring", &docstring, "name"_a);
  bind_camera(module);
  bind_config(module);
  bind_result(module);
  bind_prior(module);
  bind_odometry(module);
  bind_map(module);
  bind_sequence(module);
}
