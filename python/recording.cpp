#include "sensing/recording.hpp"

#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <atomic>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "base/files/outputs.hpp"
#include "base/text.hpp"
#include "driver/sources.hpp"
#include "exported.hpp"
#include "line/values.hpp"
#include "module.hpp"
#include "running.hpp"
#include "setup/options/options.hpp"
#include "setup/tasks/export.hpp"
#include "shapes.hpp"
#include "tasks_doc.hpp"
#include "values/arrays.hpp"
#include "values/options.hpp"

namespace palpa::python {
namespace {

struct RecordingObject {
  std::string source;
  sensing::Recording recording;
};

/// A restored one of a forked process is empty, as restored_scene() is, and is refused when it is used.
const sensing::Recording& loaded(const RecordingObject& o) {
  if (o.recording.entries.empty()) refuse_fork();
  return o.recording;
}

py::list images_of(const RecordingObject& o, py::ssize_t index) {
  const auto count = static_cast<py::ssize_t>(loaded(o).entries.size());
  if (index < -count || index >= count)
    throw py::index_error(fmt::format("the recording has {}", counted(o.recording.entries.size(), "frame")));
  sensing::FrameSet set;
  unlocked([&] { sensing::read_entry(o.recording, static_cast<std::size_t>(index < 0 ? index + count : index), set); });
  py::list images;
  for (std::size_t camera = 0; camera < set.frames.size(); ++camera) {
    const sensing::Camera& of = o.recording.cameras[camera];
    py::array_t<std::uint16_t> image({static_cast<py::ssize_t>(of.height), static_cast<py::ssize_t>(of.width)},
                                     set.frames[camera].depth.data());
    images.append(sealed(std::move(image)));
  }
  return images;
}

struct ExportArguments {
  setup::ExportTask task;
};
void add_export_options(CLI::App& app, ExportArguments& o) {
  const line::Group group(app, "What to export");
  setup::add_frame_options(group, o.task, "number of frames to export; 0 exports all until the source ends");
  group.text("--foci", o.task.foci, "FILE", "writes the foci of each frame, as .csv or .json");
  group.text("--drives", o.task.drives, "FILE", "writes the drive of every slot, as palpa run --link record:FILE does");
  setup::add_session_options(app, o.task, setup::FingerMesh::unknown, "--foci-count");
  setup::add_common(app, o.task.common);
}
constexpr std::initializer_list<const char*> not_exported = {"--scene", "--source", "--json", "--quiet", "--log-level"};

constinit DeclaredOnce<ExportArguments> export_options("export", add_export_options, not_exported);

std::shared_ptr<ExportObject> export_frames(const py::object& scene, const py::object& source,
                                            const py::kwargs& kwargs) {
  refuse_fork();
  ExportArguments o = export_options().read(kwargs);
  if (py::isinstance<RecordingObject>(source)) {
    o.task.source = "recording:" + source.cast<const RecordingObject&>().source;
  } else {
    o.task.source = file_of("source", source);
  }
  if (const SceneObject* const loaded =
          loaded_scene(scene, kwargs, {"gltf_scene", "surface", "parts", "internal_faces"})) {
    set_scene(*loaded, o.task);
  } else {
    o.task.scene = file_of("scene", scene);
  }
  o.task.common.quiet = true;  // a bar on a terminal would be printing
  const std::vector<session::SourceKind> sources = driver::camera_sources();
  setup::check(o.task, sources, true);
  auto made = std::make_shared<ExportObject>();
  std::atomic<bool> stop{false};
  run_beside(stop, [&] {
    const bool writes_events = !o.task.events.starts_with("udp:");
    const Outputs outputs({{"--foci", o.task.foci},
                           {"--drives", o.task.drives},
                           {"--events", writes_events ? o.task.events : std::string()}});
    o.task.common.device = setup::kept_device(o.task.common);
    setup::FocusRows rows;
    session::Link* link = &rows;
    made->result = setup::ExportRun(o.task, sources, stop, {&link, 1}).run();
    made->rows = rows.rows();
  });
  return made;
}

py::dict foci_table(const ExportObject& o) {
  const auto count = static_cast<py::ssize_t>(o.rows.size());
  py::dict table;
  const auto whole = [&](const char* key, auto get) {
    py::array_t<std::int64_t> column(count);
    for (std::size_t i = 0; i < o.rows.size(); ++i)
      column.mutable_data()[i] = static_cast<std::int64_t>(get(o.rows[i]));
    table[key] = sealed(std::move(column));
  };
  const auto real = [&](const char* key, auto get) {
    py::array_t<double> column(count);
    for (std::size_t i = 0; i < o.rows.size(); ++i)
      column.mutable_data()[i] = double{get(o.rows[i])};
    table[key] = sealed(std::move(column));
  };
  using Row = setup::FocusRow;
  whole("slot", [](const Row& r) { return r.slot; });
  real("time", [](const Row& r) { return r.time_s; });
  whole("finger", [](const Row& r) { return r.finger; });
  whole("solid", [](const Row& r) { return r.solid; });
  whole("focus", [](const Row& r) { return r.focus; });
  real("x", [](const Row& r) { return r.position.x; });
  real("y", [](const Row& r) { return r.position.y; });
  real("z", [](const Row& r) { return r.position.z; });
  real("gain", [](const Row& r) { return r.gain; });
  return table;
}

}  // namespace

void add_recording(py::module_& m) {
  m.def("_restore_recording", [](const std::string& folder) {
    if (!is_own_process()) return RecordingObject{folder, {}};
    return RecordingObject{folder, unlocked([&] { return sensing::load_recording(folder); })};
  });
  py::class_<RecordingObject>(m, "Recording", recording_doc)
      .def(py::init([](const py::object& folder) {
             const std::string path = file_of("folder", folder);
             return RecordingObject{path, unlocked([&] { return sensing::load_recording(path); })};
           }),
           py::arg("folder"))
      .def_property_readonly(
          "source", [](const RecordingObject& o) { return shown_text(o.source); }, "str: its folder.")
      .def("__len__", [](const RecordingObject& o) { return loaded(o).entries.size(); })
      .def_property_readonly(
          "cameras",
          [](const RecordingObject& o) {
            std::vector<std::string> names;
            for (const sensing::Camera& camera : loaded(o).cameras)
              names.push_back(camera.name);
            return names;
          },
          "list of str: the names of its cameras.")
      .def_property_readonly(
          "times",
          [](const RecordingObject& o) {
            std::vector<double> times;
            for (const sensing::Recording::Entry& entry : loaded(o).entries)
              times.push_back(entry.time_s);
            return copied(std::span<const double>(times));
          },
          "ndarray of float64, shape (n,): capture times, seconds.")
      .def("images", &images_of, py::arg("frame"), images_doc)
      .def("__reduce__",
           [](const py::object& self) {
             return py::make_tuple(py::module_::import("palpa._pickle").attr("recording"),
                                   py::make_tuple(self.cast<const RecordingObject&>().source));
           })
      .def("__repr__", [](const RecordingObject& o) {
        return shown_text(fmt::format("<palpa.Recording {}: {} of {}>", o.source,
                                      counted(o.recording.entries.size(), "frame"),
                                      counted(o.recording.cameras.size(), "camera")));
      });
  py::class_<ExportObject, std::shared_ptr<ExportObject>>(m, "Export", "The foci of all frames of a source.")
      .def_property_readonly(
          "foci", &foci_table,
          "dict: one array per column, one entry per focus of a frame: slot, time (s), finger, solid, "
          "focus, x, y, z (m, world), gain. pandas.DataFrame(export.foci) is a table.")
      .def_property_readonly(
          "frames", [](const ExportObject& o) { return o.result.stats.frames; }, "int")
      .def_property_readonly(
          "slot", [](const ExportObject& o) { return o.result.stats.slot_s; }, "float: seconds of one drive.")
      .def(
          "json", [](const ExportObject& o) { return setup::to_json(o.result); },
          "str: what `palpa export --json` writes.")
      .def("__repr__", [](const ExportObject& o) {
        return fmt::format("<palpa.Export: {}, {}>", counted(o.result.stats.frames, "frame"),
                           counted(o.rows.size(), "row"));
      });
  const std::string doc = export_options().documented(export_doc);
  m.def("export", &export_frames, py::arg("scene"), py::arg("source"), doc.c_str());
}

}  // namespace palpa::python
