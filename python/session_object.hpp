// A session as a Python object, and its live loop.
#pragma once

#include <pybind11/pybind11.h>

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "base/files/outputs.hpp"
#include "layout.hpp"
#include "own.hpp"
#include "running.hpp"
#include "sensing/skin_point.hpp"
#include "session/pushed_points.hpp"
#include "session/session.hpp"
#include "session/watch/events.hpp"
#include "session/watch/stats.hpp"
#include "setup/sessions/live_run.hpp"
#include "setup/sessions/null_watch.hpp"
#include "shapes.hpp"

namespace palpa::python {

namespace py = pybind11;

/// `palpa.Event`.
struct EventObject {
  session::Event event;
  std::string solid;
};

std::vector<EventObject> events_of(std::span<const session::Event> events, const std::vector<std::string>& solids);

/// `palpa.RunStats`.
struct StatsObject {
  session::LoopStats stats;
};

/// What a run shares with the threads that watch and change it.
struct Run {
  std::atomic<bool> stop{false};
  std::atomic<double> ceiling{1};  ///< the option, times what set_gain() asks for
  std::mutex mutex;
  std::condition_variable changed;
  std::vector<std::pair<std::uint32_t, Transform>> poses;  ///< for the next frame
  std::optional<Vec3> aim;
  bool running = false;  ///< nobody has waited for its end yet
  bool over = true;
  bool waited_for = false;                              ///< by a call of wait() or run()
  std::exception_ptr fault;                             ///< of the engine
  std::optional<py::error_already_set> callback_fault;  ///< of a callback, which ended the run
  std::shared_ptr<StatsObject> stats;
  std::vector<Output> written;    ///< by the runs so far
  py::object on_frame, on_event;  ///< only during a run
  std::thread thread;
  std::optional<session::PushedPoints> points;  ///< of a session from points, while it runs
  double begin_s = 0;                           ///< of the run, on the steady clock
};

/// `palpa.Session`.
struct SessionObject {
  std::shared_ptr<const SceneObject> scene;
  setup::LiveOptions options;
  py::object layout;  ///< as it was given: a Layout without a file is known as long as it lives
  bool has_cameras = false;
  std::atomic<bool> knows_size{false};  ///< of its skin, which is looked at once
  std::shared_ptr<LayoutObject> array;  ///< frame by frame, if there is one
  std::unique_ptr<session::Session> session;
  std::optional<setup::NullWatch> nulls;  ///< frame by frame, if there are nulls
  std::vector<EventObject> events;
  std::mutex turn;  ///< of its calls frame by frame; see Turn
  std::atomic<std::thread::id> whose_turn;
  OwnFunctions own;
  Run run;

  bool live() const { return !options.source.empty(); }
  bool from_points() const { return options.source == "points"; }
};

/// Points of a frame, which `name` stands for. Warns once of points in another unit than metres.
std::vector<sensing::SkinPoint> skin_of_frame(SessionObject& session, const std::string& name, const py::object& given);

/// One call at a time. The interpreter's lock is released while this thread waits, because another call may need it for
/// a function of the caller's. Throws bad_usage if such a function calls its own session.
class Turn {
 public:
  explicit Turn(SessionObject& session) : session_(session) {
    if (session.whose_turn == std::this_thread::get_id())
      throw bad_usage("a method or solver cannot call the session that calls it");
    const Unlocked open;
    lock_ = std::unique_lock(session.turn);
    session.whose_turn = std::this_thread::get_id();
  }
  ~Turn() { session_.whose_turn = std::thread::id(); }
  Turn(const Turn&) = delete;
  Turn& operator=(const Turn&) = delete;

 private:
  SessionObject& session_;
  std::unique_lock<std::mutex> lock_;
};

/// Ends the run and destroys the session. If a callback does not return within a second, or if it is the callback that
/// drops the session, the session is left alone: its array is silent.
struct EndingSession {
  void operator()(SessionObject* object) const;
};
using SessionPtr = std::shared_ptr<SessionObject>;

/// Starts the live loop on a thread of its own, and returns.
void start(const SessionPtr& session, std::uint64_t frames, const py::object& on_frame, const py::object& on_event);
/// Waits for its end, and looks for signals meanwhile: the error of a signal's handler ends the run. Throws that error,
/// or that of a callback, or the engine's.
std::shared_ptr<StatsObject> wait_for_end(const SessionPtr& session);
/// Ends the run, and drops its errors. If a callback does not return within a second, the run is left alone.
void end_quietly(SessionObject& session);
/// Tells Python's sys.unraisablehook of the errors of runs that nobody has waited for.
void tell_unheard();
/// For the frames that follow; any thread may call these during a run.
void set_pose(SessionObject& session, const py::object& solid, const py::object& pose);
void set_aim(SessionObject& session, const py::object& offset);
void set_gain(SessionObject& session, double gain);
/// Gives a run from points its next frame. `time` may be None.
void push_points(SessionObject& session, const py::object& points, const py::object& time);

}  // namespace palpa::python
