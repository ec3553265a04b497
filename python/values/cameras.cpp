#include "values/cameras.hpp"

#include <fmt/format.h>
#include <pybind11/numpy.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "module.hpp"
#include "running.hpp"
#include "sensing/rig.hpp"
#include "shapes.hpp"
#include "values/arrays.hpp"
#include "values/options.hpp"

namespace palpa::python {
namespace {

CameraObject make_camera(std::uint32_t width, std::uint32_t height, const py::object& matrix,
                         const py::object& distortion, double depth_unit, double min_range, const py::object& pose,
                         const std::string& name) {
  sensing::Camera camera{.name = name, .width = width, .height = height, .depth_unit_m = depth_unit};
  const std::vector<Vec3> rows = points_of("matrix", matrix);
  if (rows.size() != 3 || rows[0].y != 0 || rows[1].x != 0 || rows[2] != Vec3(0, 0, 1))
    throw bad_usage("matrix: give the camera matrix [[fx, 0, cx], [0, fy, cy], [0, 0, 1]], in pixels");
  camera.fx = rows[0].x;
  camera.cx = rows[0].z;
  camera.fy = rows[1].y;
  camera.cy = rows[1].z;
  camera.min_range_m = min_range;
  if (!distortion.is_none()) {
    const std::vector<double> values = numbers_of("distortion", distortion);
    if (values.size() > camera.distortion.size())
      throw bad_usage(fmt::format("distortion: give k1, k2, p1, p2, k3, not {} numbers", values.size()));
    std::ranges::copy(values, camera.distortion.begin());
  }
  if (!pose.is_none()) camera.T_world_camera = transform_of("pose", pose);
  sensing::check_camera(camera, "Camera");
  return {camera};
}

}  // namespace

void take_cameras(const py::object& given, setup::TouchInputOptions& o) {
  if (given.is_none()) return;
  std::vector<py::object> several;
  if (py::isinstance<CameraObject>(given) || path_of(given)) {
    several = {given};
  } else if (is_list(given)) {
    for (const py::object one : given.cast<py::sequence>())
      several.push_back(one);
  } else {
    throw bad_usage("camera: give a palpa.Camera or a path, or a list of these");
  }
  for (const py::object& one : several) {
    if (!py::isinstance<CameraObject>(one)) {
      o.cameras.push_back(file_of("camera", one));
      continue;
    }
    o.cameras.push_back(fmt::format("camera {}", o.cameras.size() + 1));
    o.made_cameras.emplace(o.cameras.back(), one.cast<const CameraObject&>().camera);
  }
}

void add_camera(py::module_& m) {
  py::class_<CameraObject>(m, "Camera", R"(A depth camera, where there is no TOML file of it.

Parameters
----------
width, height : int
    Pixels.
matrix : array_like, shape (3, 3)
    [[fx, 0, cx], [0, fy, cy], [0, 0, 1]], in pixels; pixel centres are whole numbers.
distortion : array_like, shape (n,), optional
    OpenCV's k1, k2, p1, p2, k3, or the first of these. The default is none.
depth_unit : float, optional
    Metres per step of the 16-bit depth; depth 0 means no data.
min_range : float, optional
    Metres; nearer depths are no data.
pose : array_like, shape (4, 4), optional
    From the camera (x right, y down, z forward) to the world. The default is the identity.
name : str, optional

Raises
------
BadInput
    A value is out of range.)")
      .def(py::init(&make_camera), py::arg("width"), py::arg("height"), py::arg("matrix"), py::kw_only(),
           py::arg("distortion") = py::none(), py::arg("depth_unit") = 0.001, py::arg("min_range") = 0.0,
           py::arg("pose") = py::none(), py::arg("name") = "camera")
      .def_property_readonly(
          "name", [](const CameraObject& o) { return o.camera.name; }, "str")
      .def_property_readonly(
          "shape", [](const CameraObject& o) { return py::make_tuple(o.camera.height, o.camera.width); },
          "tuple of int: the shape of its images, (height, width).")
      .def_property_readonly(
          "pose", [](const CameraObject& o) { return copied(o.camera.T_world_camera); },
          "ndarray of float64, shape (4, 4): from the camera to the world.")
      .def("__repr__", [](const CameraObject& o) {
        return shown_text(fmt::format("<palpa.Camera {}: {} x {}>", o.camera.name, o.camera.width, o.camera.height));
      });
}

}  // namespace palpa::python
