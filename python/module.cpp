#include "module.hpp"

#include <fmt/format.h>
#include <pybind11/stl.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "base/activity.hpp"
#include "base/error.hpp"
#include "base/log.hpp"
#include "base/start_thread.hpp"
#include "base/text.hpp"
#include "base/words.hpp"
#include "running.hpp"
#include "setup/asset_folder.hpp"

namespace palpa::python {

// ---- errors ---------------------------------------------------------------------------------------------------------

namespace {

/// The classes live as long as the process.
struct Classes {
  PyObject *error = nullptr, *bad_input = nullptr, *bad_usage = nullptr, *no_device = nullptr;
} classes;

PyObject* new_class(py::module_& m, const char* name, const char* doc, const py::tuple& bases) {
  const py::dict members;
  members["__module__"] = "palpa";
  members["file"] = py::none();
  const std::string full = std::string("palpa.") + name;
  PyObject* const made = PyErr_NewExceptionWithDoc(full.c_str(), doc, bases.ptr(), members.ptr());
  if (!made) throw py::error_already_set();
  m.attr(name) = py::handle(made);
  return made;
}

/// The file of a message "FILE: fault" or "FILE: line 3: fault". A name may itself contain ": ", so the longest
/// beginning that exists is taken.
std::string file_in(const std::string& message) {
  std::string first;
  for (std::size_t at = message.find(": "); at != std::string::npos; at = message.find(": ", at + 1)) {
    std::string name = message.substr(0, at);
    std::error_code ignored;
    if (first.empty()) first = name;
    if (std::filesystem::exists(name, ignored)) return name;
  }
  return first;
}

PyObject* class_of(Exit code) {
  switch (code) {
    case Exit::usage:
      return classes.bad_usage;
    case Exit::no_device:
      return classes.no_device;
    case Exit::bad_input:
      return classes.bad_input;
    case Exit::ok:
    case Exit::failed:
      break;
  }
  return classes.error;
}

void raise(const Error& error) {
  const std::string message = error.what();
  const py::object value = py::reinterpret_steal<py::object>(
      PyObject_CallFunctionObjArgs(class_of(error.code()), shown_text(message).ptr(), nullptr));
  if (!value) return;  // Python has set an error of its own
  if (error.code() == Exit::bad_input) value.attr("file") = shown_text(file_in(message));
  value.attr("exit_code") = static_cast<int>(error.code());
  PyErr_SetObject(class_of(error.code()), value.ptr());
}

}  // namespace

void add_errors(py::module_& m) {
  const py::object exception = py::reinterpret_borrow<py::object>(PyExc_Exception);
  classes.error = new_class(m, "Error",
                            "Any failure of palpa. The message is the line that the command line would print.\n\n"
                            "Attributes\n----------\nfile : str or None\n    The file at fault, of a BadInput.\n"
                            "exit_code : int\n    The exit code of the command line: 1, 2, 3 or 4.",
                            py::make_tuple(exception));
  const py::handle error(classes.error);
  classes.bad_input = new_class(m, "BadInput", "A missing, broken or implausible file or array; exit code 4.",
                                py::make_tuple(error, py::handle(PyExc_ValueError)));
  classes.bad_usage = new_class(m, "BadUsage", "Arguments that cannot be used; exit code 2.",
                                py::make_tuple(error, py::handle(PyExc_ValueError)));
  classes.no_device = new_class(m, "NoDevice", "No usable Vulkan device; exit code 3.",
                                py::make_tuple(error, py::handle(PyExc_RuntimeError)));
  // NOLINTNEXTLINE(performance-unnecessary-value-param): the type that pybind11 takes
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const Error& e) {
      raise(e);
    } catch (const py::cast_error&) {
      PyErr_SetString(PyExc_TypeError, "an argument has a type that cannot be used here; help() says what it takes");
    }
  });
}

py::str shown_text(const std::string& text) {
  PyObject* const made = PyUnicode_DecodeUTF8(text.data(), static_cast<py::ssize_t>(text.size()), "surrogateescape");
  if (!made) throw py::error_already_set();
  return py::reinterpret_steal<py::str>(made);
}

std::string bytes_of(const std::string& name, py::handle text) {
  const py::object made = py::reinterpret_steal<py::object>(PyUnicode_EncodeFSDefault(text.ptr()));
  if (!made) {
    PyErr_Clear();
    throw bad_usage(fmt::format("{}: the text has a character that is no Unicode", name));
  }
  std::string bytes(PyBytes_AS_STRING(made.ptr()), static_cast<std::size_t>(PyBytes_GET_SIZE(made.ptr())));
  if (bytes.find('\0') != std::string::npos) throw bad_usage(fmt::format("{}: the text has a zero character", name));
  return bytes;
}

namespace {

/// Called instead of the allocation that pybind11 makes for an object that has no value, such as one that was made by
/// __new__ alone: its members would read memory without a value.
void* refuse_empty_object(std::size_t) {
  throw py::type_error("the object has no value: it was made by __new__ without __init__; call its class instead");
}

/// pybind11's, which calls every function of the module. For arguments that do not fit, it writes a message with all of
/// them, and throws where Python cannot write one of them (such as a number of 5000 digits).
PyCFunctionWithKeywords dispatcher = nullptr;

PyObject* call_guarded(PyObject* self, PyObject* arguments, PyObject* keywords) {
  try {
    return dispatcher(self, arguments, keywords);
  } catch (const std::exception&) {
    PyErr_SetString(PyExc_TypeError, "the arguments do not fit; help() says what the function takes");
    return nullptr;
  }
}

void guard_function(PyObject* function) {
  if (PyInstanceMethod_Check(function)) function = PyInstanceMethod_GET_FUNCTION(function);
  if (!PyCFunction_Check(function)) return;
  PyMethodDef& definition = *reinterpret_cast<PyCFunctionObject*>(function)->m_ml;
  if ((definition.ml_flags & METH_KEYWORDS) == 0) return;
  const auto plain = [](auto* pointer) { return reinterpret_cast<void (*)()>(pointer); };
  if (!dispatcher) dispatcher = reinterpret_cast<PyCFunctionWithKeywords>(plain(definition.ml_meth));
  if (plain(definition.ml_meth) == plain(dispatcher))
    definition.ml_meth = reinterpret_cast<PyCFunction>(plain(call_guarded));
}

}  // namespace

void guard(const py::module_& m) {
  for (const auto& [name, value] : py::reinterpret_borrow<py::dict>(m.attr("__dict__"))) {
    guard_function(value.ptr());
    if (!PyType_Check(value.ptr())) continue;
    auto* const info = py::detail::get_type_info(reinterpret_cast<PyTypeObject*>(value.ptr()));
    if (!info) continue;
    info->operator_new = refuse_empty_object;
    for (const auto& [member, function] : py::reinterpret_steal<py::dict>(PyDict_Copy(info->type->tp_dict)))
      guard_function(function.ptr());
  }
}

// ---- the interpreter beside the engine ------------------------------------------------------------------------------
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

// ---- messages -------------------------------------------------------------------------------------------------------

namespace {

/// Keeps the newest lines of the log. It is never destroyed, because threads may log until the process ends.
log::Tail& tail() {
  static auto* const kept = new log::Tail();
  return *kept;
}

log::Level level_of(const std::string& word) {
  std::string known;
  for (const auto& entry : log::level_words) {
    if (word == entry.word) return entry.value;
    known += (known.empty() ? "" : ", ") + std::string(entry.word);
  }
  throw bad_usage(fmt::format("level: '{}' is no log level; the levels are {}", printable(word, 60), known));
}

void add_log(py::module_& m) {
  // A module must not write on stderr by itself. The lines are kept instead.
  log::set_level(log::Level::quiet);
  tail();
  m.def(
      "set_log_level", [](const std::string& level) { log::set_level(level_of(level)); }, py::arg("level"),
      R"(Set which messages are printed on stderr.

Parameters
----------
level : {"quiet", "error", "warning", "info", "debug"}
    The least important messages that are printed. The module begins with "quiet": it prints nothing.)");
  m.def(
      "messages",
      [] {
        py::list lines;
        for (const log::Line& line : tail().take())
          lines.append(py::make_tuple(std::string(word_of(log::level_words, line.level)), shown_text(line.text)));
        return lines;
      },
      R"(Take the messages since the last call, such as warnings of unusual values.

Returns
-------
list of (str, str)
    Level and text of each message, oldest first; at most the newest 500.)");
}

}  // namespace
}  // namespace palpa::python

PYBIND11_MODULE(_engine, m) {
  using namespace palpa::python;
  m.attr("__version__") = PALPA_VERSION;
  pybind11::options options;
  options.disable_enum_members_docstring();
  m.def(
      "_use_assets", [](pybind11::handle folder) { palpa::setup::set_asset_folder(bytes_of("folder", folder)); },
      "Look for palpa's own models and rigs in this folder.");
  add_errors(m);
  add_running(m);
  add_log(m);
  add_options(m);
  add_shapes(m);
  add_touch(m);
  add_layout(m);
  add_bodies(m);
  add_tasks(m);
  add_session(m);
  add_sweeps(m);
  guard(m);
}
