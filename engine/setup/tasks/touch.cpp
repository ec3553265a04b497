#include "setup/tasks/touch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <span>
#include <utility>

#include "array/layouts/changes.hpp"
#include "array/schedule.hpp"
#include "base/error.hpp"
#include "base/files/json_writer.hpp"
#include "base/log.hpp"
#include "base/text.hpp"
#include "session/links/foci_link.hpp"
#include "session/previews/ear_sound.hpp"
#include "session/previews/foci_pressures.hpp"
#include "session/watch/pressure_log.hpp"
#include "setup/options/board_play.hpp"
#include "setup/options/warnings.hpp"
#include "setup/sessions/frames.hpp"
#include "setup/sessions/load.hpp"
#include "setup/sessions/touch_schedule.hpp"
#include "setup/tasks/felt_json.hpp"

namespace palpa::setup {

void add_task_options(CLI::App& app, TouchTask& o) {
  add_touch_options(app, o.touch);
  add_felt_options(app, o.felt);
  add_heard_options(app, o.heard);
  add_array_options(app, o.array);
}

void check(const TouchTask& options, bool depth_images) {
  check(options.compute);
  check(options.touch);
  check(options.felt, options.touch);
  if (options.heard.audible && options.array.layout.empty())
    throw bad_usage("--audible goes with --layout: it is about an array");
  if (!depth_images) refuse_finger_width(options.touch, "--depth");
}

namespace {

/// Whether --tune, its solid or a method of the caller's gave this finger its own schedule.
bool plays_its_own(const session::Session& session, const touch::Touch& touch, std::uint32_t finger) {
  const std::optional<acoustics::Tuned>& tuned = session.scheduler().fingers()[finger].tuned;
  return session.setting().schedule.own_method || (tuned && tuned->changed) ||
         session.scheduler().solids()[touch.fingers[finger].solid].own_schedule;
}

}  // namespace

bool TouchResult::beyond_linear() const {
  return std::ranges::any_of(
      values.pressures, [](const auto& foci) { return *std::ranges::max_element(foci) > array::linear_pressure_pa; });
}

namespace {

TouchArray load_array(const TouchTask& o, std::span<const geometry::Solid> solids) {
  TouchArray array{.layout = {},
                   .drive = drive_options(o.array.drive, o.touch.method.method),
                   .pressure_pa = o.array.drive.pressure_pa};
  if (o.array.layout.empty()) return array;
  check(o.array.drive, solids);
  array.layout = load_posed_layout(o.array.layout);
  warn_of_reach(array.layout, solids);
  warn_of_frequency(array.layout, array.drive.medium);
  return array;
}

TouchTask as_boards_play(TouchTask task) {
  take_play_of_boards(task.touch, load_posed_layout(task.array.layout), task.heard.steps, task.own_method != nullptr);
  return task;
}

/// As the boards' link does.
void warn_of_fewer_steps(const TouchTask& options, const session::Session& session) {
  const array::Layout& layout = session.setting().layout;
  const std::string why =
      array::why_fewer_steps(array::board_type_of(layout), {.slot_s = session.scheduler().slot_s(),
                                                            .boards_of_bus = layout.boards.size(),
                                                            .steps = options.heard.steps == Steps::on,
                                                            .nulls = session.setting().drive.nulls != nullptr});
  if (!why.empty()) log::warning("--audible: " + why);
}

session::EarDrives ear_drives_of(const TouchTask& options, const session::Session& session) {
  return session::ear_drives(session.plan(), session.setting(), options.heard.steps == Steps::on);
}

std::optional<acoustics::EarLevel> ear_of(const TouchTask& options, const session::Session& session) {
  const session::EarDrives ear = ear_drives_of(options, session);
  if (ear.drives.empty()) return std::nullopt;
  return acoustics::ear_level(ear.played(), ear.ear);
}

}  // namespace

std::string wav_of(const TouchTask& options, const session::Session& session, double full_scale_db) {
  const session::EarDrives ear = ear_drives_of(options, session);
  if (ear.drives.empty()) throw bad_usage("--wav: nothing is touched, so nothing is heard");
  double peak = 0;
  std::string wav =
      acoustics::to_wav(acoustics::heard_sound(ear.played(), acoustics::least_q, ear.ear), full_scale_db, peak);
  if (peak > 1) {
    log::warning(fmt::format("--wav: the sound is louder than the file can be, so it is cut; give --wav-scale {:.0f}",
                             std::ceil(full_scale_db + 20 * std::log10(peak))));
  }
  return wav;
}

TouchResult touch_scene(const TouchTask& asked, const std::string& scene, std::vector<geometry::Solid> solids,
                        const TouchInput& skin, Stopwatch since) {
  const TouchTask options = asked.heard.audible ? as_boards_play(asked) : asked;
  Stopwatch whole = since;
  StepTimes times;
  TouchArray array = load_array(options, solids);
  times.emplace_back("load", since.lap_ms());
  TouchResult result{.one = touch_once(options.compute, options.touch, options.felt, scene, std::move(solids), skin,
                                       std::move(array), times, options.own_method, options.kept_solids)};
  bool warned = false;
  warn_of_left_out_fingers(result.touch(), warned);
  const session::Session& session = result.session();
  warn_of_feel(session);
  TouchValues& values = result.values = values_of(session, result.touch());
  values.points = skin.point_count;
  if (options.felt.spectrum) values.spectra = spectra_of(session);
  if (!options.array.layout.empty()) values.pressures = session::foci_pressures(session.plan(), session.setting());
  if (options.heard.audible) {
    warn_of_fewer_steps(options, session);
    values.ear = ear_of(options, session);
  }
  result.unreached = session::unreached(session.schedule(), session.solid_names());
  values.computed = used_backend(options.compute);
  values.total_ms = whole.lap_ms();
  values.times = std::move(times);
  return result;
}

namespace {

void add_schedule(JsonWriter& json, const array::Voice& voice) {
  json.key("schedule").begin_object().key("order");
  session::write_order(voice, json);
  json.member("dwell_s", voice.dwell_s).end_object();
}

/// The voice of a finger with its order counted in sectors. The foci that sound together are those of the filled
/// sectors.
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

/// The pressures at the foci of a finger; null for a sector without its own focus.
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

void add_finger(JsonWriter& json, const TouchValues& values, std::uint32_t index) {
  const touch::Finger& finger = values.touch.fingers[index];
  const session::ScheduledFinger& scheduled = values.fingers[index];
  const touch::Placement& placement = scheduled.placement;
  json.begin_object().member("solid", values.solids[finger.solid]);
  json.key("indices").begin_array();
  for (const std::uint32_t contact : finger.contacts)
    json.value(values.touch.contacts[contact].point);
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
  const array::Voice& voice = values.schedule.voices[index];
  if (voice.gain != 1) json.member("gain", voice.gain);
  if (const double asked = voice.asked_pa(); asked > 0) json.member("asked_pa", asked);
  if (!values.pressures.empty()) add_pressures(json, values.pressures[index], placement);
  if (values.own_schedule[index]) add_schedule(json, by_sector(voice, placement));
  add_felt(json, scheduled, values.spectra.empty() ? nullptr : &values.spectra[index]);
  json.end_object();
}

}  // namespace

TouchValues values_of(const session::Session& session, const touch::Touch& touch) {
  TouchValues values;
  values.touch.contacts = touch.contacts;
  values.touch.deep = touch.deep;
  values.touch.fingers.assign(touch.fingers.begin(), touch.fingers.begin() + touch.finger_count);
  values.touch.finger_count = touch.finger_count;
  values.touch.cluster_count = touch.cluster_count;
  values.schedule = session.schedule();
  values.common = session.scheduler().common_voice();
  values.fingers.assign(session.scheduler().fingers().begin(), session.scheduler().fingers().end());
  values.solids = session.solid_names();
  for (std::uint32_t f = 0; f < touch.finger_count; ++f)
    values.own_schedule.push_back(plays_its_own(session, touch, f));
  return values;
}

std::string to_json(const TouchValues& values) {
  const touch::Touch& touch = values.touch;
  JsonWriter json;
  json.begin_object().member("points", values.points);
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
    add_finger(json, values, f);
  json.end_array();
  add_schedule(json, values.common);
  if (values.ear) acoustics::write_level(*values.ear, json);
  if (values.computed) {
    json.member("backend", word_of(backend_words, values.computed->backend));
    json.member("backend_why", values.computed->why);
  }
  json.key("timing_ms").begin_object().member("total", values.total_ms);
  for (const auto& [stage, ms] : values.times)
    json.member(stage, ms);
  json.end_object().end_object();
  return json.take();
}

std::string to_csv(const TouchValues& values) {
  const touch::Touch& touch = values.touch;
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
                   c.depth_m, finger_of[i], csv_cell(values.solids[c.solid]));
  }
  return csv;
}

}  // namespace palpa::setup
