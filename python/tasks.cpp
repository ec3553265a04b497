#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <cstdint>
#include <initializer_list>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "base/files/output_file.hpp"
#include "base/files/outputs.hpp"
#include "base/files/reference.hpp"
#include "base/text.hpp"
#include "driver/sources.hpp"
#include "geometry/gltf/write.hpp"
#include "line/values.hpp"
#include "module.hpp"
#include "running.hpp"
#include "sensing/rig.hpp"
#include "setup/options/options.hpp"
#include "setup/tasks/background.hpp"
#include "setup/tasks/calibrate.hpp"
#include "setup/tasks/decompose.hpp"
#include "setup/tasks/drive.hpp"
#include "setup/tasks/field.hpp"
#include "setup/tasks/simulate_result.hpp"
#include "setup/tasks/touch.hpp"
#include "shapes.hpp"
#include "tasks_doc.hpp"
#include "values/arrays.hpp"
#include "values/options.hpp"

namespace palpa::python {
namespace {

// ---- parts ----------------------------------------------------------------------------------------------------------

struct PartsObject {
  std::vector<setup::Decomposed> solids;
};

struct DecomposeArguments {
  setup::CommonOptions common;
  setup::DecomposeTask task;
};
void add_decompose_options(CLI::App& app, DecomposeArguments& o) {
  const line::Group group(app, "How");
  setup::add_gltf_scene(group, o.task.gltf_scene);
  setup::add_allow_outside(group, o.common);
  setup::add_decompose_options(group, o.task.options);
  group.integer("--seed", o.common.seed, 0, ~std::uint64_t{0}, "the start of all random numbers");
}

constinit DeclaredOnce<DecomposeArguments> decompose_options("decompose", add_decompose_options);

std::shared_ptr<PartsObject> decompose(const py::object& scene, const py::kwargs& kwargs) {
  refuse_fork();
  DecomposeArguments o = decompose_options().read(kwargs);
  if (const SceneObject* const loaded = loaded_scene(scene, kwargs, {"gltf_scene"})) {
    if (loaded->source.empty()) throw bad_usage("decompose: this Scene comes from arrays, but a glTF file is needed");
    o.task.scene = loaded->source;
    o.task.gltf_scene = loaded->gltf_scene;
  } else {
    o.task.scene = file_of("scene", scene);
  }
  o.task.seed = o.common.seed;
  allow_outside_references(o.common.allow_outside);
  return owned(cancellable([&] { return PartsObject{setup::decompose(o.task)}; }));
}

py::list parts_of(const PartsObject& o) {
  py::list solids;
  for (const setup::Decomposed& one : o.solids) {
    py::dict made;
    made["solid"] = one.solid.name;
    made["volume_ratio"] = one.report.volume_ratio();
    made["error_mean"] = one.report.surface_error_m.mean;
    made["error_p95"] = one.report.surface_error_m.p95;
    made["error_max"] = one.report.surface_error_m.max;
    made["mesh_error_mean"] = one.report.mesh_error_m.mean;
    made["mesh_error_p95"] = one.report.mesh_error_m.p95;
    made["mesh_error_max"] = one.report.mesh_error_m.max;
    made["filled_cavities"] = one.report.filled_cavities;
    made["internal_share"] = one.report.internal_share;
    made["seconds"] = one.seconds;
    py::list meshes;
    for (const geometry::Part& part : one.parts.parts)
      meshes.append(std::make_shared<MeshObject>(MeshObject{part.mesh, ""}));
    made["parts"] = meshes;
    solids.append(made);
  }
  return solids;
}

void add_parts(py::module_& m) {
  py::class_<PartsObject, std::shared_ptr<PartsObject>>(m, "Parts", "The convex parts of a scene's solids.")
      .def_property_readonly("solids", &parts_of, parts_solids_doc)
      .def(
          "write",
          [](const PartsObject& o, const py::object& file) {
            unlocked([&, path = file_of("file", file)] { geometry::write_glb(path, setup::part_meshes(o.solids)); });
          },
          py::arg("file"), "Write the parts as a .glb file, which a Scene reads back as these solids.")
      .def(
          "json",
          [](const PartsObject& o, const py::object& file) { return setup::to_json(o.solids, file_of("file", file)); },
          py::arg("file"), "str: what `palpa decompose --json --out file` writes.")
      .def("__repr__",
           [](const PartsObject& o) { return fmt::format("<palpa.Parts of {}>", counted(o.solids.size(), "solid")); });
  m.def("decompose", &decompose, py::arg("scene"), decompose_options().documented(decompose_doc).c_str());
}

// ---- calibration ----------------------------------------------------------------------------------------------------

struct CalibrationObject {
  setup::CalibrateResult result;
};

void add_place(const line::Group& group, setup::TargetPlace& place) {
  group.point("--at", place.at, "where the middle of the target's underside is, in the layout's own frame");
  group.number("--turn", place.turn_deg, {-360, 360}, "DEGREES",
               "how the target is turned about its own z, counter-clockwise seen from above");
}

struct CalibrateArguments {
  setup::CommonOptions common;
  setup::CalibrateTask task;
};
/// The frames of a calibration's task.
void add_frames(const line::Group& group, setup::StillTask& task, std::uint64_t most, const char* frames) {
  group.text("--source", task.source, "SOURCE",
             "where depth frames come from [a rehearsal: the rig's own cameras, rendered]");
  group.integer("--frames", task.frames, 0, most, frames);
  group.flag("--noise-free", task.noise_free, "renders synthetic frames without the sensor's noise");
  group.integer("--seed", task.seed, 0, ~std::uint64_t{0}, "the start of all random numbers");
}

void add_calibrate_options(CLI::App& app, CalibrateArguments& o) {
  const line::Group group(app, "What to calibrate");
  add_frames(group, o.task, 100, "number of frames that are combined; 0 means 30");
  add_place(group, o.task.target);
  setup::add_allow_outside(group, o.common);
  setup::add_rig_options(app, o.task.rig);
}

constinit DeclaredOnce<CalibrateArguments> calibrate_options("calibrate", add_calibrate_options);

std::shared_ptr<CalibrationObject> calibrate(const py::kwargs& kwargs) {
  refuse_fork();
  CalibrateArguments o = calibrate_options().read(kwargs);
  check(o.task);
  allow_outside_references(o.common.allow_outside);
  return owned(cancellable([&] { return CalibrationObject{setup::calibrate(o.task, driver::camera_sources())}; }));
}

py::list cameras_of(const CalibrationObject& o) {
  py::list cameras;
  for (const setup::CalibratedCamera& camera : o.result.cameras) {
    py::dict made;
    made["name"] = camera.name;
    made["pose"] = copied(camera.T_world_camera);
    made["moved"] = camera.moved_m;
    made["turned"] = camera.turned_rad;
    cameras.append(made);
  }
  return cameras;
}

struct TargetArguments {
  setup::TargetPlace place;
  setup::RigOptions rig;
};
void add_target_options(CLI::App& app, TargetArguments& o) {
  add_place(line::Group(app, "Where the target is"), o.place);
  setup::add_rig_options(app, o.rig);
}

constinit DeclaredOnce<TargetArguments> target_options("write_target", add_target_options);

void write_target(const py::object& file, const py::kwargs& kwargs) {
  refuse_fork();
  const TargetArguments o = target_options().read(kwargs);
  const std::string path = file_of("file", file);
  setup::check_target_file(path, o.place);
  unlocked([&] { setup::write_target(path, o.place, setup::load_placed_layout(o.rig)); });
}

constinit DeclaredOnce<setup::RigOptions> nudged_options("write_nudged_rig", setup::add_rig_options);

void write_nudged_rig(const py::object& file, const py::object& offset, const py::kwargs& kwargs) {
  refuse_fork();
  const setup::RigOptions o = nudged_options().read(kwargs);
  const std::string path = file_of("file", file);
  const Vec3 by = point_of("offset", offset);
  unlocked([&] { setup::write_rig(path, setup::nudged_rig(setup::load_posed_rig(o), o, "offset", by)); });
}

struct BackgroundObject {
  setup::BackgroundResult result;
};

struct BackgroundArguments {
  setup::CommonOptions common;
  setup::BackgroundTask task;
};
void add_background_options(CLI::App& app, BackgroundArguments& o) {
  const line::Group group(app, "What is seen");
  add_frames(group, o.task, 1000, "number of frames; 0 means two seconds of them");
  setup::add_allow_outside(group, o.common);
  setup::add_rig_options(app, o.task.rig);
}

constinit DeclaredOnce<BackgroundArguments> background_options("learn_background", add_background_options);

std::shared_ptr<BackgroundObject> learn_background(const py::object& out, const py::kwargs& kwargs) {
  refuse_fork();
  BackgroundArguments o = background_options().read(kwargs);
  if (!out.is_none()) o.task.out = file_of("out", out);
  check(o.task);
  allow_outside_references(o.common.allow_outside);
  return owned(cancellable([&] {
    std::vector<Output> files{{"--out", o.task.out}};
    for (const std::string& image : setup::images_of(o.task))
      files.push_back({"--out", image});
    const Outputs outputs(files);
    return BackgroundObject{setup::learn_background(o.task, driver::camera_sources())};
  }));
}

py::list backgrounds_of(const BackgroundObject& o) {
  py::list cameras;
  for (const setup::BackgroundOfCamera& camera : o.result.cameras) {
    py::dict made;
    made["name"] = camera.name;
    made["pixels"] = camera.learned.pixels;
    made["unsteady"] = camera.learned.unsteady;
    made["noise"] = camera.learned.noise_m;
    made["margin"] = camera.learned.background.margin_m;
    made["file"] = camera.file.empty() ? py::object(py::none()) : py::object(shown_text(camera.file));
    cameras.append(made);
  }
  return cameras;
}

void add_background(py::module_& m) {
  py::class_<BackgroundObject, std::shared_ptr<BackgroundObject>>(m, "Background",
                                                                  "What a rig's cameras see without a hand.")
      .def_property_readonly("cameras", &backgrounds_of,
                             "list of dict: name, pixels (with a depth), unsteady (of these), noise (m), margin (m: "
                             "skin is at least so much nearer) and file (None if nothing is written) of each camera.")
      .def_property_readonly(
          "frames", [](const BackgroundObject& o) { return o.result.frames; }, "int: the number of frames taken.")
      .def(
          "json", [](const BackgroundObject& o) { return setup::to_json(o.result); },
          "str: what `palpa calibrate --background --json` writes.")
      .def("__repr__", [](const BackgroundObject& o) {
        return fmt::format("<palpa.Background: {}>", counted(o.result.cameras.size(), "camera"));
      });
  const std::string doc = background_options().documented(background_doc);
  m.def("learn_background", &learn_background, py::arg("out") = py::none(), doc.c_str());
}

void add_calibration(py::module_& m) {
  py::class_<CalibrationObject, std::shared_ptr<CalibrationObject>>(m, "Calibration", "The poses of a rig's cameras.")
      .def_property_readonly("cameras", &cameras_of,
                             "list of dict: name, pose (4 x 4, from the camera to the world), moved (m) and turned "
                             "(rad) relative to the rig's pose before.")
      .def_property_readonly(
          "frames", [](const CalibrationObject& o) { return o.result.frames; }, "int: the number of frames combined.")
      .def(
          "write_rig",
          [](const CalibrationObject& o, const py::object& file) {
            unlocked([&, path = file_of("file", file)] { setup::write_rig(path, o.result.rig); });
          },
          py::arg("file"), "Write the rig with these poses as a TOML file, for --rig.")
      .def(
          "json", [](const CalibrationObject& o) { return setup::to_json(o.result); },
          "str: what `palpa calibrate --json` writes.")
      .def("__repr__", [](const CalibrationObject& o) {
        return fmt::format("<palpa.Calibration: {}>", counted(o.result.cameras.size(), "camera"));
      });
  const std::string doc = calibrate_options().documented(calibrate_doc);
  m.def("calibrate", &calibrate, doc.c_str());
  const std::string target = target_options().documented(target_doc);
  m.def("write_target", &write_target, py::arg("file"), target.c_str());
  const std::string nudged = nudged_options().documented(nudged_doc);
  m.def("write_nudged_rig", &write_nudged_rig, py::arg("file"), py::arg("offset"), nudged.c_str());
}

}  // namespace

void add_tasks(py::module_& m) {
  add_parts(m);
  add_calibration(m);
  add_background(m);
  m.def(
      "_paths",
      [] {
        py::dict all;
        all["drive"] = setup::drive_rows().paths();
        all["field"] = setup::field_rows().paths();
        all["simulate"] = setup::simulate_rows().paths();
        all["touch"] = setup::touch_rows().paths();
        return all;
      },
      "The paths of the values in the JSON of commands, for plans of sweeps: # is the index of an entry of a list.");
}

}  // namespace palpa::python
