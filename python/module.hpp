// The parts of the Python module `palpa`. Each function adds its classes and functions to the module. The module binds
// the functions of engine/setup/tasks and engine/session; it computes nothing itself.
#pragma once

#include <pybind11/pybind11.h>

#include <string>

#include "base/error.hpp"

namespace palpa::python {

namespace py = pybind11;

void add_errors(py::module_& m);
/// Call at the end. Two mistakes then raise TypeError, which would otherwise end the program: the use of an object of
/// these classes that has no value, and arguments that do not fit and whose text cannot be put into a message.
void guard(const py::module_& m);
void add_running(py::module_& m);
void add_options(py::module_& m);
void add_shapes(py::module_& m);
void add_places(py::module_& m);
void add_camera(py::module_& m);
void add_touch(py::module_& m);
void add_layout(py::module_& m);
void add_bodies(py::module_& m);
void add_tasks(py::module_& m);
void add_recording(py::module_& m);
void add_session(py::module_& m);
void add_sensation(py::module_& m);
void add_pickles(py::module_& m);

/// Makes it the Python error of this thread, which needs the interpreter's lock.
void raise(const Error& error);

/// Clears the Python error if it says that a value is of no use (TypeError, ValueError, OverflowError): the caller has
/// a better message. Throws any other error, such as one of the caller's own code.
void forgive_wrong_value();

/// A name or a message. Bytes that are not UTF-8, as names of files may have, become what os.fsdecode makes of them.
py::str shown_text(const std::string& text);
/// The bytes of a text, as os.fsencode makes them. Throws bad_usage naming the argument `name` for a text with a zero
/// character, and for one that has no bytes.
std::string bytes_of(const std::string& name, py::handle text);

}  // namespace palpa::python
