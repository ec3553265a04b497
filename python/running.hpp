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
#include <utility>

#include "gpu/device.hpp"
#include "setup/options.hpp"

namespace palpa::python {

namespace py = pybind11;

/// Throws failure() in a process that fork() made from the one that imported palpa: threads and the GPU's context do
/// not exist there.
void refuse_fork();
/// Whether this process imported palpa.
bool is_own_process();

/// Releases the interpreter's lock during its lifetime. If the interpreter ends meanwhile, the thread waits for the end
/// of the process instead of running Python code.
class Unlocked {
 public:
  Unlocked();
  ~Unlocked() noexcept(false);
  Unlocked(const Unlocked&) = delete;
  Unlocked& operator=(const Unlocked&) = delete;

 private:
  PyThreadState* state_;
};

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

/// A flag that becomes true when the interpreter ends. The caller then ends its work soon and destroys this object.
class EndsWithInterpreter {
 public:
  explicit EndsWithInterpreter(std::atomic<bool>& stop);
  ~EndsWithInterpreter();
  EndsWithInterpreter(const EndsWithInterpreter&) = delete;
  EndsWithInterpreter& operator=(const EndsWithInterpreter&) = delete;

 private:
  std::atomic<bool>* stop_;
};

/// The device of these options; null for the processor. It is opened once for each choice of device, and stays open
/// until the process ends. Hold `device_turn()` while it computes.
const gpu::Device* device_for(const setup::ComputeOptions& options);
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
