#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <initializer_list>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "base/files/outputs.hpp"
#include "driver/links.hpp"
#include "driver/sources.hpp"
#include "module.hpp"
#include "running.hpp"
#include "sensation/played.hpp"
#include "session/sensation_run.hpp"
#include "setup/sessions/live_run.hpp"
#include "setup/sessions/play.hpp"
#include "shapes.hpp"
#include "values/arrays.hpp"
#include "values/options.hpp"

namespace palpa::python {
namespace {

/// The caller's function, which is called on the thread that plays. What it raises first ends the run.
struct OwnPath {
  py::object function;
  std::optional<py::error_already_set> fault;
};

struct SensationObject {
  std::string name;
  std::unique_ptr<sensation::Sensation> made;
  sensation::PatternSensation* pattern = nullptr;  ///< of `made`, if it is one
  std::shared_ptr<OwnPath> own;
  session::SensationControl control;
  std::atomic<bool> stop{false}, playing{false};

  sensation::PatternSensation& needed_pattern(const char* what) const {
    if (pattern == nullptr) throw bad_usage(fmt::format("{} is for a pattern; this sensation is a function", what));
    return *pattern;
  }
  void refuse_while_playing(const char* what) const {
    if (playing) throw bad_usage(fmt::format("{}: the sensation plays: stop() ends that", what));
  }
};

std::map<std::string, double> values_of(const py::dict& given) {
  std::map<std::string, double> values;
  for (const auto& [key, value] : given) {
    const std::string name = bytes_of("a parameter", key);
    const std::vector<double> numbers = numbers_of(name, value);
    if (numbers.size() != 1) throw bad_usage(fmt::format("{}: give one number", name));
    values[name] = numbers[0];
  }
  return values;
}

/// Throws bad_usage for a name that the pattern does not know.
std::map<std::string, double> known_values(const py::dict& given, const sensation::Pattern& pattern) {
  std::map<std::string, double> values = values_of(given);
  for (const auto& [name, value] : values)
    setup::check_parameter("parameters", name, value, pattern);
  return values;
}

/// Places and gains, as the caller's function returns them.
void take_answer(const py::object& answer, std::vector<Vec3>& places, std::vector<double>& gains) {
  const bool pair = is_list(answer) && py::len(answer) == 2;
  if (!pair) throw bad_usage("the sensation's function must return places, of shape (n, 3), and gains, of shape (n,)");
  places = points_of("the function's places", py::object(answer[py::int_(0)]));
  gains = numbers_of("the function's gains", py::object(answer[py::int_(1)]));
}

std::unique_ptr<sensation::Sensation> of_function(const std::shared_ptr<OwnPath>& own) {
  return std::make_unique<sensation::FunctionSensation>(
      [own](std::span<const double> times_s, std::vector<Vec3>& places, std::vector<double>& gains) {
        {
          const Locked locked;
          if (!locked) throw failure("the interpreter ends");
          try {
            take_answer(call_python(own->function, py::make_tuple(copied(times_s))), places, gains);
            return;
          } catch (py::error_already_set& error) {
            own->fault.emplace(error);
          }
        }
        throw failure("the sensation's function failed");
      });
}

/// Throws what the function raised instead of what followed from it.
template <typename Work>
auto with_fault(SensationObject& o, Work work) {
  try {
    return work();
  } catch (const Error&) {
    if (!o.own || !o.own->fault) throw;
    py::error_already_set fault(std::move(*o.own->fault));
    o.own->fault.reset();
    throw fault;
  }
}

std::shared_ptr<SensationObject> make(const py::object& what, const py::kwargs& parameters) {
  refuse_fork();
  auto o = std::make_shared<SensationObject>();
  if (PyCallable_Check(what.ptr()) != 0) {
    if (!parameters.empty()) throw bad_usage("a function has no parameters of palpa's: bind them in Python");
    o->name = "the function";
    o->own = std::make_shared<OwnPath>(OwnPath{what, std::nullopt});
    o->made = of_function(o->own);
    return o;
  }
  o->name = file_of("sensation", what);
  sensation::Pattern pattern = unlocked([&] { return setup::load_sensation(o->name); });
  const std::map<std::string, double> given = known_values(parameters, pattern);
  auto made = std::make_unique<sensation::PatternSensation>(std::move(pattern), given);
  o->pattern = made.get();
  o->made = std::move(made);
  return o;
}

// ---- values ---------------------------------------------------------------------------------------------------------

/// Parameters that differ from time to time.
std::map<std::string, std::vector<double>> courses_of(const py::object& parameters, std::size_t times,
                                                      const sensation::Pattern& pattern) {
  std::map<std::string, std::vector<double>> courses;
  if (parameters.is_none()) return courses;
  if (!PyDict_Check(parameters.ptr())) throw bad_usage("parameters: give a dict of numbers");
  for (const auto& [key, value] : py::reinterpret_borrow<py::dict>(parameters)) {
    if (!PyUnicode_Check(key.ptr())) throw bad_usage("parameters: give names as texts");
    const std::string name = bytes_of("parameters", key);
    std::vector<double> numbers = numbers_of(name, value);
    if (!pattern.parameter(name)) setup::check_parameter("parameters", name, 0, pattern);
    if (numbers.size() == 1) numbers.resize(times, numbers[0]);
    if (numbers.size() != times)
      throw bad_usage(fmt::format("parameters: {} has {} values for {} times", name, numbers.size(), times));
    courses.emplace(name, std::move(numbers));
  }
  return courses;
}

py::object evaluate_function(SensationObject& o, const std::vector<double>& times) {
  std::vector<sensation::Point> points;
  with_fault(o, [&] {
    sensation::State state;
    o.made->points(times, state, points);
  });
  std::vector<Vec3> places;
  std::vector<double> gains;
  for (const sensation::Point& point : points) {
    places.push_back(point.place_m);
    gains.push_back(point.gain);
  }
  return py::make_tuple(copied(places), copied(std::span<const double>(gains)));
}

py::object evaluate(SensationObject& o, const py::object& times_given, const py::object& parameters, bool details,
                    std::uint64_t seed) {
  refuse_fork();
  const std::vector<double> times = numbers_of("times", times_given);
  if (o.pattern == nullptr) {
    if (!parameters.is_none() || details) o.needed_pattern("evaluate with parameters or details");
    return evaluate_function(o, times);
  }
  o.refuse_while_playing("evaluate");
  o.pattern->take_changes();
  const sensation::Pattern& pattern = o.pattern->pattern();
  const auto courses = courses_of(parameters, times.size(), pattern);
  std::map<std::string, double> given = o.pattern->given();
  sensation::State state = sensation::State::at(0, seed);
  std::vector<Vec3> places;
  std::vector<double> gains, intensities, pattern_times;
  std::vector<std::uint8_t> stops;
  for (std::size_t i = 0; i < times.size(); ++i) {
    for (const auto& [name, values] : courses)
      given[name] = values[i];
    const sensation::Values values = courses.empty() ? o.pattern->values() : sensation::values_of(pattern, given);
    const sensation::Evaluation at = o.pattern->step(times[i], values, state);
    places.push_back(1e-3 * at.place_mm);
    intensities.push_back(at.intensity);
    gains.push_back(is_finite(at.place_mm) && std::isfinite(at.intensity) ? std::clamp(at.intensity, 0.0, 1.0) : 0.0);
    pattern_times.push_back(1e-3 * at.pattern_ms);
    stops.push_back(at.stop ? 1 : 0);
  }
  const auto row = [](const auto& values) { return copied(std::span(values)); };
  if (!details) return py::make_tuple(copied(places), row(gains));
  py::dict all;
  all["places"] = copied(places);
  all["gains"] = row(gains);
  all["intensities"] = row(intensities);
  all["pattern_times"] = row(pattern_times);
  all["stops"] = row(stops).attr("astype")("bool");
  return all;
}

// ---- playing --------------------------------------------------------------------------------------------------------

constexpr std::initializer_list<const char*> not_here = {"--param", "--csv", "--png"};
constinit DeclaredOnce<setup::PlayOptions> play_options("Sensation.play", setup::add_play_options, not_here);

session::OutputStats open_and_play(SensationObject& o, const setup::PlayOptions& options, bool ends) {
  const std::vector<session::LinkKind> links = setup::with_builtin(driver::links());
  const Outputs outputs(setup::outputs_of(options, links));
  const auto playing = setup::prepare_play(options, o.made->fastest_hz(), o.name, links);
  playing->setting.ends = ends;
  std::vector<sensation::Point> points;
  if (setup::is_offline(options)) points = setup::offline_points(*o.made, playing->setting, o.name);
  const std::vector<session::SourceKind> sources = driver::camera_sources();
  return setup::play(options, *o.made, o.control, *playing, points, sources, links, o.stop);
}

py::dict play(const std::shared_ptr<SensationObject>& o, bool ends, bool paused, const py::kwargs& kwargs) {
  refuse_fork();
  setup::PlayOptions options = play_options().read(kwargs);
  options.names = {o->name};
  setup::check(options);
  if (o->pattern == nullptr && options.speed != 1) o->needed_pattern("speed");
  if (o->playing.exchange(true)) throw bad_usage("the sensation plays already: stop() ends that");
  o->stop = false;
  if (!paused) o->control.play(0);
  if (o->pattern != nullptr) o->pattern->set_speed(options.speed);
  o->made->take_changes();
  session::OutputStats stats;
  try {
    with_fault(*o, [&] {
      run_beside(o->stop, [&] {
        const EndsWithInterpreter ends_with(o->stop);
        stats = open_and_play(*o, options, ends);
      });
    });
  } catch (...) {
    o->playing = false;
    throw;
  }
  o->playing = false;
  py::dict made;
  made["drives"] = stats.drives;
  made["silent_drives"] = stats.silent_drives;
  made["skipped_slots"] = stats.skipped_slots;
  made["lost"] = stats.hand_over.lost();
  return made;
}

py::list newest(const SensationObject& o, std::size_t most) {
  py::list points;
  for (const sensation::Point& point : o.control.newest(most)) {
    py::dict made;
    made["place"] = py::make_tuple(point.place_m.x, point.place_m.y, point.place_m.z);
    made["gain"] = point.gain;
    made["pattern_time"] = point.pattern_s;
    made["stop"] = point.stop;
    points.append(made);
  }
  return points;
}

constexpr const char* class_doc =
    R"(A focus that moves in time: a pattern of Adaptics, or a function.

Parameters
----------
sensation : path or callable
    A pattern's file, one of palpa's own ("circle", "heartbeat", "lateral", "point" or "sweep"), or a function. It takes
    an array of times in seconds, and returns places in metres, of shape (n, 3), in the array's frame, and gains from 0
    to 1, of shape (n,). Numbers that are not finite end play() with an error.
**parameters : float
    Values of the pattern's parameters.)";
constexpr const char* evaluate_doc =
    R"(Where the focus is at these times, and how strong.

A pattern goes on from each time to the next, so jumps depend on the list: ask for even steps, as a player does.

Parameters
----------
times : array_like, shape (n,)
    Seconds from the start.
parameters : dict, optional
    For each name of a pattern's parameter a number, or one for each time.
details : bool, optional
    Return a dict with "places", "gains", "intensities" (which may be outside 0 to 1), "pattern_times" and
    "stops" of a pattern.
seed : int, optional
    The start of random intensities.

Returns
-------
pair of ndarray, or dict
    Places in metres, of shape (n, 3), and gains, of shape (n,).)";
constexpr const char* play_doc =
    R"(Play until the sensation ends, its duration is over, or stop() is called; the array is silent afterwards.

Other threads may change parameters, pause and start again meanwhile.

Parameters
----------
ends : bool, optional
    False: where the sensation stops, it pauses, and play() goes on until stop().
paused : bool, optional
    True: plays as start() and pause() have said, and not from the beginning.

Returns
-------
dict
    Numbers of drives: "drives", "silent_drives", "skipped_slots" and "lost".)";

}  // namespace

void add_sensation(py::module_& m) {
  py::class_<SensationObject, std::shared_ptr<SensationObject>>(m, "Sensation", class_doc)
      .def(py::init(&make), py::arg("sensation"))
      .def_property_readonly(
          "parameters",
          [](const SensationObject& o) {
            py::dict made;
            if (o.pattern == nullptr) return made;
            for (const auto& [name, value] : o.pattern->parameters())
              made[shown_text(name)] = value;
            return made;
          },
          "dict of str to float: the value of each parameter of a pattern, within its limits.")
      .def_property_readonly(
          "playing", [](const SensationObject& o) { return o.playing && o.control.plays(); },
          "bool: whether it plays, and is neither paused nor at its end.")
      .def_property_readonly(
          "open", [](const SensationObject& o) { return o.control.runs(); },
          "bool: whether play() has opened its link, and has not ended.")
      .def("evaluate", &evaluate, py::arg("times"), py::arg("parameters") = py::none(), py::arg("details") = false,
           py::arg("seed") = 0, evaluate_doc)
      .def("play", &play, py::kw_only(), py::arg("ends") = true, py::arg("paused") = false,
           play_options().documented(play_doc).c_str())
      .def(
          "set",
          [](SensationObject& o, const py::kwargs& parameters) {
            o.needed_pattern("set").set_parameters(values_of(parameters));
          },
          "Give a pattern's parameters these values, and all others their defaults, also while it plays.")
      .def(
          "set_pattern",
          [](SensationObject& o, const std::string& text) {
            o.needed_pattern("set_pattern").set_pattern(unlocked([&] {
              return sensation::parse_pattern(text, "the pattern");
            }));
          },
          py::arg("text"),
          "Go on with another pattern, at the same time, also while it plays. `text` is what its file has.")
      .def(
          "set_matrix",
          [](SensationObject& o, const py::object& matrix) {
            o.needed_pattern("set_matrix").set_matrix(matrix_of("matrix", matrix));
          },
          py::arg("matrix"),
          "Apply a matrix of shape (4, 4) to places in millimetres, before the brush. It need not be rigid: results "
          "are "
          "divided by their fourth coordinate.")
      .def(
          "start", [](SensationObject& o, double time, double delay) { o.control.play(time, std::max(delay, 0.0)); },
          py::arg("time") = 0.0, py::arg("delay") = 0.0, "Play from this time on, in seconds, after a delay.")
      .def(
          "pause", [](SensationObject& o) { o.control.pause(); }, "Fall silent, and stay where it is.")
      .def(
          "follow", [](SensationObject& o, bool on) { o.control.follow(on); }, py::arg("on"),
          "Play on the hand of play(on=...), or not.")
      .def(
          "stop", [](SensationObject& o) { o.stop = true; }, "End play(), in silence.")
      .def(
          "newest", &newest, py::arg("most") = 32,
          "list of dict: the newest points that have sounded, with \"place\" in metres, \"gain\", \"pattern_time\" and "
          "\"stop\", oldest first. Empty after each start.")
      .def("__repr__", [](const SensationObject& o) { return fmt::format("<palpa.Sensation {}>", o.name); });
}

}  // namespace palpa::python
