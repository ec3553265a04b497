#include "running.hpp"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <map>
#include <optional>
#include <string>
#include <thread>
#include <tuple>
#include <vector>

#include "base/activity.hpp"
#include "base/error.hpp"
#include "base/start_thread.hpp"
#include "module.hpp"

namespace palpa::python {
namespace {

pid_t importer = 0;

/// How the interpreter's end and the threads outside it find each other.
struct End {
  std::mutex mutex;
  std::condition_variable changed;
  bool begun = false;
  int returning = 0;                      ///< threads that are about to take the interpreter's lock
  std::vector<std::atomic<bool>*> flags;  ///< of EndsWithInterpreter
};
End& end() {
  static auto* const instance = new End();  // used until the process ends
  return *instance;
}

std::thread::id main_thread;

/// Called by Python's atexit, with the interpreter's lock. From now on, no other thread returns into Python.
void begin_end() {
  if (!is_own_process()) return;
  PyThreadState* const state = PyEval_SaveThread();
  {
    std::unique_lock lock(end().mutex);
    end().begun = true;
    for (std::atomic<bool>* const flag : end().flags)
      *flag = true;
    end().changed.wait(lock, [] { return end().flags.empty() && end().returning == 0; });
  }
  PyEval_RestoreThread(state);
}

[[noreturn]] void wait_for_end_of_process() {
  while (true)
    pause();
}

}  // namespace

bool is_own_process() {
  return getpid() == importer;
}

void refuse_fork() {
  if (is_own_process()) return;
  throw failure(
      "palpa cannot be used in a process that fork() made: its threads and the GPU stay in the parent; start processes "
      "with multiprocessing.get_context(\"spawn\"), or import palpa only after the fork");
}

Unlocked::Unlocked() : state_(PyEval_SaveThread()) {}

Unlocked::~Unlocked() noexcept(false) {
  {
    const std::lock_guard lock(end().mutex);
    ++end().returning;
    if (end().begun && std::this_thread::get_id() != main_thread) {
      --end().returning;
      end().changed.notify_all();
      end().mutex.unlock();
      wait_for_end_of_process();
    }
  }
  PyEval_RestoreThread(state_);
  const std::lock_guard lock(end().mutex);
  --end().returning;
  end().changed.notify_all();
}

void run_beside(std::atomic<bool>& stop, const std::function<void()>& work) {
  refuse_fork();
  std::mutex mutex;
  std::condition_variable ended;
  bool over = false;
  std::exception_ptr fault;
  std::optional<EndsWithInterpreter> ends(std::in_place, stop);
  std::thread thread = start_thread("python", [&] {
    try {
      work();
    } catch (...) {
      fault = std::current_exception();
    }
    ends.reset();  // here, because the waiting thread may not return if the interpreter ends
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
  const std::lock_guard lock(end().mutex);
  if (end().begun) stop = true;
  end().flags.push_back(&stop);
}

EndsWithInterpreter::~EndsWithInterpreter() {
  const std::lock_guard lock(end().mutex);
  std::erase(end().flags, stop_);
  end().changed.notify_all();
}

std::mutex& device_turn() {
  static auto* const mutex = new std::mutex();
  return *mutex;
}

const gpu::Device* device_for(const setup::ComputeOptions& options) {
  if (options.backend == setup::Backend::cpu) return nullptr;
  static auto* const devices =
      new std::map<std::pair<std::string, std::optional<gpu::Validation>>, std::unique_ptr<gpu::Device>>();
  const std::lock_guard turn(device_turn());
  std::unique_ptr<gpu::Device>& device = (*devices)[{options.gpu, options.validation}];
  if (!device) device = std::make_unique<gpu::Device>(setup::device_options(options));
  return device.get();
}

void add_running(py::module_& m) {
  importer = getpid();
  main_thread = std::this_thread::get_id();
  py::module_::import("atexit").attr("register")(py::cpp_function(begin_end));
  m.def("_end", begin_end);
}

}  // namespace palpa::python
