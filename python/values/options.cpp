#include "values/options.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>

#include "array/drive.hpp"
#include "array/field/free_field.hpp"
#include "base/error.hpp"
#include "base/nearest_word.hpp"
#include "base/text.hpp"
#include "layout.hpp"
#include "line/option_table.hpp"
#include "line/together.hpp"
#include "module.hpp"
#include "own.hpp"
#include "running.hpp"
#include "shapes.hpp"
#include "touch_object.hpp"
#include "values/arrays.hpp"
#include "values/placed.hpp"

namespace palpa::python {
namespace {

std::string keyword_of(std::string name) {
  name.erase(0, name.find_first_not_of('-'));
  std::ranges::replace(name, '-', '_');
  return name;
}

Error not_a_value(const std::string& name, const char* wanted) {
  return bad_usage(fmt::format("{}: give {}", name, wanted));
}

/// A number, a text or a path as it would stand on a command line.
std::string text_of(const std::string& name, py::handle value) {
  if (is_flag(value)) throw not_a_value(name, "a value, not True or False");
  if (py::isinstance<py::str>(value)) return bytes_of(name, value);
  if (PyIndex_Check(value.ptr())) {
    const py::object number = py::reinterpret_steal<py::object>(PyNumber_Index(value.ptr()));
    if (!number) throw py::error_already_set();
    // Python writes no number of more than 4300 digits.
    if (const py::object text = py::reinterpret_steal<py::object>(PyObject_Str(number.ptr())))
      return bytes_of(name, text);
    forgive_wrong_value();
    throw not_a_value(name, "a smaller number");
  }
  if (py::isinstance<py::float_>(value) || py::hasattr(value, "__float__")) {
    const double number = PyFloat_AsDouble(value.ptr());
    if (PyErr_Occurred()) {
      forgive_wrong_value();
      throw not_a_value(name, "one number");
    }
    return fmt::format("{}", number);
  }
  if (py::isinstance<LayoutObject>(value)) return value.cast<const LayoutObject&>().option();
  if (py::hasattr(value, "source")) return text_of(name, value.attr("source"));  // of a Scene
  if (const std::optional<std::string> path = path_of(value)) return *path;
  if (PyCallable_Check(value.ptr())) throw not_a_value(name, "a text: no function is taken here");
  throw not_a_value(name, "a number, a text or a path");
}

/// (0, 0, 0.15) is "0,0,0.15".
std::string joined(const std::string& name, py::handle value) {
  if (!is_list(value)) return text_of(name, value);
  std::vector<std::string> parts;
  for (const py::object part : value.cast<py::sequence>())
    parts.push_back(text_of(name, part));
  return fmt::format("{}", fmt::join(parts, ","));
}

/// The values of a keyword; none means that the option is not given.
bool values_of(bool flag, bool several, const std::string& name, py::handle value, std::vector<std::string>& texts) {
  if (flag) {
    if (!is_flag(value)) throw not_a_value(name, "True or False");
    return value.cast<bool>();
  }
  if (several && is_list(value)) {
    for (const py::object one : value.cast<py::sequence>())
      texts.push_back(joined(name, one));
    return !texts.empty();
  }
  texts.push_back(joined(name, value));
  if (texts.back().empty()) throw not_a_value(name, "a text that is not empty");
  return true;
}

/// The tables of all functions, for stubs.
std::map<std::string, py::list>& tables() {
  static auto* const all = new std::map<std::string, py::list>();
  return *all;
}

py::list table_of(const std::vector<line::OptionInfo>& infos) {
  py::list rows;
  for (const line::OptionInfo& info : infos) {
    py::list words;
    for (const std::string& word : info.words)
      words.append(word);
    rows.append(py::make_tuple(keyword_of(info.name), info.type, info.help, info.initial, words, info.flag));
  }
  return rows;
}

/// A help text with keywords instead of options.
std::string in_python(const std::string& help) {
  std::string text;
  for (std::size_t at = 0; at < help.size();) {
    if (help.compare(at, 2, "--") != 0) {
      text += help[at++];
      continue;
    }
    const std::size_t end = std::min(help.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-", at), help.size());
    text += keyword_of(help.substr(at, end - at));
    at = end;
  }
  return text;
}

}  // namespace

bool is_list(py::handle value) {
  if (py::isinstance<py::str>(value) || !py::isinstance<py::sequence>(value)) return false;
  if (PySequence_Size(value.ptr()) >= 0) return true;
  forgive_wrong_value();
  return false;
}

OptionTable::OptionTable(std::string function, const std::function<void(CLI::App&)>& add,
                         std::initializer_list<const char*> hidden)
    : function_(std::move(function)), app_(std::make_unique<CLI::App>()) {
  add(*app_);
  const auto is_hidden = [&](const std::string& name) {
    return std::ranges::any_of(hidden, [&](const char* other) { return name == other; });
  };
  for (const CLI::Option* option : app_->get_options()) {
    if (option == app_->get_help_ptr() || option->get_lnames().empty()) continue;
    const std::string name = "--" + option->get_lnames().front();
    const int most = option->get_expected_max();
    if (!is_hidden(name)) options_.emplace(keyword_of(name), Known{name, most == 0, most > 1});
  }
  for (line::OptionInfo& info : line::option_table(*app_)) {
    if (!is_hidden(info.name)) infos_.push_back(std::move(info));
  }
  tables()[function_] = table_of(infos_);
}

OptionTable::~OptionTable() = default;

line::Given OptionTable::given_by(const py::kwargs& arguments) const {
  line::Given given;
  for (const auto& [key, value] : arguments) {
    const auto keyword = key.cast<std::string>();
    const auto found = options_.find(keyword);
    if (found == options_.end()) {
      std::vector<std::string> names;
      for (const auto& [known, option] : options_)
        names.push_back(known);
      const std::string nearest = nearest_word(keyword, names);
      throw bad_usage(fmt::format("{} has no option '{}'{}", function_, printable(keyword, 60),
                                  nearest.empty() ? "" : fmt::format(": did you mean {}?", nearest)));
    }
    if (value.is_none()) continue;
    const auto& [name, flag, several] = found->second;
    std::vector<std::string> texts;
    if (values_of(flag, several, name, value, texts)) given.emplace(name, std::move(texts));
  }
  return given;
}

void OptionTable::read(const line::Given& given) {
  if (const std::string fault = line::misfit(*app_, given); !fault.empty()) throw bad_usage(fault);
  line::read_given(*app_, given);
}

std::string OptionTable::documented(const std::string& doc) const {
  std::string text = doc + "\n\nOther Parameters\n----------------\n";
  for (const line::OptionInfo& info : infos_) {
    std::string type = info.flag ? "bool" : info.type;
    if (!info.words.empty()) type = fmt::format("{{\"{}\"}}", fmt::join(info.words, "\", \""));
    text += fmt::format("{} : {}, optional\n    {}{}\n", keyword_of(info.name), type, in_python(info.help),
                        info.initial.empty() ? "" : fmt::format(" [{}]", in_python(info.initial)));
  }
  return text;
}

// ---- functions instead of words -------------------------------------------------------------------------------------

namespace {

/// Takes a function from the keyword arguments; null if the value is a text. Refuses the arguments `idle` beside it.
py::object take_function(const py::kwargs& arguments, const char* name, std::initializer_list<const char*> idle) {
  if (!arguments.contains(name)) return {};
  py::object value = arguments[name];
  if (!PyCallable_Check(value.ptr())) return {};
  for (const char* const other : idle) {
    if (arguments.contains(other) && !py::object(arguments[other]).is_none())
      throw bad_usage(fmt::format("{} has no effect with a function as {}; leave it out", other, name));
  }
  PyDict_DelItemString(arguments.ptr(), name);
  return value;
}

/// The foci that the caller's function places. `solids`: their names.
std::vector<Vec3> foci_by(const py::object& method, const std::vector<std::string>& solids, const touch::Touch& touch,
                          const touch::Finger& finger) {
  auto whole = std::make_shared<TouchObject>();
  whole->values.touch.contacts = touch.contacts;
  whole->values.touch.fingers = {finger};
  whole->values.touch.finger_count = 1;
  whole->values.solids = solids;
  whole->values.fingers.resize(1);
  whole->values.schedule.add_voice();
  const py::object returned = call_python(method, py::make_tuple(FingerObject{whole, 0}));
  refuse_other_frame("method", returned);
  std::vector<Vec3> foci = points_of("method", returned);
  if (foci.empty() || foci.size() > touch::max_foci)
    throw bad_usage(fmt::format("method: returned {} foci; a finger has 1 to {}", foci.size(), touch::max_foci));
  for (const Vec3& focus : foci) {
    if (!array::drivable({.position = focus}))
      throw bad_usage(
          fmt::format("method: returned a focus at ({}, {}, {}), farther than 100 m away", focus.x, focus.y, focus.z));
  }
  return foci;
}

/// Calls a function with the interpreter's lock, unless one has failed before.
template <typename Call>
void call_own(OwnFunctions& own, const Call& call) {
  {
    const Locked locked;
    if (!locked || own.fault) return;
    const OwnFunctions::Called called(own);
    try {
      call();
      return;
    } catch (...) {
      own.fault = std::current_exception();
    }
  }
  if (own.live) throw failure("a function of the caller's failed");
}

}  // namespace

OwnFunctions::Called::Called(OwnFunctions& own) : since(own.called_s) {
  since = std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

void OwnFunctions::throw_fault() {
  if (fault) std::rethrow_exception(std::exchange(fault, nullptr));
}

void take_method(const py::kwargs& arguments, OwnFunctions& functions) {
  functions.method = take_function(arguments, "method", {"foci", "spacing", "tune"});
}

void take_solver(const py::kwargs& arguments, OwnFunctions& functions) {
  functions.solver =
      take_function(arguments, "solver", {"amplitude", "transfer", "constraint", "pressure", "spread", "finger"});
}

session::OwnMethod own_method(OwnFunctions& functions, std::span<const geometry::Solid> solids) {
  if (!functions.method) return {};
  std::vector<std::string> names;
  for (const geometry::Solid& solid : solids)
    names.push_back(solid.name);
  return [&functions, names = std::move(names)](const touch::Touch& touch, const touch::Finger& finger,
                                                touch::Placement& out) {
    out.foci.assign(1, {.position = finger.section.centroid, .points = finger.contact_count});
    out.complete = true;
    out.together = false;
    call_own(functions, [&] {
      const std::vector<Vec3> foci = foci_by(functions.method, names, touch, finger);
      out.foci.clear();
      for (const Vec3& focus : foci)
        out.foci.push_back({.position = glm::vec3(focus), .points = 1});
    });
  };
}

session::OwnSolver own_solver(OwnFunctions& functions) {
  if (!functions.solver) return {};
  return [&functions](const array::Layout& layout, const array::DriveOptions& options,
                      std::span<const array::SlotFocus> foci, std::span<array::TransducerDrive> out) {
    std::ranges::fill(out, array::TransducerDrive{0, 0});
    call_own(functions, [&] { std::ranges::copy(drive_by(functions.solver, layout, foci, options), out.begin()); });
  };
}

void add_options(py::module_& m) {
  m.def(
      "_options",
      [] {
        py::dict all;
        for (const auto& [function, table] : tables())
          all[function.c_str()] = table;
        return all;
      },
      "The options of each function, for stubs: (keyword, type, help, default, words, is a flag).");
}

}  // namespace palpa::python
