#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <cmath>
#include <complex>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "array/schedule.hpp"
#include "base/error.hpp"
#include "base/text.hpp"
#include "base/words.hpp"
#include "driver/sources.hpp"
#include "layout.hpp"
#include "module.hpp"
#include "running.hpp"
#include "sensing/surroundings.hpp"
#include "session/links/spec.hpp"
#include "session_doc.hpp"
#include "session_object.hpp"
#include "setup/options/options.hpp"
#include "setup/sessions/load.hpp"
#include "setup/sessions/session_setting.hpp"
#include "setup/sessions/touch_input.hpp"
#include "setup/tasks/touch.hpp"
#include "shapes.hpp"
#include "touch_object.hpp"
#include "values/arrays.hpp"
#include "values/cameras.hpp"
#include "values/options.hpp"
#include "values/placed.hpp"

namespace palpa::python {
namespace {

// ---- options --------------------------------------------------------------------------------------------------------

struct SessionArguments {
  setup::LiveOptions live;
  SessionArguments() { live.source.clear(); }
};
void add_options_of_session(CLI::App& app, SessionArguments& o) {
  const line::Group group(app, "Session");
  setup::add_frame_options(group, o.live, "number of frames");
  setup::add_link_options(group, o.live);
  setup::add_session_options(app, o.live, setup::FingerMesh::known);
  setup::add_common(app, o.live.common);
}
constexpr std::initializer_list<const char*> not_of_sessions = {
    "--scene",          "--frames", "--gltf-scene", "--surface", "--parts",
    "--internal-faces", "--null",   "--json",       "--quiet",   "--log-level"};
constinit DeclaredOnce<SessionArguments> session_options("Session", add_options_of_session, not_of_sessions);

void refuse_given(std::initializer_list<std::pair<const char*, bool>> given, const char* with) {
  for (const auto& [name, is_given] : given) {
    if (is_given) throw bad_usage(fmt::format("{} goes with {}", name, with));
  }
}

/// Options that have no effect frame by frame.
void refuse_live_options(const setup::LiveOptions& o) {
  const setup::LiveOptions usual;
  refuse_given({{"link", o.link != usual.link},
                {"every_frame", o.every_frame},
                {"record", !o.record.empty()},
                {"overwrite", o.overwrite},
                {"osc", !o.osc.empty()},
                {"noise_free", o.noise_free},
                {"events", !o.events.empty()},
                {"board_files", !o.board_files.empty()},
                {"steps", o.steps_given},
                {"hold='auto'", o.hold_auto},
                {"ramp", o.safety.ramp_s != 0},
                {"ceiling", o.safety.ceiling != 1}},
               "source: without one, a session works frame by frame");
}

// ---- events ---------------------------------------------------------------------------------------------------------

void add_event(py::module_& m) {
  py::class_<EventObject>(m, "Event", "A finger touches, moves on, presses or releases.")
      .def_property_readonly(
          "kind", [](const EventObject& o) { return std::string(word_of(session::event_words, o.event.kind)); },
          "str: touch, move, press or release.")
      .def_property_readonly(
          "time", [](const EventObject& o) { return o.event.time_s; }, "float: capture of its frame, seconds.")
      .def_readonly("solid", &EventObject::solid, "str: the name of the touched solid.")
      .def_property_readonly(
          "finger", [](const EventObject& o) { return o.event.finger; }, "int: the finger's id.")
      .def_property_readonly(
          "depth", [](const EventObject& o) { return double{o.event.depth_m}; }, "float: metres.")
      .def_property_readonly(
          "centroid", [](const EventObject& o) { return in_world(copied(Vec3(o.event.centroid))); },
          "ndarray of float64, shape (3,): of its contacts, metres, world.")
      .def("__repr__", [](const EventObject& o) {
        return fmt::format("<palpa.Event {} of finger {} on {} at {:.3f} s>",
                           word_of(session::event_words, o.event.kind), o.event.finger, o.solid, o.event.time_s);
      });
}

// ---- the session ----------------------------------------------------------------------------------------------------

/// Options that have no effect on frames of points.
void refuse_camera_options(const setup::LiveOptions& o) {
  setup::refuse_finger_width(o.touch, "depth images");
  refuse_given({{"every_frame", o.every_frame},
                {"record", !o.record.empty()},
                {"keep_boards", o.keep_boards},
                {"hysteresis", o.hysteresis.has_value()}},
               "a source of depth frames, not with points");
}

/// Throws bad_usage for a source that no run would open.
void check_source(const std::string& source) {
  std::vector<session::SourceKind> kinds = setup::with_builtin(driver::camera_sources());
  kinds.push_back({.name = "points", .help = "points, which push_points() gives", .open = {}});
  const auto [name, argument] = session::parse_spec(source);
  const session::SourceKind& kind = session::find_kind(std::span<const session::SourceKind>(kinds), name, "source");
  if (kind.name == "points" && source != kind.name)
    throw bad_usage(fmt::format("source: {} is not {}", source, kind.help));
}

void open_frame_by_frame(SessionObject& o, std::vector<sensing::Camera> cameras) {
  const setup::LiveOptions& options = o.options;
  setup::check(options.drive, o.scene->solids);
  setup::PosedRig rig;
  if (!options.rig.layout.empty() || !options.rig.rig.empty()) {
    rig = setup::load_posed_rig(options.rig);
    o.array =
        std::make_shared<LayoutObject>(LayoutObject{rig.layout, "",
                                                    std::make_shared<const std::vector<array::Transducer>>(
                                                        setup::load_placed_layout(options.rig).layout.transducers)});
  }
  session::SessionSetting setting =
      setup::session_setting(options, o.scene->solids, std::move(cameras), std::move(rig.layout));
  setting.surroundings = sensing::surroundings_of(rig.rig);
  setting.frame_by_frame = true;
  const gpu::Device* const device = setup::kept_device(options.common);
  o.session = device ? std::make_unique<session::Session>(*device, std::move(setting))
                     : std::make_unique<session::Session>(std::move(setting));
  if (o.session->setting().drive.nulls) o.nulls.emplace(o.session->setting().layout, o.session->setting().drive, true);
}

SessionPtr make_session(const std::shared_ptr<SceneObject>& scene, const py::object& camera, bool depth,
                        const py::object& nulls, const py::object& null_radius, const py::kwargs& kwargs) {
  refuse_fork();
  SessionPtr made(new SessionObject(), EndingSession());
  made->scene = scene;
  const py::kwargs rest = py::reinterpret_steal<py::kwargs>(PyDict_Copy(kwargs.ptr()));
  take_method(rest, made->own);
  take_solver(rest, made->own);
  made->options = session_options().read(rest).live;
  setup::LiveOptions& o = made->options;
  if (!nulls.is_none()) refuse_other_frame("nulls", nulls);
  o.drive.nulls = nulls_of(nulls, null_radius);
  made->run.ceiling = o.safety.ceiling;
  o.own_method = own_method(made->own, scene->solids);
  o.own_solver = own_solver(made->own);
  set_scene(*scene, o);
  if (kwargs.contains("layout")) made->layout = kwargs["layout"];
  o.common.quiet = true;  // a bar on a terminal would be printing
  o.watched = true;
  check(o.common);
  made->own.live = made->live();
  if (made->live()) {
    if (depth || !camera.is_none()) throw bad_usage("depth and camera are for sessions without a source");
    check(o);
    check_source(o.source);
    if (made->from_points()) refuse_camera_options(o);
    return made;
  }
  refuse_live_options(o);
  if (made->own.solver && o.rig.layout.empty() && o.rig.rig.empty())
    throw bad_usage("a function as solver goes with layout or rig: without an array, there are no drives");
  check(o.touch);
  if (!depth && !camera.is_none()) throw bad_usage("camera goes with depth=True");
  if (!depth) setup::refuse_finger_width(o.touch, "depth=True");
  made->has_cameras = depth;
  setup::TouchInputOptions images;
  take_cameras(camera, images);
  images.depths.assign(images.cameras.size(), "image");
  cancellable([&] {
    std::vector<sensing::Camera> eyes;
    if (depth && images.cameras.empty()) eyes = setup::load_posed_rig(o.rig).rig.cameras;
    if (!images.cameras.empty()) eyes = setup::load_cameras(images);
    open_frame_by_frame(*made, std::move(eyes));
    return true;
  });
  return made;
}

session::Session& frame_by_frame(SessionObject& o) {
  if (o.live()) throw bad_usage("this session has a source: run() takes its frames; leave source out for touch()");
  return *o.session;
}

std::shared_ptr<TouchObject> touch_frame(SessionObject& o, const py::object& skin, double time,
                                         const py::object& depth) {
  session::Session& session = frame_by_frame(o);
  if (!std::isfinite(time)) throw bad_usage("time: is not finite");
  if (skin.is_none() == depth.is_none()) throw bad_usage("give skin, or depth: one of them");
  if (o.has_cameras == depth.is_none())
    throw bad_usage(o.has_cameras ? "this session takes depth images: give depth"
                                  : "this session takes points: give skin, or make it with depth=True");
  std::vector<sensing::SkinPoint> points;
  std::vector<sensing::DepthFrame> images;
  if (depth.is_none()) {
    refuse_other_frame("skin", skin);
    points = skin_of_frame(o, "skin", skin);
  } else {
    const std::vector<sensing::Camera>& cameras = session.setting().cameras;
    const std::vector<py::object> given = depth_images_of("depth", depth);
    if (given.size() != cameras.size())
      throw bad_usage(fmt::format("depth: give a list of {}, one for each camera", counted(cameras.size(), "array")));
    for (std::size_t i = 0; i < cameras.size(); ++i)
      images.push_back({depths_of("depth", given[i], cameras[i].width, cameras[i].height), time});
  }
  const Turn turn(o);
  std::shared_ptr<TouchObject> made = unlocked([&] {
    const touch::Touch& touch =
        images.empty() ? session.touch(std::span<const sensing::SkinPoint>(points), time) : session.touch(images, time);
    o.events = events_of(session.events(), session.solid_names());
    if (o.nulls) o.nulls->planned(session.plan());
    return std::make_shared<TouchObject>(TouchObject{setup::values_of(session, touch), time, std::nullopt});
  });
  o.own.throw_fault();
  return made;
}

py::object drives_of(SessionObject& o) {
  const session::Session& session = frame_by_frame(o);
  const Turn turn(o);
  const std::size_t transducers = session.setting().layout.transducers.size();
  const session::Plan& plan = session.plan();
  if (transducers == 0 || !plan.cycle.is_listed()) return py::none();
  return of_layout(complex_of(std::span(plan.drives).first(std::size_t{plan.cycle.length} * transducers),
                              {static_cast<py::ssize_t>(plan.cycle.length), static_cast<py::ssize_t>(transducers)}),
                   o.array);
}

// ---- classes --------------------------------------------------------------------------------------------------------

void add_stats(py::module_& m) {
  py::class_<StatsObject, std::shared_ptr<StatsObject>>(m, "RunStats", "What a run measured.")
      .def_property_readonly(
          "frames", [](const StatsObject& o) { return o.stats.captured; }, "int: frames that came from the source.")
      .def_property_readonly(
          "touching", [](const StatsObject& o) { return o.stats.touching; }, "int: frames with at least one finger.")
      .def_property_readonly(
          "replaced", [](const StatsObject& o) { return o.stats.replaced; },
          "int: frames that were left out for newer ones.")
      .def_property_readonly(
          "drives", [](const StatsObject& o) { return o.stats.output.drives; }, "int: drives that the link got.")
      .def_property_readonly(
          "silent_drives", [](const StatsObject& o) { return o.stats.output.silent_drives; }, "int: of these, silent.")
      .def(
          "json", [](const StatsObject& o) { return session::to_json(o.stats); },
          "str: what `palpa run --stats json` prints.")
      .def("__repr__", [](const StatsObject& o) {
        return fmt::format("<palpa.RunStats: {}, {} with a touch>", counted(o.stats.captured, "frame"),
                           o.stats.touching);
      });
}

void add_session_class(py::module_& m) {
  const std::string doc = session_options().documented(session_doc);
  py::class_<SessionObject, SessionPtr>(m, "Session", doc.c_str())
      .def(py::init(&make_session), py::arg("scene").none(false), py::kw_only(), py::arg("camera") = py::none(),
           py::arg("depth") = false, py::arg("nulls") = py::none(), py::arg("null_radius") = py::none())
      .def("touch", &touch_frame, py::arg("skin") = py::none(), py::arg("time") = 0.0, py::kw_only(),
           py::arg("depth") = py::none(), R"(Process the next frame.

Parameters
----------
skin : array_like, shape (n, 3), optional
    Points of the skin, in metres, world.
time : float, optional
    The time of its capture, seconds.
depth : list of ndarray, optional
    Depth images instead, one for each camera, of uint16.

Returns
-------
Touch)")
      .def_property_readonly(
          "events", [](const SessionObject& o) { return o.events; }, "list of Event: of the newest frame of touch().")
      .def(
          "end",
          [](SessionObject& o) {
            session::Session& session = frame_by_frame(o);
            const Turn turn(o);
            return events_of(session.end(), session.solid_names());
          },
          "list of Event: ends the stream of frames; the releases of fingers that still touch.")
      .def_property_readonly("drives", &drives_of,
                             "ndarray of complex128, shape (slots, M), or None: the drives of the newest frame's "
                             "schedule, slot by slot, if the session has a layout. They repeat. They do not include a "
                             "modulation or a texture that all fingers share. None if fingers differ in a texture.")
      .def(
          "push_points", &push_points, py::arg("points"), py::arg("time") = py::none(),
          R"(Give a run with source="points" its next frame. Any thread may call it; it does not wait. The newest frame wins.
It is refused before start() and after the end.

Parameters
----------
points : array_like, shape (n, 3)
    Points of the skin, in metres, world.
time : float, optional
    The time of their capture, seconds. The default is the time since the run began.)")
      .def("set_pose", &set_pose, py::arg("solid"), py::arg("pose"),
           R"(Move a solid for the frames that follow. Any thread may call it during a run; it does not wait.

Parameters
----------
solid : str or int
    Its name or index in the scene.
pose : array_like, shape (4, 4)
    A rigid transform from its place in the scene to its new place.)")
      .def("set_aim", &set_aim, py::arg("offset"),
           "Let foci sound at this offset from where they are seen, from the next frame on.\n\nParameters\n----------\n"
           "offset : array_like, shape (3,)\n    Metres, world.")
      .def("set_gain", &set_gain, py::arg("gain"),
           "Multiply all amplitudes from now on. Any thread may call it during a run; it does not wait.\n\n"
           "Parameters\n----------\ngain : float\n    0 to 1. The pressure that skin feels follows its square.")
      .def("start", &start, py::arg("frames") = 0, py::kw_only(), py::arg("on_frame") = py::none(),
           py::arg("on_event") = py::none(), start_doc)
      .def("wait", &wait_for_end, "Wait for the end of the run, as run() does.\n\nReturns\n-------\nRunStats")
      .def(
          "stop",
          [](SessionObject& o) {
            refuse_fork();
            o.run.stop = true;
          },
          "Let the run end soon, in silence. Any thread may call it; it does not wait.")
      .def(
          "run",
          [](const SessionPtr& o, std::uint64_t frames, const py::object& on_frame, const py::object& on_event) {
            start(o, frames, on_frame, on_event);
            return wait_for_end(o);
          },
          py::arg("frames") = 0, py::kw_only(), py::arg("on_frame") = py::none(), py::arg("on_event") = py::none(),
          run_doc)
      .def_property_readonly(
          "running",
          [](SessionObject& o) {
            refuse_fork();
            const std::lock_guard lock(o.run.mutex);
            return !o.run.over;
          },
          "bool: whether a run is going on.")
      .def("__enter__", [](const SessionPtr& o) { return o; })
      .def("__exit__",
           [](const SessionPtr& o, const py::object& type, const py::object&, const py::object&) {
             if (!o->run.running || !is_own_process()) return;  // in a fork, the run is the parent's
             o->run.stop = true;
             if (type.is_none()) {
               wait_for_end(o);
             } else {
               end_quietly(*o);  // the error of the block counts
             }
           })
      .def("__repr__", [](const SessionObject& o) {
        return shown_text(fmt::format("<palpa.Session of {}{}>", o.scene->name(),
                                      o.live() ? fmt::format(" from {} to {}", o.options.source, o.options.link) : ""));
      });
}

}  // namespace

void add_session(py::module_& m) {
  add_event(m);
  add_stats(m);
  add_session_class(m);
  at_end(&tell_unheard);
}

}  // namespace palpa::python
