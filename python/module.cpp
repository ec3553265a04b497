#include "module.hpp"

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <deque>
#include <exception>
#include <filesystem>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "base/files/input_file.hpp"
#include "base/log.hpp"
#include "base/text.hpp"
#include "base/version.hpp"
#include "base/words.hpp"
#include "driver/guard/process.hpp"
#include "running.hpp"
#include "session/links/board_sound.hpp"
#include "setup/files/assets.hpp"

namespace palpa::python {

// ---- errors ---------------------------------------------------------------------------------------------------------

namespace {

/// The classes live as long as the process.
struct Classes {
  PyObject *warning = nullptr, *error = nullptr, *bad_input = nullptr, *bad_usage = nullptr, *no_device = nullptr;
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

}  // namespace

void raise(const Error& error) {
  std::string message = error.what();
  // Another fault may have come first, and then this one's error is not said.
  const std::string boards = session::boards_that_may_sound();
  if (message.find(boards) == std::string::npos) message += "; " + boards;
  const py::object value = py::reinterpret_steal<py::object>(
      PyObject_CallFunctionObjArgs(class_of(error.code()), shown_text(message).ptr(), nullptr));
  if (!value) return;  // Python has set an error of its own
  if (error.code() == Exit::bad_input) value.attr("file") = shown_text(file_in(message));
  value.attr("exit_code") = static_cast<int>(error.code());
  PyErr_SetObject(class_of(error.code()), value.ptr());
}

void forgive_wrong_value() {
  for (PyObject* const kind : {PyExc_TypeError, PyExc_ValueError, PyExc_OverflowError}) {
    if (PyErr_ExceptionMatches(kind)) return PyErr_Clear();
  }
  throw py::error_already_set();
}

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
  classes.warning = PyErr_NewExceptionWithDoc(
      "palpa.PalpaWarning", "An unusual value, or something that a run has left out. `warnings` can filter it.",
      PyExc_UserWarning, nullptr);
  if (!classes.warning) throw py::error_already_set();
  m.attr("PalpaWarning") = py::handle(classes.warning);
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

// ---- messages -------------------------------------------------------------------------------------------------------

namespace {

/// Keeps the newest lines of the log. It is never destroyed, because threads may log until the process ends.
log::Tail& tail() {
  static auto* const kept = new log::Tail();
  return *kept;
}

/// Those that messages() has not returned yet; guarded by the interpreter's lock.
std::deque<log::Line>& lines() {
  static auto* const kept = new std::deque<log::Line>();
  return *kept;
}

/// Lets Python's `warnings` tell what was logged meanwhile, unless it is already printed, or `result` is null, because
/// the call failed. Returns the result, or null if a warning became an error.
PyObject* tell_warnings(PyObject* result) {
  if (!is_own_process()) return result;
  const std::vector<log::Line> fresh = tail().take();
  lines().insert(lines().end(), fresh.begin(), fresh.end());
  while (lines().size() > log::Tail::most)
    lines().pop_front();
  if (!result || log::level() >= log::Level::warning) return result;
  for (const log::Line& line : fresh) {
    if (line.level != log::Level::warning) continue;
    const py::object text = shown_text(line.text).attr("encode")("utf-8", "backslashreplace");
    if (PyErr_WarnEx(classes.warning, PyBytes_AsString(text.ptr()), 1) == 0) continue;
    Py_DECREF(result);
    return nullptr;
  }
  return result;
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
    The least important messages that are printed. The module begins with "quiet": it prints nothing, and gives
    warnings to Python's `warnings` as PalpaWarning. With "warning" and beyond, they are only printed.)");
  m.def(
      "messages",
      [] {
        tell_warnings(nullptr);
        py::list taken;
        for (const log::Line& line : lines())
          taken.append(py::make_tuple(std::string(word_of(log::level_words, line.level)), shown_text(line.text)));
        lines().clear();
        return taken;
      },
      R"(Take the messages since the last call, such as warnings of unusual values.

Returns
-------
list of (str, str)
    Level and text of each message, oldest first; at most the newest 500.)");
}

}  // namespace

// ---- guards ---------------------------------------------------------------------------------------------------------

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
    return tell_warnings(dispatcher(self, arguments, keywords));
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

/// pybind11's, which calls every class.
ternaryfunc make_object = nullptr;

/// Without a class of C++ behind it, pybind11's own base class ends the program when it is called. Protocols 0 and 1 of
/// pickle call it for objects that cannot be pickled.
PyObject* make_guarded(PyObject* type, PyObject* arguments, PyObject* keywords) {
  if (!py::detail::all_type_info(reinterpret_cast<PyTypeObject*>(type)).empty())
    return make_object(type, arguments, keywords);
  PyErr_SetString(PyExc_TypeError, "such an object cannot be made, and those of its classes cannot be pickled");
  return nullptr;
}

void guard_classes() {
  PyTypeObject& metaclass = *py::detail::get_internals().default_metaclass;
  if (metaclass.tp_call == make_guarded) return;
  make_object = metaclass.tp_call;
  metaclass.tp_call = make_guarded;
}

}  // namespace

void guard(const py::module_& m) {
  guard_classes();
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

}  // namespace palpa::python

namespace {

constexpr const char* pybind11_version = PYBIND11_TOSTRING(PYBIND11_VERSION_MAJOR) "." PYBIND11_TOSTRING(
    PYBIND11_VERSION_MINOR) "." PYBIND11_TOSTRING(PYBIND11_VERSION_PATCH);

/// pybind11 before 2.12 reads arrays as NumPy 1 lays them out. With NumPy 2, numbers would be wrong without an error.
void refuse_unknown_numpy() {
  constexpr int first_with_numpy_2 = 0x020C0000;
  if (PYBIND11_VERSION_HEX >= first_with_numpy_2) return;
  const auto numpy = pybind11::module_::import("numpy").attr("__version__").cast<std::string>();
  if (std::atoi(numpy.c_str()) < 2) return;
  throw pybind11::import_error(
      fmt::format("palpa was built with pybind11 {}, which reads the arrays of NumPy 1 only, and here is NumPy {}: "
                  "install numpy<2, or build palpa with pybind11 2.12 or newer (pip install . does)",
                  pybind11_version, numpy));
}

}  // namespace

PYBIND11_MODULE(_engine, m) {
  using namespace palpa::python;
  refuse_unknown_numpy();
  m.attr("_pybind11") = pybind11_version;
  m.attr("__version__") = PALPA_VERSION;
  m.attr("_commit") = palpa::commit();
  pybind11::options options;
  options.disable_enum_members_docstring();
  m.def(
      "_use_assets", [](pybind11::handle folder) { palpa::setup::set_asset_folder(bytes_of("folder", folder)); },
      "Look for palpa's own models and rigs in this folder.");
  m.def(
      "asset", [](pybind11::handle name) { return shown_text(palpa::setup::find_asset(bytes_of("name", name))); },
      pybind11::arg("name"),
      R"(Find a model, a rig or another file that comes with palpa.

Parameters
----------
name : str
    Such as "cube.glb", "finger.ply", "rigs/paper.toml" or "depth/take".

Returns
-------
str
    The file's path. With PALPA_ASSETS in the environment, it is in that folder.)");
  m.def(
      "_text_of",
      [](pybind11::handle file) {
        constexpr std::uint64_t most_bytes = 64u << 20;
        const std::string text = palpa::read_text_file(bytes_of("file", file), most_bytes);
        return pybind11::bytes(text);
      },
      "The bytes of a file of text, without a byte order mark; refused in UTF-16.");
  m.def(
      "_use_guards",
      [](const pybind11::list& files) {
        std::vector<std::string> places;
        for (const pybind11::handle file : files)
          places.push_back(bytes_of("files", file));
        palpa::driver::look_for_guard_at(std::move(places));
      },
      "Look for palpa-guard at these places first.");
  add_errors(m);
  add_running(m);
  add_log(m);
  add_options(m);
  add_shapes(m);
  add_places(m);
  add_camera(m);
  add_touch(m);
  add_layout(m);
  add_bodies(m);
  add_tasks(m);
  add_recording(m);
  add_session(m);
  add_sensation(m);
  add_pickles(m);
  guard(m);
}
