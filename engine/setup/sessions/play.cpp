#include "setup/sessions/play.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <utility>

#include "base/error.hpp"
#include "base/log.hpp"
#include "base/text.hpp"
#include "base/units.hpp"
#include "drawing/path_picture.hpp"
#include "line/together.hpp"
#include "session/control/osc.hpp"
#include "session/links/spec.hpp"
#include "session/threads.hpp"
#include "setup/files/assets.hpp"
#include "setup/options/warnings.hpp"
#include "setup/sessions/live_run.hpp"
#include "setup/sessions/tracker.hpp"

namespace palpa::setup {
namespace {

bool is_record(const std::string& link) {
  return session::parse_spec(link).name == "record";
}

/// Whether devices can compute the drives of a plan from its foci.
bool goes_ahead(const PlayOptions& o) {
  return o.drive.weighting == array::Weighting::uniform;
}

/// Whole periods, at least so long.
double at_least(double slot_s, double period_s) {
  constexpr double rounding = 1e-9;
  return std::ceil(slot_s / period_s * (1 - rounding)) * period_s;
}

std::optional<Vec3> place_of(const PlayOptions& o) {
  if (o.at.empty()) return std::nullopt;
  const auto [x, y, z] = line::parse_point("--at", o.at);
  return Vec3(x, y, z);
}

}  // namespace

void add_parameters(const line::Group& group, std::vector<std::string>& parameters) {
  group.texts("--param", parameters, "NAME=VALUE",
              "value of a parameter of the pattern; give it again for more of them [the pattern's]");
}

void add_play_options(CLI::App& app, PlayOptions& o) {
  const line::Group what(app, "What to play");
  add_parameters(what, o.parameters);
  what.number("--speed", o.speed, {0, 100}, "NUMBER",
              "multiplies the pattern's own speed; brushes and modulations keep theirs");
  what.quantity("--duration", o.duration_s, Quantity::time, line::positive(1e6),
                "how long it plays [to the pattern's stop]");
  what.quantity("--dwell", o.dwell_s, Quantity::time, {least_slot_s, most_slot_s},
                "how long each place lasts [16 in one turn of the fastest brush or modulation, at most 1.5ms]");
  const line::Group where(app, "Where it plays");
  where.point("--at", o.at,
              "where the middle of the pattern is in the layout's own frame, instead of its own height [as it says]");
  where.choice("--on", o.on, on_words,
               "plays on that joint of a tracked hand and turns with the palm, or where a finger touches the scene");
  where.flag("--upright", o.upright, "with --on: keeps the array's axes");
  where.text("--source", o.source, "SOURCE",
             "with --on: joints:udp:PORT or joints:FILE; with --on finger, any source of palpa run");
  add_scene(where, o.scene, o.gltf_scene);
  where.quantity("--hold", o.hold_s, Quantity::time, line::positive(10),
                 "with --on: how long it sounds on after the newest frame of the hand");
  add_allow_outside(where, o.common);
  const line::Group to(app, "Where it goes");
  add_link(to, o);
  add_safety(to, o.safety, &o.ceiling_known);
  to.text("--osc", o.osc, "PORT|ADDRESS:PORT",
          "takes gain and mute from other programs, as OSC messages by UDP (docs/live-control.md) [no messages]",
          [](const std::string& text) { session::parse_osc_address(text); });
  to.text("--csv", o.csv, "FILE|-", "writes the slots: time_s,x_m,y_m,z_m,gain");
  to.text("--png", o.png, "FILE", "draws the path, and the intensity over time");
  add_rig_options(app, o.rig);
  const line::Group drives(app, "Drives");
  drives.choice("--amplitude", o.drive.weighting, array::weighting_words,
                "amplitude that a focus asks of each transducer, by its distance or all the same");
  add_medium_options(app, o.drive.medium);
  line::need(app, {"--upright", "--source", "--hold"}, "--on");
  line::need(app, {"--scene"}, "--source");
  line::need(app, {"--gltf-scene", "--allow-outside"}, "--scene");
  line::exclude(app, "--at", {"--on"});
}

void check(const PlayOptions& o) {
  if (o.names.size() != 1)
    throw bad_usage(fmt::format("give one sensation: a pattern's file, or {}", fmt::join(sensation_names(), ", ")));
  if (o.on && o.source.empty())
    throw bad_usage("--on needs --source: joints:udp:PORT, joints:FILE, or with --on finger a depth camera");
  if (o.on && o.on != On::finger && !is_tracker(o.source))
    throw bad_usage("--on goes with a tracker of hands, --source joints:udp:PORT; depth cameras have --on finger");
  if (o.on && (o.on == On::finger) != !o.scene.empty())
    throw bad_usage(o.on == On::finger ? "--on finger needs --scene: the object that the finger touches"
                                       : "--scene goes with --on finger: it is what the finger touches");
  if (o.on && (!o.csv.empty() || !o.png.empty()))
    throw bad_usage("--csv and --png know no hand: leave --on out, or give --link alone");
  if (const std::optional<Vec3> at = place_of(o); at && !array::drivable({.position = *at}))
    throw bad_usage("--at is farther than 100 m from the array");
}

bool is_offline(const PlayOptions& o) {
  return !o.on && (is_record(o.link) || (o.link == "null" && (!o.csv.empty() || !o.png.empty())));
}

std::vector<Output> outputs_of(const PlayOptions& o, std::span<const session::LinkKind> links) {
  std::vector<Output> outputs = outputs_of(static_cast<const LiveOptions&>(o), links);
  outputs.insert(outputs.end(), {{"--csv", o.csv}, {"--png", o.png}});
  return outputs;
}

std::vector<std::string> sensation_names() {
  return {"circle", "heartbeat", "lateral", "point", "sweep"};
}

sensation::Pattern load_sensation(const std::string& name_or_file) {
  std::error_code ignored;
  const std::vector<std::string> names = sensation_names();
  if (std::ranges::find(names, name_or_file) != names.end())
    return sensation::load_pattern(find_asset("sensations/" + name_or_file + ".adaptics"));
  if (name_or_file.find_first_of("/.") == std::string::npos && !std::filesystem::exists(name_or_file, ignored)) {
    throw bad_input(name_or_file,
                    fmt::format("neither a file nor a known sensation; known: {}", fmt::join(names, ", ")));
  }
  return sensation::load_pattern(name_or_file);
}

void check_parameter(const std::string& where, const std::string& name, double value,
                     const sensation::Pattern& pattern) {
  const std::optional<std::uint32_t> index = pattern.parameter(name);
  if (!index) {
    std::vector<std::string> known;
    for (const sensation::Parameter& parameter : pattern.parameters)
      known.push_back(printable(parameter.name, 40));
    throw bad_usage(fmt::format("{}: {} has no parameter '{}'; {}", where, pattern.file, printable(name, 40),
                                known.empty() ? "it has none" : fmt::format("it has {}", fmt::join(known, ", "))));
  }
  const sensation::Parameter& parameter = pattern.parameters[*index];
  if (const double used = std::clamp(value, parameter.low, parameter.high); used != value) {
    log::warning(fmt::format("{}: {} is {} to {}, so it is {:g} and not {:g}", where, printable(name, 40),
                             parameter.low, parameter.high, used, value));
  }
}

std::map<std::string, double> parameters_of(std::span<const std::string> texts, const sensation::Pattern& pattern) {
  std::map<std::string, double> values;
  for (const std::string& text : texts) {
    const std::size_t equals = std::min(text.rfind('='), text.size());
    const std::optional<double> value = parse_number(std::string_view(text).substr(std::min(equals + 1, text.size())));
    if (!value)
      throw bad_usage(
          fmt::format("--param: '{}' is not NAME=VALUE with a finite number, such as rate=80", printable(text, 60)));
    const std::string name = text.substr(0, equals);
    check_parameter("--param", name, *value, pattern);
    values[name] = *value;
  }
  return values;
}

double usual_slot(double fastest_hz, double period_s) {
  constexpr double rounding = 1e-9;
  const double wanted_s =
      fastest_hz > 0 ? std::min(1 / (slots_in_a_turn * fastest_hz), longest_own_slot_s) : longest_own_slot_s;
  return std::max(std::floor(wanted_s / period_s * (1 + rounding)), 1.0) * period_s;
}

double playable(double fastest_hz, const std::string& who) {
  if (fastest_hz <= sensation::most_hz) return fastest_hz;
  throw bad_input(who, fmt::format("has a brush or a modulation of {:g} Hz; palpa plays at most {:g} Hz", fastest_hz,
                                   sensation::most_hz));
}

Playing::Playing(PlacedLayout array, const PlayOptions& o)
    : placed(std::move(array)),
      posed(array::transformed(placed.layout, placed.T_world_layout)),
      setting{.output = {posed, drive_options(o.drive, posed, Solving::by_slot), 0, o.hold_s, o.safety, nullptr},
              .T_world_array = placed.T_world_layout,
              .upright = o.upright,
              .end_s = o.duration_s,
              .seed = o.common.seed} {
  setting.at_m = place_of(o);  // may throw: among the others, GCC 14 warns of what would be undone
}

std::unique_ptr<Playing> prepare_play(const PlayOptions& o, double fastest_hz, const std::string& who,
                                      std::span<const session::LinkKind> links) {
  playable(fastest_hz, who);
  session::check_board_files(o.link, links, o.board_files);
  if (o.steps_given) session::check_takes_steps(o.link, links);
  RigOptions rig = o.rig;
  take_layout_of_link(rig, o.link, links);
  auto playing = std::make_unique<Playing>(load_placed_layout(rig), o);
  const array::Layout& layout = playing->posed;
  check_frequency(layout, playing->setting.output.drive.medium);
  const auto [name, argument] = session::parse_spec(o.link);
  const session::LinkKind& kind = session::find_kind(links, name, "link");
  const double period_s = 1 / layout.frequency_hz;
  playing->setting.listed = kind.plays_plans && goes_ahead(o);
  double least_s = at_least(session::least_moving_slot_s(o.link, links, layout), period_s);
  if (least_s > 0) least_s = std::ceil(1e3 * least_s - 1e-6) * 1e-3;
  const double single_s =
      kind.plays_plans && !playing->setting.listed && kind.single_drive_s ? kind.single_drive_s(layout) : 0;
  least_s = std::max(least_s, single_s);
  const double usual_s = usual_slot(fastest_hz, period_s);
  double& slot_s = playing->setting.output.slot_s;
  slot_s = o.dwell_s.value_or(std::max(usual_s, least_s));
  if (single_s > usual_s) {
    log::warning(fmt::format("--link {}: with --amplitude distance, each drive is sent by itself, every {:g} ms",
                             o.link, 1e3 * slot_s));
  }
  const double in_a_turn = session::places_in_a_turn(fastest_hz, slot_s);
  if (in_a_turn < session::least_places) {
    throw bad_usage(
        fmt::format("{} has a brush or a modulation of {:g} Hz, and places of {:g} ms cannot follow it: {}", who,
                    fastest_hz, 1e3 * slot_s,
                    o.dwell_s && *o.dwell_s > least_s
                        ? fmt::format("give a --dwell of at most {:g} ms", 1e3 * usual_s)
                        : fmt::format("--link {} takes so long for each, so a sensation has at most {:.3g} Hz there",
                                      o.link, 1 / (session::least_places * slot_s))));
  }
  if (!o.dwell_s && least_s > usual_s && fastest_hz > 0) {
    log::warning(
        fmt::format("--link {}: takes {:g} ms for each place: one turn of {:g} Hz has {:.3g} of them instead "
                    "of {:g}",
                    o.link, 1e3 * least_s, fastest_hz, in_a_turn, slots_in_a_turn));
  } else if (o.dwell_s && in_a_turn < session::few_places) {
    log::warning(fmt::format("--dwell {:g} ms: one turn of {:g} Hz has {:.3g} places; give at most {:g} ms",
                             1e3 * slot_s, fastest_hz, in_a_turn, 1e3 * usual_s));
  }
  return playing;
}

std::vector<sensation::Point> offline_points(sensation::Sensation& sensation, const session::SensationSetting& setting,
                                             const std::string& who) {
  const double slot_s = setting.output.slot_s;
  const std::uint64_t most = std::min(most_offline_slots, static_cast<std::uint64_t>(most_offline_s / slot_s));
  std::vector<sensation::Point> points = session::points_of_slots(sensation, setting, most + 1);
  if (points.size() > most) {
    throw bad_usage(fmt::format("{} plays for more than {} slots of {:g} ms: give a --duration of at most {:g}s", who,
                                most, 1e3 * slot_s, static_cast<double>(most) * slot_s));
  }
  return points;
}

std::string sensation_csv(std::span<const sensation::Point> points, const session::SensationSetting& setting) {
  std::string text = "time_s,x_m,y_m,z_m,gain\n";
  for (std::size_t slot = 0; slot < points.size(); ++slot) {
    const Vec3 at = session::placed(points[slot], setting, {});
    fmt::format_to(std::back_inserter(text), "{},{},{},{},{}\n", static_cast<double>(slot) * setting.output.slot_s,
                   at.x, at.y, at.z, points[slot].gain);
  }
  return text;
}

drawing::Pixels sensation_picture(std::span<const sensation::Point> points, const session::SensationSetting& setting,
                                  const std::string& title) {
  std::vector<Vec2> places;
  std::vector<double> gains;
  for (const sensation::Point& point : points) {
    places.push_back(1e3 * Vec2(session::placed(point, setting, {})));
    gains.push_back(point.gain);
  }
  const double length_s = static_cast<double>(points.size()) * setting.output.slot_s;
  return drawing::draw(
      drawing::PathPicture{.places_mm = places,
                           .intensities = gains,
                           .length_s = length_s,
                           .title = title,
                           .notes = {fmt::format("{}, one in each {:g} ms; the darker, the stronger",
                                                 counted(points.size(), "place"), 1e3 * setting.output.slot_s)}});
}

session::OutputStats play(const PlayOptions& o, sensation::Sensation& sensation, session::SensationControl& control,
                          Playing& playing, std::span<const sensation::Point> offline,
                          std::span<const session::SourceKind> sources, std::span<const session::LinkKind> links,
                          std::atomic<bool>& stop) {
  session::SensationSetting& setting = playing.setting;
  std::optional<session::Osc> osc;
  if (!o.osc.empty()) setting.output.safety.gain_now = &osc.emplace(o.osc).gain();
  // Before a device starts its threads. Without one, this thread is ahead of what sounds, and may wait.
  if (o.on == On::finger) session::go_first();
  session::HandPlace hand;
  std::optional<HandFollower> follower;
  const std::vector<std::string> no_solids;
  session::LinkSetting link_setting{playing.posed, no_solids, setting.output.slot_s};
  link_setting.sound_speed_m_s = setting.output.drive.medium.sound_speed;
  link_setting.ramp_s = o.safety.ramp_s;
  link_setting.board_files = o.board_files;
  link_setting.steps = o.steps == Steps::on;
  link_setting.free_field = goes_ahead(o);
  HandFollower::Follow follow;
  if (o.on) follow = open_hand(*o.on, o, sources, setting.T_world_array, hand);
  const std::unique_ptr<session::Link> link = session::open_link(o.link, links, link_setting);
  if (o.on) {  // from now on, the time of a file goes on
    setting.hand = &hand;
    follower.emplace(std::move(follow), hand, stop);
  }
  if (is_offline(o)) return session::record_sensation(offline, *link, setting, stop);
  warn_of_full_amplitude(o, o.link, *link);
  if (osc) osc->listen();
  const session::OutputStats stats = session::run_sensation(sensation, control, *link, setting, stop);
  if (follower) follower->end();
  if (osc) osc->end();
  return stats;
}

}  // namespace palpa::setup
