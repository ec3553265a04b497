// Calls of the engine without the interpreter's lock (the GIL). Ctrl-C can interrupt them, they are refused after
// fork(), and they end before the interpreter does.
#pragma once

#include <pybind11/pybind11.h>

#include <atomic>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "gpu/device.hpp"
#include "setup/options/options.hpp"

namespace palpa::python {

namespace py = pybind11;

/// Throws failure() in a process that fork() made from the one that imported palpa: threads and the GPU's context do
/// not exist there.
void refuse_fork();
/// Whether this process imported palpa.
bool is_own_process();
/// Whether the interpreter ends, and no longer waits for the threads of EndsWithInterpreter.
bool is_over();
[[noreturn]] void wait_for_end_of_process();
/// Raises `error` in the Python code that this thread runs, or will run. Needs the interpreter's lock.
void interrupt(std::thread::id thread, PyObject* error);

/// Releases the interpreter's lock during its lifetime. If the interpreter ends meanwhile, the thread waits for the end
/// of the process instead of running Python code, unless the interpreter waits for it (EndsWithInterpreter).
class Unlocked {
 public:
  Unlocked();
  ~Unlocked() noexcept(false);
  Unlocked(const Unlocked&) = delete;
  Unlocked& operator=(const Unlocked&) = delete;

 private:
  PyThreadState* state_;
};

/// Takes the interpreter's lock during its lifetime, on a thread that may belong to the engine. It is not taken once
/// the interpreter has stopped waiting for this thread; run no Python code then. A thread for which it never waits gets
/// no further.
class Locked {
 public:
  Locked();
  ~Locked();
  Locked(const Locked&) = delete;
  Locked& operator=(const Locked&) = delete;
  explicit operator bool() const { return taken_; }

 private:
  bool taken_;
  PyGILState_STATE state_{};
};

/// Keeps the state that this thread has in the interpreter. Otherwise each callback would make one and delete it. A
/// fork() of another thread at that moment hangs in CPython 3.11.
class KeptThreadState {
 public:
  KeptThreadState();
  ~KeptThreadState();
  KeptThreadState(const KeptThreadState&) = delete;
  KeptThreadState& operator=(const KeptThreadState&) = delete;

 private:
  std::optional<PyGILState_STATE> lock_;
  PyThreadState* state_ = nullptr;
};

/// Calls a function of the caller's, on any thread that has the interpreter's lock. If the interpreter ends the thread
/// meanwhile, it waits here for the end of the process: it must not unwind the engine's code, and without the lock, it
/// must not drop an object of Python's. A process that the function forked on a thread of the engine's ends here, too.
py::object call_python(const py::object& function, const py::tuple& arguments);

/// Calls `work` without the interpreter's lock.
template <typename Work>
auto unlocked(Work&& work) {
  refuse_fork();
  const Unlocked open;
  return std::forward<Work>(work)();
}

/// Calls `work` on another thread, and looks for signals meanwhile. If a signal's handler raises (Ctrl-C raises
/// KeyboardInterrupt), sets `stop`, waits for the end of `work`, and throws the handler's error. Otherwise throws what
/// `work` throws.
void run_beside(std::atomic<bool>& stop, const std::function<void()>& work);

/// The same for a computation with a result. A signal ends it at its next Activity (base/activity.hpp).
void run_cancellable(const std::function<void()>& work);
template <typename Work>
auto cancellable(Work&& work) {
  std::optional<decltype(work())> result;
  run_cancellable([&] { result.emplace(work()); });
  return std::move(*result);
}

/// Calls `look` when the interpreter begins to end, with its lock.
void at_end(void (*look)());

/// Work of the thread that makes this object, and that must destroy it. When the interpreter ends, `stop` becomes true,
/// and the interpreter waits for the end of this object, but less than a second. Meanwhile the thread may run Python
/// code. Code that does not return by itself is interrupted with SystemExit.
class EndsWithInterpreter {
 public:
  explicit EndsWithInterpreter(std::atomic<bool>& stop);
  ~EndsWithInterpreter();
  EndsWithInterpreter(const EndsWithInterpreter&) = delete;
  EndsWithInterpreter& operator=(const EndsWithInterpreter&) = delete;

 private:
  std::atomic<bool>* stop_;
};

/// Hold it while a setup::kept_device() computes a drive or a field.
std::mutex& device_turn();

/// Deletes an object of the engine without the interpreter's lock. In a forked process, the object is left alone.
template <typename T>
struct Ending {
  void operator()(T* object) const {
    if (is_own_process()) delete object;
  }
};
template <typename T>
std::shared_ptr<T> owned(T&& value) {
  return std::shared_ptr<T>(new T(std::move(value)), Ending<T>());
}

}  // namespace palpa::python
