// Depth cameras that come from no file.
#pragma once

#include <pybind11/pybind11.h>

#include "sensing/camera.hpp"
#include "setup/sessions/touch_input.hpp"

namespace palpa::python {

namespace py = pybind11;

/// `palpa.Camera`.
struct CameraObject {
  sensing::Camera camera;
};

/// Adds the cameras of an argument: a Camera, a path, a list of these, or None.
void take_cameras(const py::object& given, setup::TouchInputOptions& o);

}  // namespace palpa::python
