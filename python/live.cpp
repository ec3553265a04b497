#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <functional>
#include <glm/common.hpp>
#include <glm/vector_relational.hpp>
#include <set>

#include "base/activity.hpp"
#include "base/error.hpp"
#include "base/files/outputs.hpp"
#include "base/log.hpp"
#include "base/system/start_thread.hpp"
#include "driver/links.hpp"
#include "driver/sources.hpp"
#include "module.hpp"
#include "session/control/osc.hpp"
#include "session/plan/voice.hpp"
#include "session_object.hpp"
#include "setup/options/warnings.hpp"
#include "setup/sessions/load.hpp"
#include "setup/sessions/null_watch.hpp"
#include "setup/sessions/session_setting.hpp"
#include "setup/sessions/touch_input.hpp"
#include "setup/tasks/calibrate.hpp"
#include "setup/tasks/touch.hpp"
#include "touch_object.hpp"
#include "values/arrays.hpp"
#include "values/placed.hpp"

namespace palpa::python {

std::vector<sensing::SkinPoint> skin_of_frame(SessionObject& o, const std::string& name, const py::object& given) {
  const std::vector<Vec3> positions = points_of(name, given);
  if (!o.knows_size) o.knows_size = setup::warn_of_skin(name + ":", positions);
  return setup::skin_points(name, positions).points;
}

std::vector<EventObject> events_of(std::span<const session::Event> events, const std::vector<std::string>& solids) {
  std::vector<EventObject> made;
  for (const session::Event& event : events)
    made.push_back({event, solids[event.solid]});
  return made;
}

namespace {

/// A live frame. `own`: the foci are a caller's, and stand only in the voices.
std::shared_ptr<TouchObject> frame_of(const session::FrameReport& report, const session::Plan& plan,
                                      const std::vector<std::string>& solids, const array::Voice& common, bool own) {
  const touch::Touch& touch = *report.touch;
  auto made = std::make_shared<TouchObject>();
  setup::TouchValues& values = made->values;
  values.touch.contacts = touch.contacts;
  values.touch.fingers.assign(touch.fingers.begin(), touch.fingers.begin() + touch.finger_count);
  values.touch.finger_count = touch.finger_count;
  values.touch.cluster_count = touch.cluster_count;
  values.schedule = session::by_finger(plan.schedule, touch);
  values.common = common;
  values.solids = solids;
  for (const touch::Finger& finger : values.touch.fingers) {
    session::ScheduledFinger& scheduled = values.fingers.emplace_back();
    scheduled.placement.foci = finger.foci;
    scheduled.placement.complete = finger.placed;
    if (own) {
      scheduled.placement.foci.clear();
      for (const Vec3& focus : values.schedule.voices[values.fingers.size() - 1].foci)
        scheduled.placement.foci.push_back({.position = glm::vec3(focus), .points = 1});
    }
    values.own_schedule.push_back(own);
  }
  for (const gpu::PassTime& pass : report.passes)
    values.times.emplace_back(pass.name, pass.ms);
  values.total_ms = 1e3 * (report.planned_s - report.arrived_s);
  made->time_s = report.time_s;
  return made;
}

/// False, also NumPy's.
bool is_false(const py::object& answer) {
  return is_flag(answer) && PyObject_Not(answer.ptr()) == 1;
}

/// Calls a callback with the interpreter's lock. Its exception ends the run at once, as an error; the answer False ends
/// it with the ramp.
template <typename Make>
void call_back(SessionObject& o, const py::object& callback, const Make& argument) {
  Run& run = o.run;
  {
    const Locked locked;
    if (!locked || run.callback_fault) return;
    const OwnFunctions::Called called(o.own);
    try {
      if (is_false(call_python(callback, py::make_tuple(argument())))) run.stop = true;
      return;
    } catch (py::error_already_set& error) {
      run.callback_fault.emplace(error);
    }
  }
  throw failure("a callback failed");
}

void change_solids(Run& run, session::Session& session) {
  const std::lock_guard lock(run.mutex);
  for (const auto& [solid, pose] : run.poses)
    session.set_pose(solid, pose);
  run.poses.clear();
  if (run.aim) session.set_aim(*std::exchange(run.aim, std::nullopt));
}

/// Loads everything. False: the run was stopped before it began.
bool open(const setup::LiveOptions& options, std::span<const session::SourceKind> sources,
          std::span<const session::LinkKind> links, std::atomic<bool>& stop, std::optional<setup::LiveRun>& live) {
  const Cancellable cancellable(stop);
  try {
    live.emplace(options, sources, links, stop);
  } catch (const Error&) {
    if (!stop) throw;
    return false;
  }
  return true;
}

/// Nobody is called back from here on.
void drop_callbacks(Run& run) {
  const Locked locked;
  for (py::object* const callback : {&run.on_frame, &run.on_event}) {
    if (locked) {
      *callback = py::object();
    } else {
      callback->release();  // the interpreter is gone
    }
  }
}

/// Calls the caller's functions for this session.
class Callbacks final : public session::RunObserver {
 public:
  Callbacks(SessionObject& o, session::Session& session) : o_(o), session_(session) {}

  void planned(const session::FrameReport& report, const session::Plan& plan) override {
    if (!o_.run.on_frame) return;
    call_back(o_, o_.run.on_frame, [&] {
      return frame_of(report, plan, session_.solid_names(), session_.scheduler().common_voice(), bool{o_.own.method});
    });
  }
  void events(std::span<const session::Event> events) override {
    if (!o_.run.on_event) return;
    for (EventObject& event : events_of(events, session_.solid_names()))
      call_back(o_, o_.run.on_event, [&] { return std::move(event); });
  }

 private:
  SessionObject& o_;
  session::Session& session_;
};

void open_and_play(SessionObject& o, const setup::LiveOptions& options) {
  Run& run = o.run;
  const std::vector<session::LinkKind> links = setup::with_builtin(driver::links());
  const Outputs outputs(setup::outputs_of(options, links));
  refuse_output_as_input(o.scene->source);  // it was read when the Scene was made
  const std::vector<session::SourceKind> sources = driver::camera_sources();
  std::optional<setup::LiveRun> live;
  if (!open(options, sources, links, run.stop, live)) return;
  run.written = setup::outputs_of(options, links);
  Callbacks callbacks(o, live->session());
  run.stats = std::make_shared<StatsObject>(
      StatsObject{live->run(callbacks, {}, [&run](session::Session& session) { change_solids(run, session); })});
}

/// The whole of a run, on its own thread.
void play(SessionObject& o, const setup::LiveOptions& options) {
  Run& run = o.run;
  std::exception_ptr fault;
  {
    const EndsWithInterpreter ends(run.stop);
    const KeptThreadState kept;
    try {
      open_and_play(o, options);
    } catch (...) {
      fault = std::current_exception();
    }
    drop_callbacks(run);
  }
  const std::lock_guard lock(run.mutex);
  if (!run.stats) run.stats = std::make_shared<StatsObject>();
  run.fault = fault;
  run.over = true;
  run.changed.notify_all();
}

/// The next run would replace what an earlier one wrote, and nobody asked for that.
void refuse_written(const Run& run) {
  for (const Output& output : run.written) {
    std::error_code fault;
    if (output.kind != Output::Kind::file || output.target == "-" ||
        !std::filesystem::is_regular_file(output.target, fault))
      continue;
    throw bad_usage(
        fmt::format("{}: an earlier run of this session wrote {}, which the next run would replace: make a "
                    "new Session with another file, or delete this one",
                    output.option, output.target));
  }
}

double steady_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Sessions whose runs nobody has waited for; guarded by the interpreter's lock.
std::set<SessionObject*>& unheard() {
  static auto* const all = new std::set<SessionObject*>();
  return *all;
}

/// Throws what ended the run, and forgets it.
void throw_faults(SessionObject& o) {
  Run& run = o.run;
  const std::exception_ptr consequence = std::exchange(run.fault, nullptr);
  if (run.callback_fault) {
    py::error_already_set fault(std::move(*run.callback_fault));
    run.callback_fault.reset();
    throw fault;
  }
  o.own.throw_fault();
  if (consequence) std::rethrow_exception(consequence);
}

void tell_unheard_of(SessionObject& o) {
  if (unheard().erase(&o) == 0) return;
  const py::error_scope other;  // a session may be destroyed while an error is on its way
  try {
    throw_faults(o);
    return;
  } catch (py::error_already_set& error) {
    error.restore();
  } catch (const Error& error) {
    raise(error);
  } catch (const std::exception& error) {
    PyErr_SetString(PyExc_RuntimeError, error.what());
  }
  PyErr_WriteUnraisable(py::str("the run of a palpa.Session, whose end nobody has waited for").ptr());
}

/// Waits for the end of a run that was stopped. False if it does not come, because a callback does not return.
bool wait_for_callback(SessionObject& o) {
  constexpr double patience_s = 1;
  Run& run = o.run;
  if (run.thread.get_id() == std::this_thread::get_id()) return false;
  const Unlocked open;
  std::unique_lock lock(run.mutex);
  while (!run.changed.wait_for(lock, std::chrono::milliseconds(50), [&] { return run.over; })) {
    const double called_s = o.own.called_s;
    if (is_over() || (called_s != 0 && steady_s() - called_s > patience_s)) return false;
  }
  lock.unlock();
  run.thread.join();
  return true;
}

py::object callback_of(const char* name, const py::object& given) {
  if (given.is_none()) return {};
  if (!PyCallable_Check(given.ptr())) throw bad_usage(fmt::format("{}: give a function", name));
  return given;
}

}  // namespace

void EndingSession::operator()(SessionObject* object) const {
  if (!is_own_process()) return;
  object->run.stop = true;
  if (object->run.thread.joinable() && !wait_for_callback(*object)) {
    unheard().erase(object);
    return;
  }
  tell_unheard_of(*object);
  delete object;
}

void end_quietly(SessionObject& o) {
  refuse_fork();
  o.run.stop = true;
  if (!wait_for_callback(o)) return;
  o.run.running = false;
  unheard().erase(&o);
}

void tell_unheard() {
  const std::set<SessionObject*> all = unheard();
  for (SessionObject* const session : all) {
    bool over = false;
    {
      const std::lock_guard lock(session->run.mutex);
      over = session->run.over;
    }
    if (over) tell_unheard_of(*session);
  }
}

void push_points(SessionObject& o, const py::object& points, const py::object& time) {
  if (!o.from_points()) throw bad_usage("push_points is for sessions with source=\"points\"");
  Run& run = o.run;
  if (!run.running || !run.points) throw bad_usage("the session does not run: call start() first");
  session::PushedPoints to = *run.points;  // another thread may start the next run meanwhile
  double time_s = steady_s() - run.begin_s;
  if (!time.is_none()) {
    const std::vector<double> given = numbers_of("time", time);
    if (given.size() != 1) throw bad_usage("time: give one number, in seconds");
    time_s = given[0];
  }
  refuse_other_frame("points", points);
  to.push(skin_of_frame(o, "points", points), time_s);
}

void start(const SessionPtr& o, std::uint64_t frames, const py::object& on_frame, const py::object& on_event) {
  refuse_fork();
  Run& run = o->run;
  if (!o->live()) throw bad_usage("source is missing: a session without one works frame by frame, with touch()");
  if (run.running) throw bad_usage("the session already runs: wait for its end with wait() or stop()");
  refuse_written(run);
  setup::LiveOptions options = o->options;
  options.frames = frames;
  options.safety.ceiling_now = &run.ceiling;
  run.on_frame = callback_of("on_frame", on_frame);
  run.on_event = callback_of("on_event", on_event);
  if (o->from_points()) options.points = run.points.emplace();
  run.begin_s = steady_s();
  run.stop = false;
  run.over = false;
  run.fault = nullptr;
  o->own.fault = nullptr;
  run.callback_fault.reset();
  run.stats.reset();
  SessionObject* const session = o.get();  // its destructor waits for the thread
  run.thread = start_thread("the session", [session, options] { play(*session, options); });
  run.running = true;
  unheard().insert(session);
}

/// Waits for the end, and looks for signals meanwhile: the error of a signal's handler ends the run.
std::shared_ptr<StatsObject> wait_for_end(const SessionPtr& o) {
  refuse_fork();
  Run& run = o->run;
  if (!run.running) throw bad_usage("the session does not run");
  // Callbacks are called by the run's thread, which cannot wait for its own end.
  if (std::this_thread::get_id() == run.thread.get_id())
    throw bad_usage("wait: a callback cannot wait for the end of its own run; stop() ends it");
  if (run.waited_for) throw bad_usage("wait: another thread waits for the end of this run");
  run.waited_for = true;
  std::optional<py::error_already_set> interrupted;
  const auto is_over = [&](std::chrono::milliseconds at_most) {
    const Unlocked open;
    std::unique_lock lock(run.mutex);
    return run.changed.wait_for(lock, at_most, [&] { return run.over; });
  };
  while (!is_over(std::chrono::milliseconds(20))) {
    if (PyErr_CheckSignals() == 0) continue;
    if (interrupted) {
      // A callback does not return. Its Python code is interrupted, too. If it waits elsewhere, it is left alone.
      PyErr_Clear();
      interrupt(run.thread.get_id(), PyExc_KeyboardInterrupt);
      if (is_over(std::chrono::milliseconds(500))) break;
      run.waited_for = false;
      throw py::error_already_set(std::move(*interrupted));
    }
    interrupted.emplace();
    run.stop = true;
  }
  {
    const Unlocked open;
    run.thread.join();
  }
  run.running = run.waited_for = false;
  unheard().erase(o.get());
  if (interrupted) throw py::error_already_set(std::move(*interrupted));
  throw_faults(*o);
  return run.stats;
}

void set_pose(SessionObject& o, const py::object& solid, const py::object& pose) {
  refuse_fork();  // the run's thread may have the mutex when fork() comes
  const auto index = static_cast<std::uint32_t>(solid_index(*o.scene, solid));
  const Transform transform = transform_of("pose", pose);
  if (!o.live()) {
    const Turn turn(o);
    return o.session->set_pose(index, transform);
  }
  const std::lock_guard lock(o.run.mutex);
  std::erase_if(o.run.poses, [&](const auto& other) { return other.first == index; });
  o.run.poses.emplace_back(index, transform);
}

void set_aim(SessionObject& o, const py::object& offset) {
  refuse_fork();
  const Vec3 by = point_of("offset", offset);
  if (glm::any(glm::greaterThan(glm::abs(by), Vec3(setup::farthest_nudge_m)))) {
    log::warning(
        fmt::format("offset: {:g}, {:g}, {:g} m is far: foci sound that far from the skin; more than {:g} m "
                    "along an axis is no nudge of a rig",
                    by.x, by.y, by.z, setup::farthest_nudge_m));
  }
  if (!o.live()) {
    const Turn turn(o);
    return o.session->set_aim(by);
  }
  const std::lock_guard lock(o.run.mutex);
  o.run.aim = by;
}

void set_gain(SessionObject& o, double gain) {
  refuse_fork();
  if (!o.live()) throw bad_usage("set_gain is for sessions with a source: it changes the sound of a link");
  if (!(gain >= 0 && gain <= 1)) throw bad_usage(fmt::format("gain: {} is not within 0 to 1", gain));
  o.run.ceiling = o.options.safety.ceiling * gain;
}

}  // namespace palpa::python
