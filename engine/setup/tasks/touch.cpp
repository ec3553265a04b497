#include "setup/tasks/touch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/vec3.hpp>
#include <iterator>
#include <optional>
#include <ranges>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "array/layouts/changes.hpp"
#include "array/schedule.hpp"
#include "base/error.hpp"
#include "base/files/json_rows.hpp"
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
  check(o.array.drive, FingerMesh::unknown);
  TouchArray array{.layout = {}, .drive = {}, .pressure_pa = o.array.drive.pressure_pa};
  if (o.array.layout.empty()) return array;
  check(o.array.drive, solids);
  array.layout = load_posed_layout(o.array.layout);
  array.drive = drive_options(o.array.drive, array.layout, solving_of(o.touch.method.method));
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
  if (!options.array.layout.empty()) values.driven = session.driven_by();
  values.computed = used_backend(options.compute);
  values.total_ms = whole.lap_ms();
  values.times = std::move(times);
  return result;
}

namespace {

const JsonRows<array::Voice>& schedule_rows() {
  static const auto rows =
      JsonRows<array::Voice>()
          .written({"order.#", "order.#.#"},
                   [](JsonWriter& json, const array::Voice& voice) { session::write_order(voice, json.key("order")); })
          .value("dwell_s", [](const array::Voice& voice) { return voice.dwell_s; });
  return rows;
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

/// A finger of a touch.
struct TouchedFinger {
  const TouchValues& values;
  std::uint32_t index;

  const touch::Finger& finger() const { return values.touch.fingers[index]; }
  const touch::CrossSection& section() const { return finger().section; }
  const session::ScheduledFinger& scheduled() const { return values.fingers[index]; }
  const touch::Placement& placement() const { return scheduled().placement; }
  const array::Voice& voice() const { return values.schedule.voices[index]; }
  /// The pressures at the foci of its voice. Null: they were not computed.
  const std::vector<double>* pressures() const { return values.pressures.empty() ? nullptr : &values.pressures[index]; }
};

/// One entry per sector, empty for one without a focus of its own.
std::vector<std::optional<glm::vec3>> foci_of(const TouchedFinger& f) {
  std::vector<std::optional<glm::vec3>> foci;
  for (std::uint32_t i = 0; i < f.placement().foci.size(); ++i)
    foci.push_back(f.placement().has(i) ? std::optional(f.placement().foci[i].position) : std::nullopt);
  return foci;
}
std::optional<std::vector<std::optional<double>>> pressures_of(const TouchedFinger& f) {
  if (!f.pressures()) return std::nullopt;
  std::vector<std::optional<double>> pressures;
  std::size_t filled = 0;  // foci that sound together are those of filled sectors
  for (std::uint32_t i = 0; i < f.placement().foci.size(); ++i) {
    const bool has = f.placement().has(i);
    pressures.push_back(has ? std::optional((*f.pressures())[f.placement().together ? filled++ : i]) : std::nullopt);
  }
  return pressures;
}

JsonRows<TouchedFinger> finger_rows() {
  using Finger = TouchedFinger;
  return JsonRows<Finger>()
      .value("solid", [](const Finger& f) { return std::string_view(f.values.solids[f.finger().solid]); })
      .value("indices",
             [](const Finger& f) {
               return std::views::transform(f.finger().contacts, [&contacts = f.values.touch.contacts](
                                                                     std::uint32_t at) { return contacts[at].point; });
             })
      .value("centroid_m", [](const Finger& f) { return f.section().centroid; })
      .value("axes", [](const Finger& f) { return &f.section().axes; })
      .value("eigenvalues_m2", [](const Finger& f) { return &f.section().eigenvalues; })
      .value("foci_m", foci_of)
      .value("focus_points",
             [](const Finger& f) { return std::views::transform(f.placement().foci, &touch::Focus::points); })
      .value("gain", [](const Finger& f) { return f.voice().gain != 1 ? std::optional(f.voice().gain) : std::nullopt; })
      .value(
          "asked_pa",
          [](const Finger& f) { return f.voice().asked_pa() > 0 ? std::optional(f.voice().asked_pa()) : std::nullopt; })
      .value("pressure_pa",
             [](const Finger& f) {
               return f.pressures() ? std::optional(*std::ranges::min_element(*f.pressures())) : std::nullopt;
             })
      .value("pressures_pa", pressures_of)
      .object("schedule", schedule_rows(),
              [](const Finger& f) {
                return f.values.own_schedule[f.index] ? std::optional(by_sector(f.voice(), f.placement()))
                                                      : std::nullopt;
              })
      .members(felt_rows(), [](const Finger& f) {
        return FeltFinger{f.scheduled(), f.values.spectra.empty() ? nullptr : &f.values.spectra[f.index]};
      });
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

const JsonRows<TouchValues>& touch_rows() {
  using Values = TouchValues;
  static const auto contacts =
      JsonRows<Values>()
          .value("count", [](const Values& v) { return std::uint64_t{v.touch.contacts.size()}; })
          .value("indices",
                 [](const Values& v) { return std::views::transform(v.touch.contacts, &touch::Contact::point); })
          .value("depths_m",
                 [](const Values& v) { return std::views::transform(v.touch.contacts, &touch::Contact::depth_m); });
  static const auto rows =
      JsonRows<Values>()
          .value("points", [](const Values& v) { return v.points; })
          .object("contacts", contacts, [](const Values& v) { return &v; })
          .objects(
              "fingers", finger_rows(),
              [](const Values& v) {
                return std::views::transform(std::views::iota(std::uint32_t{0}, v.touch.finger_count),
                                             [&v](std::uint32_t index) {
                                               return TouchedFinger{v, index};
                                             });
              },
              JsonWriter::Style::block)
          .object("schedule", schedule_rows(), [](const Values& v) { return &v.common; })
          .members(array::driven_rows(), [](const Values& v) { return v.driven ? &*v.driven : nullptr; })
          .written({"audible_dba.#"},
                   [](JsonWriter& json, const Values& v) {
                     if (v.ear) acoustics::write_level(*v.ear, json);
                   })
          .written({}, [](JsonWriter& json, const Values& v) {
            if (v.computed) {
              json.member("backend", word_of(backend_words, v.computed->backend));
              json.member("backend_why", v.computed->why);
            }
            json.key("timing_ms").begin_object().member("total", v.total_ms);
            for (const auto& [stage, ms] : v.times)
              json.member(stage, ms);
            json.end_object();
          });
  return rows;
}

std::string to_json(const TouchValues& values) {
  return touch_rows().text(values);
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
