#include "setup/sessions/frames.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <string_view>
#include <utility>

#include "array/layouts/board_mesh.hpp"
#include "base/error.hpp"
#include "base/files/reference.hpp"
#include "base/log.hpp"
#include "base/text.hpp"
#include "sensing/surroundings.hpp"
#include "session/links/sources.hpp"
#include "setup/files/assets.hpp"
#include "setup/files/body.hpp"
#include "setup/options/nulls.hpp"
#include "setup/options/warnings.hpp"
#include "setup/process/progress.hpp"
#include "setup/sessions/session_setting.hpp"
#include "setup/sessions/touch_schedule.hpp"
#include "setup/sessions/tracker.hpp"

namespace palpa::setup {

namespace {

std::unique_ptr<sensing::DepthSource> open_source(const FrameOptions& o, std::span<const session::SourceKind> more,
                                                  const PosedRig& rig, bool paced) {
  if (o.points) return std::make_unique<session::PushedPoints>(*o.points);
  const std::vector<session::SourceKind> sources = with_builtin(more);
  const geometry::Mesh boards = array::board_mesh(rig.layout);
  return session::open_source(o.source, sources,
                              {.cameras = rig.rig.cameras,
                               .occluders = boards,
                               .default_skin = find_asset("finger.ply"),
                               .noise = !o.noise_free,
                               .seed = o.common.seed,
                               .paced = paced,
                               .rig = rig.rig.file,
                               .T_world_joints = rig.rig.T_world_joints.value_or(Transform(1.0))});
}

/// The smallest finger, and the largest number of unknowns that are solved ten times a second.
constexpr double least_finger_m = 15e-3;
constexpr std::size_t most_finger_vertices = 3000;

/// The mesh of --transfer finger.
std::optional<session::FollowedFinger> finger_of(const FrameOptions& o) {
  const std::string asks = asks_for_finger(o.drive);
  if (asks.empty()) return std::nullopt;
  session::FollowedFinger finger;
  finger.name = o.finger.empty() ? find_asset("finger.ply") : o.finger;
  finger.air = acoustics::without_absorption(air(o.drive.medium, {}));
  finger.body = load_body(finger.name, finger.air, false);
  const Box box = geometry::bounds(finger.body);
  if (std::abs(box.low.y) > 1e-3 || box.high.y < least_finger_m || box.low.x > 0 || box.high.x < 0 || box.low.z > 0 ||
      box.high.z < 0) {
    throw bad_input(finger.name,
                    fmt::format("{}: a finger's tip must be at the origin, and its body at least {:.0f} mm "
                                "long along +y; its y goes from {:.1f} to {:.1f} mm",
                                asks, 1e3 * least_finger_m, 1e3 * box.low.y, 1e3 * box.high.y));
  }
  if (finger.body.positions.size() > most_finger_vertices) {
    throw bad_input(finger.name, fmt::format("{}: {} vertices take too long to follow a finger with; give at most {}",
                                             asks, finger.body.positions.size(), most_finger_vertices));
  }
  return finger;
}

}  // namespace

session::SessionSetting session_setting(const FrameOptions& o, std::vector<geometry::Solid> solids,
                                        std::vector<sensing::Camera> cameras, array::Layout layout, FingerMesh mesh) {
  const bool unpredicted = !asks_for_finger(o.drive).empty() || (o.points && !o.predict_latency_s);
  session::ScheduleOptions schedule = schedule_options(o.touch);
  schedule.voice.pressure_pa = o.drive.pressure_pa;
  schedule.own_method = o.own_method;
  array::DriveOptions drive = drive_options(o.drive, layout, solving_of(o.touch.method.method), mesh);
  prepare_nulls(o.drive, layout, drive);
  return {.scene = o.scene,
          .solids = std::move(solids),
          .cameras = std::move(cameras),
          .layout = std::move(layout),
          .keep_boards = o.keep_boards,
          .touch = o.touch.parameters,
          .schedule = schedule,
          .drive = std::move(drive),
          .own_solver = o.own_solver,
          .finger = finger_of(o),
          .events = o.events.empty() && !o.watched ? std::nullopt : std::optional(o.event),
          .feel_may_change = o.feel_may_change,
          .axes = o.axes,
          .smoothing = o.smoothing,
          .hysteresis = o.chosen_hysteresis(),
          .predict = {o.predict.value_or(unpredicted ? session::Predict::off : session::Predict::automatic),
                      o.predict_latency_s},
          .hold_s = o.hold_s,
          .lengthens_hold = o.hold_auto,
          .safety = o.safety};
}

namespace {

/// Throws bad_input if there can be no skin near any solid, and warns of solids with a part that nobody can touch.
void check_surroundings(const session::SessionSetting& setting, const sensing::Rig& rig) {
  if (setting.pushed) return;  // points are skin wherever they are
  if (rig.room) {
    const Box& room = rig.room->box;
    Box solids;
    const bool inside = std::ranges::any_of(setting.solids, [&](const geometry::Solid& solid) {
      solids.add(solid.bounds.low);
      solids.add(solid.bounds.high);
      return solid.bounds.overlaps(room);
    });
    if (!inside) {
      throw bad_input(rig.room->where,
                      fmt::format("the room contains no solid, so nothing could be touched: the solids of {} lie from "
                                  "({:.3g}, {:.3g}, {:.3g}) to ({:.3g}, {:.3g}, {:.3g}) m",
                                  setting.scene, solids.low.x, solids.low.y, solids.low.z, solids.high.x, solids.high.y,
                                  solids.high.z));
    }
  }
  if (!setting.tracked) warn_of_surroundings(session::surroundings_of(setting), setting.solids);
}

std::unique_ptr<session::Session> make_session(const gpu::Device* device, session::SessionSetting setting) {
  auto session = device ? std::make_unique<session::Session>(*device, std::move(setting))
                        : std::make_unique<session::Session>(std::move(setting));
  warn_of_feel(*session);
  return session;
}

}  // namespace

std::vector<session::SourceKind> with_builtin(std::span<const session::SourceKind> more) {
  return added_to(session::builtin_sources(), more);
}

void add_frame_options(const line::Group& group, FrameOptions& o, const char* until) {
  add_scene(group, o.scene, o.gltf_scene);
  group.text("--source", o.source, "SOURCE",
             "where depth frames come from: synthetic[:MESH], recording:DIR, v4l2:/dev/videoN[,...], "
             "realsense:SERIAL[,...] or bag:FILE; or a tracker of hands, joints:udp:PORT or joints:FILE, with a "
             "--delta of 3mm unless you give it");
  group.integer("--frames", o.frames, 0, std::uint64_t{1} << 62, until);
  add_allow_outside(group, o.common);
  add_loop_options(group, o);
}

void add_safety(const line::Group& group, session::Safety& safety, bool* ceiling_given) {
  group.number("--ceiling", safety.ceiling, {0, 1}, "NUMBER",
               "multiplies every transducer's amplitude, 0 to 1; the pressure that skin feels follows its square",
               ceiling_given);
  group.quantity("--ramp", safety.ramp_s, Quantity::time, {0, session::most_ramp_s},
                 "time in which sound gets to full strength when a touch begins, and to silence when it ends");
}

bool is_loud_by_default(const FrameOptions& o) {
  return !o.ceiling_known && o.safety.ceiling == 1 && !o.drive.pressure_pa;
}

void warn_of_full_amplitude(const FrameOptions& o, const std::string& name, const session::Link& link) {
  if (!link.boards() || !is_loud_by_default(o)) return;
  log::warning(
      fmt::format("--link {}: plays at full amplitude, because no --ceiling is given; --ceiling 0.3 makes it quieter, "
                  "to a tenth of the strength that skin feels (--ceiling 1: as loud, without this warning)",
                  name));
}

void add_loop_options(const line::Group& group, FrameOptions& o) {
  add_hold(group, o.hold_s, o.hold_auto);
  add_safety(group, o.safety, &o.ceiling_known);
  group.flag("--noise-free", o.noise_free, "renders synthetic frames without the sensor's noise");
  group.flag("--keep-boards", o.keep_boards,
             "what cameras see on the array's boards counts as skin; without this option, palpa drops it");
  group.text("--events", o.events, "-|FILE|udp:HOST:PORT",
             "writes a line of JSON when a finger touches, moves on, presses or releases (docs/files.md) [no events]");
  group.quantity("--event-move", o.event.move_m, Quantity::length, {0, 1},
                 "with --events: how far a finger moves before this is an event; 0 writes every frame");
}

void add_session_options(CLI::App& app, FrameOptions& o, FingerMesh mesh, const char* foci) {
  add_solid_options(app, o.solids);
  add_rig_options(app, o.rig);
  add_touch_options(app, o.touch, foci);
  add_drive_options(app, o.drive, mesh);
  if (mesh == FingerMesh::known) {
    const line::Group group(app, "Drives");
    add_null_option(group, o.drive, "the world");
    group.text(
        "--finger", o.finger, "FILE",
        "with --transfer finger: the fingers that touch, a closed PLY or glTF mesh with its tip at the origin and "
        "its body along +y [assets/finger.ply]");
  }
  add_following_options(app, o);
}

void add_following_options(CLI::App& app, FrameOptions& o) {
  const line::Group steadily(app, "From frame to frame");
  steadily.choice("--axes", o.axes, touch::axes_words,
                  "axes of a cross-section, turned as little as possible from frame to frame, or each frame's "
                  "principal axes");
  steadily.choice("--smoothing", o.smoothing, touch::smoothing_words,
                  "filter that keeps foci from jumping from frame to frame");
  steadily.choice("--hysteresis", o.hysteresis, touch::hysteresis_words,
                  "whether a finger of the last frame stays one until the evidence against it is strong [on, but off "
                  "with --axes covariance --smoothing none]");
  steadily.choice("--predict", o.predict, session::predict_words,
                  "whether foci sound where their finger will be at that time [auto]");
  steadily.quantity("--predict-latency", o.predict_latency_s, Quantity::time, {0, session::most_ahead_s},
                    "time from a frame's capture to its sound for which fingers are predicted; needed if it cannot be "
                    "measured: in palpa export, and with --every-frame [measured]");
}

void FrameOptions::refuse_unmeasured_prediction(const char* who) const {
  if (predict.value_or(session::Predict::off) == session::Predict::off || predict_latency_s) return;
  throw bad_usage(
      fmt::format("--predict auto: {} have no latency that could be measured, so nothing is predicted; give "
                  "--predict-latency, for example 20ms",
                  who));
}

void FrameOptions::leave_out_unmeasured_prediction() {
  if (!predict_latency_s) predict = session::Predict::off;
}

void check(const FrameOptions& o) {
  if (o.scene.empty()) throw bad_usage("--scene is missing: give a glTF model, such as assets/cube.glb");
  check(o.touch);
  if (o.hysteresis && o.touch.parameters.finger_width_m == 0) {
    throw bad_usage(
        "--hysteresis goes with a --finger-width above 0: like splitting and joining, it looks at the depth images");
  }
  if (const std::string asks = asks_for_finger(o.drive);
      !asks.empty() && (o.predict == session::Predict::automatic || o.predict_latency_s)) {
    throw bad_usage(asks +
                    " computes foci where the skin was seen, so they are not predicted: leave out --predict and "
                    "--predict-latency");
  }
  if (!o.finger.empty() && asks_for_finger(o.drive).empty())
    throw bad_usage("--finger goes with --transfer finger: foci are otherwise computed in free air");
  if (o.touch.spot_m && !o.touch.tune) throw bad_usage("--spot goes with --tune");
  if (o.events.empty() && !o.watched && o.event.move_m != session::EventOptions().move_m)
    throw bad_usage("--event-move goes with --events: it sets how far a finger moves before that is an event");
  if (o.predict == session::Predict::off && o.predict_latency_s)
    throw bad_usage("--predict-latency goes with --predict auto: with off, nothing is predicted");
  // `mouse` belongs to the viewer.
  const auto rendered = [&](std::string_view kind) {
    return o.source.starts_with(kind) && (o.source.size() == kind.size() || o.source[kind.size()] == ':');
  };
  if (o.noise_free && !rendered("synthetic") && !rendered("mouse")) {
    throw bad_usage("--noise-free goes with --source synthetic: recordings and cameras have their own noise");
  }
  if (is_tracker(o.source)) refuse_image_options(o);
}

Prepared prepare(const FrameOptions& o, std::span<const session::SourceKind> sources, bool paced, FingerMesh mesh) {
  const Preparing preparing(o.common.quiet);
  allow_outside_references(o.common.allow_outside);  // in the viewer, the next run may differ from the last
  std::vector<geometry::Solid> solids = o.made_solids ? *o.made_solids : load_solids(o.scene, o.gltf_scene, o.solids);
  check(o.drive, solids);
  const PosedRig rig = load_posed_rig(o.rig);
  if (o.keep_boards && rig.layout.boards.empty()) {
    throw bad_usage(fmt::format("--keep-boards: the array {} has no boards to keep, only single transducers",
                                printable(rig.layout.name, 60)));
  }
  std::unique_ptr<sensing::DepthSource> source = open_source(o, sources, rig, paced);
  warn_of_reach(rig.layout, solids);
  session::SessionSetting setting = session_setting(o, std::move(solids), source->cameras(), rig.layout, mesh);
  if (is_tracker(o.source)) take_tracker(o, setting);
  setting.pushed = o.points.has_value();
  setting.surroundings = sensing::surroundings_of(rig.rig);
  check_surroundings(setting, rig.rig);
  UsedDevice device(o.common);
  auto session = make_session(device.get(), std::move(setting));
  return {std::move(source), std::move(device), std::move(session)};
}

std::unique_ptr<session::Session> prepare_again(const FrameOptions& o, const gpu::Device* device,
                                                session::SessionSetting setting) {
  setting.solids = load_solids(o.scene, o.gltf_scene, o.solids);
  check(o.drive, setting.solids);
  warn_of_reach(setting.layout, setting.solids);
  check_surroundings(setting, load_posed_rig(o.rig).rig);
  return make_session(device, std::move(setting));
}

void try_source(const FrameOptions& o, std::span<const session::SourceKind> sources) {
  (void)open_source(o, sources, load_posed_rig(o.rig), true);
}

std::string pressures_summary(std::span<const session::FingerPressure> fingers, std::span<const std::string> solids) {
  std::string text;
  double most_pa = 0;
  for (const session::FingerPressure& finger : fingers) {
    most_pa = std::max(most_pa, finger.most_pa);
    const double mean_pa = finger.sum_pa / static_cast<double>(finger.frames);
    text += fmt::format("finger {} on {}: {:.0f} Pa on average, {:.0f} to {:.0f} Pa, of the {:.0f} Pa asked for\n",
                        finger.id, solids[finger.solid], mean_pa, finger.least_pa, finger.most_pa, finger.asked_pa);
  }
  return most_pa > array::linear_pressure_pa ? text + linear_line() : text;
}

void finish(session::EventSink* sink, bool after_error) {
  try {
    if (sink) sink->finish();
  } catch (const std::exception&) {
    if (!after_error) throw;
  }
}

void warn_of_left_out_fingers(const touch::Touch& touch, bool& warned) {
  if (touch.cluster_count <= touch.finger_count || std::exchange(warned, true)) return;
  log::warning(fmt::format("{} of {} clusters of contacts are left out: palpa uses at most {} of a frame",
                           touch.cluster_count - touch.finger_count, touch.cluster_count, touch::max_fingers));
}

}  // namespace palpa::setup
