#include "module.hpp"

#include <pybind11/stl.h>

#include <exception>
#include <filesystem>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "base/log.hpp"
#include "base/words.hpp"
#include "setup/asset_folder.hpp"

namespace palpa::python {
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
std::string file_of(const std::string& message) {
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
  const py::object value =
      py::reinterpret_steal<py::object>(PyObject_CallFunction(class_of(error.code()), "s", message.c_str()));
  if (!value) return;  // Python has set an error of its own
  if (error.code() == Exit::bad_input) value.attr("file") = file_of(message);
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
    }
  });
}

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
  throw py::value_error("'" + word + "' is no log level; the levels are " + known);
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
        std::vector<std::pair<std::string, std::string>> lines;
        for (log::Line& line : tail().take())
          lines.emplace_back(word_of(log::level_words, line.level), std::move(line.text));
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
  m.def("_use_assets", &palpa::setup::set_asset_folder, "Look for palpa's own models and rigs in this folder.");
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
}
