#include <fmt/format.h>

#include <iterator>
#include <string>

#include "array/schedule.hpp"
#include "base/json_writer.hpp"
#include "base/log.hpp"
#include "cli/commands.hpp"
#include "cli/output.hpp"
#include "cli/touch_input.hpp"
#include "cli/touch_run.hpp"
#include "cli/values.hpp"
#include "session/overrides.hpp"

namespace palpa::cli {
namespace {

struct TouchCommand {
  CommonOptions common;
  TouchInputOptions input;
  TouchOptions touch;
  std::string csv;
};

void add_options(CLI::App& app, TouchCommand& o) {
  add_touch_input(app, o.input);
  Group(app, "What touches what").text("--csv", o.csv, "FILE|-", "the contacts: index,x,y,z,depth,finger,solid");
  add_touch_options(app, o.touch);
}

/// One touch and all that is printed about it.
struct TouchReport {
  const TouchInput& input;
  const touch::Touch& touch;
  const touch::Parameters& parameters;
  const array::VoiceOptions& voice;
  std::vector<std::uint32_t> order;
  double total_ms;
  const StageTimes& times;
};

/// What the solid's extras ask for, if not the order and dwell of all.
void add_schedule(JsonWriter& json, const TouchReport& report, const geometry::Solid& solid) {
  const array::VoiceOptions voice = session::voice_on(solid, report.voice);
  json.key("schedule").begin_object();
  json.member("order", array::fill_order(session::foci_on(solid, report.parameters), voice.stride));
  json.member("dwell_s", voice.dwell_s).end_object();
}

void add_finger(JsonWriter& json, const TouchReport& report, const touch::Finger& finger) {
  json.begin_object().member("solid", report.input.solids[finger.solid].name);
  json.key("indices").begin_array();
  for (const std::uint32_t contact : finger.contacts)
    json.value(report.touch.contacts[contact].point);
  json.end_array();
  json.member("centroid_m", finger.section.centroid);
  json.key("axes").begin_array();
  for (const glm::vec3& axis : finger.section.axes)
    json.value(axis);
  json.end_array();
  json.key("eigenvalues_m2").begin_array();
  for (const float eigenvalue : finger.section.eigenvalues)
    json.value(eigenvalue);
  json.end_array();
  json.key("foci_m").begin_array();
  for (const touch::Focus& focus : finger.foci) {
    if (focus.points != 0) {
      json.value(focus.position);
    } else {
      json.null();
    }
  }
  json.end_array();
  json.key("focus_points").begin_array();
  for (const touch::Focus& focus : finger.foci)
    json.value(focus.points);
  json.end_array();
  const geometry::Solid& solid = report.input.solids[finger.solid];
  if (session::has_own_schedule(solid)) add_schedule(json, report, solid);
  json.end_object();
}

std::string to_json(const TouchReport& report) {
  const touch::Touch& touch = report.touch;
  JsonWriter json;
  json.begin_object().member("points", report.input.point_count);
  json.key("contacts").begin_object().member("count", std::uint64_t{touch.contacts.size()});
  json.key("indices").begin_array();
  for (const touch::Contact& contact : touch.contacts)
    json.value(contact.point);
  json.end_array();
  json.key("depths_m").begin_array();
  for (const touch::Contact& contact : touch.contacts)
    json.value(contact.depth_m);
  json.end_array().end_object();
  json.key("fingers").begin_array(JsonWriter::Style::block);
  for (std::uint32_t f = 0; f < touch.finger_count; ++f)
    add_finger(json, report, touch.fingers[f]);
  json.end_array();
  json.key("schedule")
      .begin_object()
      .member("order", report.order)
      .member("dwell_s", report.voice.dwell_s)
      .end_object();
  json.key("timing_ms").begin_object().member("total", report.total_ms);
  for (const auto& [stage, ms] : report.times)
    json.member(stage, ms);
  json.end_object().end_object();
  return json.take();
}

/// A name as a CSV cell: quoted where it would be taken apart.
std::string cell(const std::string& name) {
  if (name.find_first_of(",\"\n\r") == std::string::npos) return name;
  std::string quoted = "\"";
  for (const char c : name)
    quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

std::string to_csv(const TouchReport& report) {
  const touch::Touch& touch = report.touch;
  // A contact whose cluster was too small belongs to no finger.
  std::vector<int> finger_of(touch.contacts.size(), -1);
  for (std::uint32_t f = 0; f < touch.finger_count; ++f) {
    for (const std::uint32_t contact : touch.fingers[f].contacts)
      finger_of[contact] = static_cast<int>(f);
  }
  std::string csv = "index,x,y,z,depth,finger,solid\n";
  for (std::size_t i = 0; i < touch.contacts.size(); ++i) {
    const touch::Contact& c = touch.contacts[i];
    fmt::format_to(std::back_inserter(csv), "{},{},{},{},{},{},{}\n", c.point, c.position.x, c.position.y, c.position.z,
                   c.depth_m, finger_of[i], cell(report.input.solids[c.solid].name));
  }
  return csv;
}

const char* plural(std::size_t count) {
  return count == 1 ? "" : "s";
}

std::string summary(const TouchReport& report) {
  const touch::Touch& touch = report.touch;
  std::string text;
  const auto out = std::back_inserter(text);
  fmt::format_to(out, "{} skin point{}, {} contact{}, {} finger{} ({:.1f} ms)\n", report.input.point_count,
                 plural(report.input.point_count), touch.contacts.size(), plural(touch.contacts.size()),
                 touch.finger_count, plural(touch.finger_count), report.total_ms);
  for (std::uint32_t f = 0; f < touch.finger_count; ++f) {
    const touch::Finger& finger = touch.fingers[f];
    const glm::vec3 c = finger.section.centroid * 1e3f;
    std::size_t sounding = 0;
    for (const touch::Focus& focus : finger.foci)
      sounding += focus.points != 0;
    fmt::format_to(out, "finger {} on {}: {} contacts around ({:.2f}, {:.2f}, {:.2f}) mm, {} of {} foci{}\n", f,
                   report.input.solids[finger.solid].name, finger.contacts.size(), c.x, c.y, c.z, sounding,
                   finger.foci.size(), finger.point_like ? ", at its centroid" : "");
  }
  fmt::format_to(out, "order {}, {} ms each; --json gives everything\n", fmt::join(report.order, " "),
                 report.voice.dwell_s * 1e3);
  return text;
}

void run(const TouchCommand& o) {
  check(o.input);
  check(o.touch);
  refuse_two_on_stdout(o.common.json, o.csv);
  Stopwatch whole, watch;
  StageTimes times;
  const TouchInput input = load_touch_input(o.input, o.common.quiet);
  const array::VoiceOptions voice{.stride = o.touch.stride, .dwell_s = o.touch.dwell_s};
  session::check_overrides(o.input.scene, input.solids, o.touch.parameters, voice);
  times.emplace_back("load", watch.lap_ms());
  const touch::Touch touch = o.common.backend == Backend::cpu
                                 ? touch_on_cpu(input, o.touch.parameters, times)
                                 : touch_on_gpu(device_options(o.common), input, o.touch.parameters, times);
  if (touch.cluster_count > touch.finger_count) {
    log::warning(fmt::format("{} clusters of contacts make a finger, only the first {} are kept", touch.cluster_count,
                             touch.finger_count));
  }
  const TouchReport report{
      input,          touch, o.touch.parameters, voice, array::fill_order(o.touch.parameters.foci, o.touch.stride),
      whole.lap_ms(), times};
  if (!o.csv.empty()) write_output(o.csv, to_csv(report));
  if (!o.common.json.empty()) write_output(o.common.json, to_json(report));
  if (shows_summary(o.common, o.csv)) write_output("-", summary(report));
}

}  // namespace

void add_touch(Program& program) {
  add_subcommand<TouchCommand>(
      program,
      {"touch", "one touch: where skin meets a model, which fingers, where the foci go",
       "  palpa touch --scene assets/cube.glb --points assets/finger.ply --penetration 3mm\n"
       "  palpa touch --scene model.glb --depth hand.png --camera camera.toml --json touch.json\n"
       "Depths and coordinates are metres in the world (glTF's axes, +y up)."},
      add_options, run);
}

}  // namespace palpa::cli
