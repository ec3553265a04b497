#include <fmt/format.h>

#include <iterator>
#include <string>

#include "array/schedule.hpp"
#include "base/json_writer.hpp"
#include "base/log.hpp"
#include "base/output_file.hpp"
#include "cli/commands.hpp"
#include "cli/felt.hpp"
#include "session/foci_link.hpp"
#include "session/overrides.hpp"
#include "setup/touch_input.hpp"
#include "setup/touch_run.hpp"
#include "setup/touch_schedule.hpp"
#include "setup/values.hpp"

namespace palpa::cli {
namespace {

struct TouchCommand {
  setup::CommonOptions common;
  setup::TouchInputOptions input;
  setup::TouchOptions touch;
  setup::FeltOptions felt;
  std::string csv;
};

void add_options(CLI::App& app, TouchCommand& o) {
  setup::add_touch_input(app, o.input);
  setup::Group(app, "What touches what").text("--csv", o.csv, "FILE|-", "the contacts: index,x,y,z,depth,finger,solid");
  setup::add_touch_options(app, o.touch);
  setup::add_felt_options(app, o.felt);
}

/// One touch and all that is printed about it.
struct TouchReport {
  const setup::TouchInput& input;
  const touch::Touch& touch;
  const setup::TouchOptions& options;
  const std::vector<setup::FingerSchedule>& schedules;  ///< one per finger
  const std::vector<acoustics::Spectrum>& spectra;      ///< one per finger with --spectrum, else none
  double total_ms;
  const setup::StageTimes& times;
};

/// Whether the method's foci stand still on every finger.
bool plays_still(const setup::TouchOptions& options) {
  return options.method.method == touch::Method::single_focus || options.method.method == touch::Method::multi_focus;
}

/// What a finger of so many sectors plays.
void add_schedule(JsonWriter& json, const setup::TouchOptions& options, std::uint32_t foci,
                  const array::VoiceOptions& own) {
  const bool together = options.method.method == touch::Method::multi_focus;
  array::Voice voice;
  voice.foci_per_slot = together ? foci : 1;
  array::fill_order(options.method.method == touch::Method::single_focus ? 1 : foci, together ? 1 : own.stride,
                    voice.order);
  json.key("schedule").begin_object().key("order");
  session::write_order(voice, json);
  json.member("dwell_s", own.dwell_s).end_object();
}

/// How many foci a finger's order is of, where --tune or its solid gave it one of its own; else 0.
std::uint32_t foci_of_own_order(const TouchReport& report, std::uint32_t index) {
  const geometry::Solid& solid = report.input.solids[report.touch.fingers[index].solid];
  const std::optional<acoustics::Tuned>& tuned = report.schedules[index].tuned;
  if (tuned && tuned->changed) return tuned->ring.foci;
  return session::has_own_schedule(solid) ? session::foci_on(solid, report.options.parameters) : 0;
}

void add_finger(JsonWriter& json, const TouchReport& report, std::uint32_t index) {
  const touch::Finger& finger = report.touch.fingers[index];
  const touch::Placement& placement = report.schedules[index].placement;
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
  for (std::size_t i = 0; i < placement.foci.size(); ++i) {
    if (placement.has(i)) {
      json.value(placement.foci[i].position);
    } else {
      json.null();
    }
  }
  json.end_array();
  json.key("focus_points").begin_array();
  for (const touch::Focus& focus : placement.foci)
    json.value(focus.points);
  json.end_array();
  const setup::FingerSchedule& schedule = report.schedules[index];
  if (const std::uint32_t foci = foci_of_own_order(report, index)) {
    add_schedule(json, report.options, foci, schedule.voice);
  }
  if (schedule.tuned) add_tune(json, *schedule.tuned);
  if (!report.spectra.empty()) add_spectrum(json, schedule.perimeter_m, report.spectra[index]);
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
    add_finger(json, report, f);
  json.end_array();
  add_schedule(json, report.options, report.options.parameters.foci, setup::voice_options(report.options));
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

const char* manner(const touch::Placement& placement) {
  return placement.together ? " at once" : placement.still() ? ", at its centroid" : "";
}

std::string summary(const TouchReport& report) {
  const touch::Touch& touch = report.touch;
  std::string text;
  const auto out = std::back_inserter(text);
  fmt::format_to(out, "{} skin point{}, {} contact{}, {} finger{} ({:.1f} ms)\n", report.input.point_count,
                 plural(report.input.point_count), touch.contacts.size(), plural(touch.contacts.size()),
                 touch.finger_count, plural(touch.finger_count), report.total_ms);
  const auto order_of = [](std::uint32_t foci, std::uint32_t stride, double dwell_s) {
    return fmt::format("order {}, {} ms each", fmt::join(array::fill_order(foci, stride), " "), dwell_s * 1e3);
  };
  const bool still = plays_still(report.options);
  bool common = touch.finger_count == 0;
  for (std::uint32_t f = 0; f < touch.finger_count; ++f) {
    const touch::Finger& finger = touch.fingers[f];
    const glm::vec3 c = finger.section.centroid * 1e3f;
    const touch::Placement& placement = report.schedules[f].placement;
    std::size_t sounding = 0;
    for (std::size_t i = 0; i < placement.foci.size(); ++i)
      sounding += placement.has(i);
    fmt::format_to(out, "finger {} on {}: {} contacts around ({:.2f}, {:.2f}, {:.2f}) mm, {} of {} foci{}\n", f,
                   report.input.solids[finger.solid].name, finger.contacts.size(), c.x, c.y, c.z, sounding,
                   placement.foci.size(), manner(placement));
    const std::uint32_t own = still ? 0 : foci_of_own_order(report, f);
    const array::VoiceOptions& voice = report.schedules[f].voice;
    if (own != 0) fmt::format_to(out, "  {}\n", order_of(own, voice.stride, voice.dwell_s));
    common = common || own == 0;
  }
  const setup::TouchOptions& options = report.options;
  if (still) {
    fmt::format_to(out, "modulated at {} Hz, {}; --json gives everything\n", options.modulation_hz,
                   array::name_of(options.modulation));
  } else {
    if (common) text += order_of(options.parameters.foci, options.stride, options.dwell_s) + "; ";
    text += "--json gives everything\n";
  }
  for (std::uint32_t f = 0; f < touch.finger_count; ++f) {
    if (report.schedules[f].tuned) text += tune_line(f, *report.schedules[f].tuned);
  }
  for (std::uint32_t f = 0; f < report.spectra.size(); ++f)
    text += spectrum_table(f, report.schedules[f].perimeter_m, report.spectra[f]);
  return text;
}

void run(const TouchCommand& o) {
  check(o.input);
  check(o.touch);
  check(o.felt, o.touch);
  const Outputs outputs({{"--json", o.common.json}, {"--csv", o.csv}});
  setup::Stopwatch whole, watch;
  setup::StageTimes times;
  const setup::TouchInput input = setup::load_touch_input(o.input, o.common.quiet);
  session::check_overrides(o.input.scene, input.solids, o.touch.parameters, setup::voice_options(o.touch));
  times.emplace_back("load", watch.lap_ms());
  const touch::Touch touch =
      o.common.backend == setup::Backend::cpu
          ? setup::touch_on_cpu(input, o.touch.parameters, times)
          : setup::touch_on_gpu(setup::device_options(o.common), input, o.touch.parameters, times);
  if (touch.cluster_count > touch.finger_count) {
    log::warning(fmt::format("{} clusters of contacts make a finger, only the first {} are kept", touch.cluster_count,
                             touch.finger_count));
  }
  const std::vector<setup::FingerSchedule> schedules = setup::schedule_fingers(touch, input.solids, o.touch, o.felt);
  const std::vector<acoustics::Spectrum> spectra =
      o.felt.spectrum ? setup::spectra_of(make_schedule(touch, input.solids, schedules, o.touch), o.felt)
                      : std::vector<acoustics::Spectrum>();
  const TouchReport report{input, touch, o.touch, schedules, spectra, whole.lap_ms(), times};
  if (!o.csv.empty()) write_file(o.csv, to_csv(report));
  if (!o.common.json.empty()) write_file(o.common.json, to_json(report));
  if (setup::shows_summary(o.common, outputs)) write_file("-", summary(report));
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
