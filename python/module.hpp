// The parts of the Python module `palpa`. Each function adds its classes and functions to the module. The module binds
// the functions of engine/setup/tasks and engine/session; it computes nothing itself.
#pragma once

#include <pybind11/pybind11.h>

namespace palpa::python {

namespace py = pybind11;

void add_errors(py::module_& m);
void add_running(py::module_& m);
void add_options(py::module_& m);
void add_shapes(py::module_& m);
void add_touch(py::module_& m);
void add_layout(py::module_& m);
void add_bodies(py::module_& m);
void add_tasks(py::module_& m);
void add_session(py::module_& m);
void add_sweeps(py::module_& m);

}  // namespace palpa::python
