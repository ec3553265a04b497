#include "running.hpp"

#include <cxxabi.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "base/activity.hpp"
#include "base/error.hpp"
#include "base/system/start_thread.hpp"
#include "module.hpp"

namespace palpa::python {
namespace {

using namespace std::chrono_literals;

pid_t importer = 0;
std::thread::id main_thread;

/// How the interpreter's end and the threads outside it find each other.
struct End {
  struct Awaited {
    std::atomic<bool>* stop;
    std::thread::id thread;
  };
  std::mutex mutex;
  std::condition_variable changed;
  bool begun = false;
  bool over = false;              ///< it waits for nobody any more
  int returning = 0;              ///< threads that are about to take the interpreter's lock
  std::vector<Awaited> awaited;   ///< of EndsWithInterpreter
  std::vector<void (*)()> looks;  ///< of at_end()

  /// Whether the calling thread may run Python code.
  bool lets_in() const;
};
End& end() {
  static auto* const instance = new End();  // used until the process ends
  return *instance;
}

/// Whether this thread has an EndsWithInterpreter.
thread_local bool is_awaited = false;

bool End::lets_in() const {
  return std::this_thread::get_id() == main_thread || (is_awaited ? !over : !begun);
}

/// Whether this thread may run Python code. If so, it must call returned() as soon as it has the interpreter's lock.
bool may_return() {
  const std::lock_guard lock(end().mutex);
  if (!end().lets_in()) return false;
  ++end().returning;
  return true;
}

void returned() {
  const std::lock_guard lock(end().mutex);
  --end().returning;
  end().changed.notify_all();
}

/// Waits without the interpreter's lock. Returns whether the end of all work came in time.
bool wait_for_work(std::chrono::steady_clock::time_point until, bool is_last) {
  PyThreadState* const state = PyEval_SaveThread();
  bool ended = false;
  {
    std::unique_lock lock(end().mutex);
    ended = end().changed.wait_until(lock, until, [] { return end().awaited.empty(); });
    if (is_last) {
      end().over = true;
      end().changed.wait(lock, [] { return end().returning == 0; });
    }
  }
  PyEval_RestoreThread(state);
  return ended;
}

/// Work that goes on must not see the end of what exit() destroys.
void leave_without_destructors() {
  on_exit(
      [](int code, void*) {
        std::fflush(nullptr);
        _exit(code);
      },
      nullptr);
}

/// Called by Python's atexit, with the interpreter's lock. From now on, no other thread returns into Python, except
/// those for which it waits. A run is silent after its ramp, which is shorter than this.
void begin_end() {
  if (!is_own_process()) return;
  constexpr auto patience = 300ms, limit = 800ms;
  const auto begin = std::chrono::steady_clock::now();
  for (void (*const look)() : end().looks)
    look();
  {
    const std::lock_guard lock(end().mutex);
    end().begun = true;
    for (const End::Awaited& work : end().awaited)
      *work.stop = true;
  }
  if (!wait_for_work(begin + patience, false)) {
    std::vector<End::Awaited> late;
    {
      const std::lock_guard lock(end().mutex);
      late = end().awaited;
    }
    for (const End::Awaited& work : late)
      interrupt(work.thread, PyExc_SystemExit);
  }
  if (!wait_for_work(begin + limit, true)) leave_without_destructors();
}

}  // namespace

void wait_for_end_of_process() {
  while (true)
    pause();
}

bool is_own_process() {
  return getpid() == importer;
}

bool is_over() {
  const std::lock_guard lock(end().mutex);
  return end().over;
}

void refuse_fork() {
  if (is_own_process()) return;
  throw failure(
      "palpa cannot be used in a process that fork() made: its threads and the GPU stay in the parent; start processes "
      "with multiprocessing.get_context(\"spawn\"), or import palpa only after the fork");
}

void interrupt(std::thread::id thread, PyObject* error) {
  // Python names a thread by its pthread_t, which is what libstdc++ keeps in the id.
  static_assert(sizeof(std::thread::id) == sizeof(unsigned long));
  unsigned long name = 0;
  std::memcpy(&name, &thread, sizeof name);
  PyThreadState_SetAsyncExc(name, error);
}

Unlocked::Unlocked() : state_(PyEval_SaveThread()) {}

Unlocked::~Unlocked() noexcept(false) {
  if (!may_return()) wait_for_end_of_process();
  PyEval_RestoreThread(state_);
  returned();
}

Locked::Locked() : taken_(may_return()) {
  if (!taken_ && !is_awaited) wait_for_end_of_process();
  if (!taken_) return;
  state_ = PyGILState_Ensure();
  returned();
}

Locked::~Locked() {
  if (taken_) PyGILState_Release(state_);
}

namespace {

/// Ends a process that a function of the caller's made with fork() on a thread of a run. The other threads of the run,
/// for which the thread would wait, are not there.
[[noreturn]] void leave_fork(bool returned) {
  int code = 1;
  if (returned) {
    std::fputs("palpa: error: a process that a callback made with fork() cannot return to palpa: end it there\n",
               stderr);
  } else if (PyErr_ExceptionMatches(PyExc_SystemExit)) {
    py::error_already_set fault;
    const py::object asked = fault.value().attr("code");
    if (asked.is_none() || PyLong_Check(asked.ptr())) code = asked.is_none() ? 0 : int(PyLong_AsLong(asked.ptr()));
  } else {
    PyErr_Print();
  }
  for (const char* const stream : {"stdout", "stderr"}) {
    PyObject* const file = PySys_GetObject(stream);
    if (file && !PyObject_CallMethod(file, "flush", nullptr)) PyErr_Clear();
  }
  std::fflush(nullptr);
  _exit(code);
}

}  // namespace

/// The interpreter ends a thread by a forced unwind. It has no object, which the sanitizer would report as a null
/// reference.
__attribute__((no_sanitize("undefined"))) py::object call_python(const py::object& function,
                                                                 const py::tuple& arguments) {
  PyObject* answer = nullptr;
  try {
    answer = PyObject_CallObject(function.ptr(), arguments.ptr());
  } catch (const abi::__forced_unwind&) {
    wait_for_end_of_process();
  }
  if (!is_own_process() && std::this_thread::get_id() != main_thread) leave_fork(answer != nullptr);
  if (!answer) throw py::error_already_set();
  return py::reinterpret_steal<py::object>(answer);
}

KeptThreadState::KeptThreadState() {
  if (!may_return()) return;
  lock_ = PyGILState_Ensure();
  returned();
  state_ = PyEval_SaveThread();
}

KeptThreadState::~KeptThreadState() {
  if (!lock_ || !may_return()) return;
  PyEval_RestoreThread(state_);
  returned();
  PyGILState_Release(*lock_);
}

void run_beside(std::atomic<bool>& stop, const std::function<void()>& work) {
  refuse_fork();
  std::mutex mutex;
  std::condition_variable ended;
  bool over = false;
  std::exception_ptr fault;
  std::thread thread = start_thread("python", [&] {
    try {
      // It ends here, because the waiting thread may not return if the interpreter ends.
      const EndsWithInterpreter ends(stop);
      work();
    } catch (...) {
      fault = std::current_exception();
    }
    const std::lock_guard lock(mutex);
    over = true;
    ended.notify_all();
  });
  const auto wait = [&](std::optional<std::chrono::milliseconds> at_most) {
    const Unlocked open;
    std::unique_lock lock(mutex);
    if (at_most) return ended.wait_for(lock, *at_most, [&] { return over; });
    ended.wait(lock, [&] { return over; });
    return true;
  };
  constexpr std::chrono::milliseconds between_looks{20};
  bool interrupted = false;
  while (!wait(between_looks)) {
    if (PyErr_CheckSignals() == 0) continue;
    interrupted = true;
    break;
  }
  if (interrupted) {
    PyObject *type = nullptr, *value = nullptr, *trace = nullptr;
    PyErr_Fetch(&type, &value, &trace);  // callbacks still run Python code
    stop = true;
    wait(std::nullopt);
    PyErr_Restore(type, value, trace);
  }
  thread.join();
  if (interrupted) throw py::error_already_set();
  if (fault) std::rethrow_exception(fault);
}

void run_cancellable(const std::function<void()>& work) {
  std::atomic<bool> stop{false};
  run_beside(stop, [&] {
    const Cancellable cancellable(stop);
    work();
  });
}

EndsWithInterpreter::EndsWithInterpreter(std::atomic<bool>& stop) : stop_(&stop) {
  is_awaited = true;
  const std::lock_guard lock(end().mutex);
  if (end().begun) stop = true;
  end().awaited.push_back({&stop, std::this_thread::get_id()});
}

EndsWithInterpreter::~EndsWithInterpreter() {
  {
    const std::lock_guard lock(end().mutex);
    std::erase_if(end().awaited, [this](const End::Awaited& work) { return work.stop == stop_; });
    end().changed.notify_all();
  }
  is_awaited = false;
}

void at_end(void (*look)()) {
  end().looks.push_back(look);
}

std::mutex& device_turn() {
  static auto* const mutex = new std::mutex();
  return *mutex;
}

void add_running(py::module_& m) {
  importer = getpid();
  main_thread = std::this_thread::get_id();
  py::module_::import("atexit").attr("register")(py::cpp_function(begin_end));
  m.def("_end", begin_end);
}

}  // namespace palpa::python
