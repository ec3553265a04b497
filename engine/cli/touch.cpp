#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <optional>
#include <string>
#include <utility>

#include "array/schedule.hpp"
#include "base/json_writer.hpp"
#include "base/log.hpp"
#include "base/output_file.hpp"
#include "cli/commands.hpp"
#include "cli/felt.hpp"
#include "session/links/foci_link.hpp"
#include "session/previews/foci_pressures.hpp"
#include "session/watch/pressure_log.hpp"
#include "setup/frames.hpp"
#include "setup/load.hpp"
#include "setup/nearest_skin.hpp"
#include "setup/progress.hpp"
#include "setup/touch_input.hpp"
#include "setup/touch_run.hpp"
#include "setup/touch_schedule.hpp"
#include "setup/values.hpp"
#include "setup/warnings.hpp"

namespace palpa::cli {
namespace {

struct TouchCommand {
  setup::CommonOptions common;
  setup::TouchInputOptions input;
  setup::TouchOptions touch;
  setup::FeltOptions felt;
  setup::ArrayOptions array;
  std::string csv;
};

void add_options(CLI::App& app, TouchCommand& o) {
  setup::add_touch_input(app, o.input);
  const setup::Group group(app, "What touches what");
  add_allow_outside(group, o.common);
  group.text("--csv", o.csv, "FILE|-", "the contacts: index,x,y,z,depth,finger,solid");
  setup::add_touch_options(app, o.touch);
  setup::add_felt_options(app, o.felt);
  setup::add_array_options(app, o.array);
}

/// One touch and all that is printed about it.
struct TouchReport {
  std::uint64_t points;
  const session::Session& session;  ///< its schedule has a voice per finger
  const touch::Touch& touch;
  const setup::TouchOptions& options;
  const std::vector<acoustics::Spectrum>& spectra;    ///< one per finger with --spectrum, else none
  const std::vector<std::vector<double>>& pressures;  ///< with --layout one per finger, for each focus of its voice
  double total_ms;
  const setup::StageTimes& times;
  std::optional<setup::NearestSkin> nearest;  ///< where nothing is touched
};

void add_schedule(JsonWriter& json, const array::Voice& voice) {
  json.key("schedule").begin_object().key("order");
  session::write_order(voice, json);
  json.member("dwell_s", voice.dwell_s).end_object();
}

/// The voice of a finger with its order counted in sectors: foci that sound together are those of its filled ones.
array::Voice by_sector(array::Voice voice, const touch::Placement& placement) {
  if (!placement.together) return voice;
  std::vector<std::uint32_t> filled;
  for (std::uint32_t i = 0; i < placement.foci.size(); ++i) {
    if (placement.has(i)) filled.push_back(i);
  }
  for (std::uint32_t& entry : voice.order)
    entry = filled[entry];
  return voice;
}

/// What sounds at the foci of a finger, null where a sector has none of its own.
void add_pressures(JsonWriter& json, const std::vector<double>& pressures, const touch::Placement& placement) {
  json.member("pressure_pa", *std::ranges::min_element(pressures));
  json.key("pressures_pa").begin_array();
  std::size_t filled = 0;  // foci that sound together are those of filled sectors
  for (std::uint32_t i = 0; i < placement.foci.size(); ++i) {
    if (placement.has(i)) {
      json.value(pressures[placement.together ? filled++ : i]);
    } else {
      json.null();
    }
  }
  json.end_array();
}

/// Whether --tune or its solid gave a finger a schedule of its own.
bool has_own_schedule(const TouchReport& report, std::uint32_t index) {
  const std::optional<acoustics::Tuned>& tuned = report.session.scheduler().fingers()[index].tuned;
  return (tuned && tuned->changed) ||
         report.session.scheduler().solids()[report.touch.fingers[index].solid].own_schedule;
}

void add_finger(JsonWriter& json, const TouchReport& report, std::uint32_t index) {
  const touch::Finger& finger = report.touch.fingers[index];
  const session::ScheduledFinger& scheduled = report.session.scheduler().fingers()[index];
  const touch::Placement& placement = scheduled.placement;
  json.begin_object().member("solid", report.session.solids()[finger.solid].name);
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
  const array::Voice& voice = report.session.schedule().voices[index];
  if (voice.gain != 1) json.member("gain", voice.gain);
  if (const double asked = voice.pressure_pa * voice.gain; asked > 0) json.member("asked_pa", asked);
  if (!report.pressures.empty()) add_pressures(json, report.pressures[index], placement);
  if (has_own_schedule(report, index)) add_schedule(json, by_sector(voice, placement));
  add_felt(json, scheduled, report.spectra.empty() ? nullptr : &report.spectra[index]);
  json.end_object();
}

std::string to_json(const TouchReport& report) {
  const touch::Touch& touch = report.touch;
  JsonWriter json;
  json.begin_object().member("points", report.points);
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
  add_schedule(json, report.session.scheduler().common_voice());
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
                   c.depth_m, finger_of[i], cell(report.session.solids()[c.solid].name));
  }
  return csv;
}

const char* plural(std::size_t count) {
  return count == 1 ? "" : "s";
}

std::string order_line(const array::Voice& voice) {
  return fmt::format("order {}, {} ms each", fmt::join(voice.order, " "), voice.dwell_s * 1e3);
}

const char* manner(const touch::Placement& placement) {
  return placement.together ? " at once" : placement.still() ? ", at its centroid" : "";
}

std::string summary(const TouchReport& report) {
  const touch::Touch& touch = report.touch;
  std::string text;
  const auto out = std::back_inserter(text);
  fmt::format_to(out, "{} skin point{}, {} contact{}, {} finger{} ({:.1f} ms)\n", report.points, plural(report.points),
                 touch.contacts.size(), plural(touch.contacts.size()), touch.finger_count, plural(touch.finger_count),
                 report.total_ms);
  if (report.nearest) {
    fmt::format_to(out, "the nearest skin is {:.1f} mm {} the surface of {}{}\n", report.nearest->distance_m * 1e3,
                   report.nearest->inside ? "below" : "away from", report.session.solids()[report.nearest->solid].name,
                   report.nearest->inside ? ", deeper than its shell" : "");
  }
  const array::Voice all = report.session.scheduler().common_voice();
  const bool still = all.order.size() == all.foci_per_slot;
  bool common = false;
  for (std::uint32_t f = 0; f < touch.finger_count; ++f) {
    const touch::Finger& finger = touch.fingers[f];
    const glm::vec3 c = finger.section.centroid * 1e3f;
    const touch::Placement& placement = report.session.scheduler().fingers()[f].placement;
    std::size_t sounding = 0;
    for (std::size_t i = 0; i < placement.foci.size(); ++i)
      sounding += placement.has(i);
    fmt::format_to(out, "finger {} on {}: {} contacts around ({:.2f}, {:.2f}, {:.2f}) mm, {} of {} foci{}\n", f,
                   report.session.solids()[finger.solid].name, finger.contacts.size(), c.x, c.y, c.z, sounding,
                   placement.foci.size(), manner(placement));
    if (!report.pressures.empty()) {
      const auto [least, most] = std::ranges::minmax(report.pressures[f]);
      fmt::format_to(out, "  pressure at its foci: {:.0f} to {:.0f} Pa\n", least, most);
    }
    const bool own = !still && has_own_schedule(report, f);
    if (own) fmt::format_to(out, "  {}\n", order_line(report.session.schedule().voices[f]));
    common = common || !own;
  }
  const setup::TouchOptions& options = report.options;
  if (still) {
    fmt::format_to(out, "modulated at {} Hz, {}; --json gives everything\n", options.modulation_hz,
                   word_of(array::modulation_words, options.modulation));
  } else {
    if (common) text += order_line(all) + "; ";
    text += "--json gives everything\n";
  }
  const auto loud = [](const auto& foci) { return *std::ranges::max_element(foci) > array::linear_pressure_pa; };
  if (std::ranges::any_of(report.pressures, loud)) text += setup::linear_line();
  text += felt_lines(report.session.scheduler().fingers(), report.spectra);
  return text;
}

setup::TouchArray load_array(const TouchCommand& o, std::span<const geometry::Solid> solids) {
  setup::TouchArray array{.layout = {},
                          .drive = setup::drive_options(o.array.drive, o.touch.method.method),
                          .pressure_pa = o.array.drive.pressure_pa};
  if (o.array.layout.empty()) return array;
  check(o.array.drive, solids);
  array.layout = setup::load_posed_layout(o.array.layout);
  setup::warn_of_reach(array.layout, solids);
  setup::warn_of_frequency(array.layout, array.drive.medium);
  return array;
}

void run(const TouchCommand& o) {
  check(o.input);
  check(o.touch);
  check(o.felt, o.touch);
  if (o.input.depths.empty()) setup::refuse_finger_width(o.touch, "--depth");
  check(o.array);
  const Outputs outputs({{"--json", o.common.json}, {"--csv", o.csv}});
  setup::Stopwatch whole, watch;
  setup::StageTimes times;
  std::optional<setup::Preparing> preparing(std::in_place, o.common.quiet);
  std::vector<geometry::Solid> solids = setup::load_solids(o.input.scene, o.input.gltf_scene, o.input.solids);
  const setup::TouchInput input = setup::load_touch_input(o.input, solids);
  setup::TouchArray array = load_array(o, solids);
  times.emplace_back("load", watch.lap_ms());
  const setup::OneTouch one =
      setup::touch_once(o.common, o.touch, o.felt, o.input.scene, std::move(solids), input, std::move(array), times);
  preparing.reset();
  const touch::Touch& touch = one.touch;
  bool warned = false;
  setup::warn_of_left_out_fingers(touch, warned);
  const std::vector<acoustics::Spectrum> spectra =
      o.felt.spectrum ? setup::spectra_of(one.session) : std::vector<acoustics::Spectrum>();
  const bool sounds = !o.array.layout.empty();
  const std::vector<std::vector<double>> pressures =
      sounds ? session::foci_pressures(one.session.plan(), one.session.setting()) : std::vector<std::vector<double>>();
  if (const auto fault = session::unreached(one.session.schedule(), one.session.solid_names())) log::warning(*fault);
  const double total_ms = whole.lap_ms();
  const bool summed_up = setup::shows_summary(o.common, outputs);
  const TouchReport report{
      input.point_count,
      one.session,
      touch,
      o.touch,
      spectra,
      pressures,
      total_ms,
      times,
      summed_up && touch.contacts.empty() ? setup::nearest_skin(one.session.solids(), input) : std::nullopt};
  if (!o.csv.empty()) write_file(o.csv, to_csv(report));
  if (!o.common.json.empty()) write_file(o.common.json, to_json(report));
  if (summed_up) write_file("-", summary(report));
}

}  // namespace

void add_touch(Program& program) {
  add_subcommand<TouchCommand>(
      program,
      {"touch", "one touch: where skin meets a model, which fingers, where the foci go",
       "  palpa touch --scene assets/cube.glb --points assets/finger.ply --penetration 3mm\n"
       "  palpa touch --scene model.glb --depth hand.png --camera camera.toml --json touch.json\n"
       "  palpa touch --scene assets/cube.glb --points assets/finger.ply --penetration 3mm --layout paper\n"
       "Depths and coordinates are metres in the world (glTF's axes, +y up)."},
      add_options, run);
}

}  // namespace palpa::cli
