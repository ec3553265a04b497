#include "setup/tasks/simulate.hpp"

#include <algorithm>
#include <cmath>
#include <glm/ext/matrix_transform.hpp>
#include <optional>
#include <span>
#include <utility>

#include "acoustics/bodies/body_mesh.hpp"
#include "acoustics/bodies/far_force.hpp"
#include "acoustics/bodies/finger_field.hpp"
#include "acoustics/bodies/finger_transfer.hpp"
#include "acoustics/field/incident.hpp"
#include "array/layouts/board_mesh.hpp"
#include "base/error.hpp"
#include "base/log.hpp"
#include "geometry/files/load_triangles.hpp"
#include "sensing/synthetic.hpp"
#include "session/plan/plan.hpp"
#include "session/previews/skin_pressure.hpp"
#include "session/watch/pressure_log.hpp"
#include "setup/files/body.hpp"
#include "setup/options/warnings.hpp"
#include "setup/sessions/load.hpp"
#include "setup/sessions/nearest_skin.hpp"
#include "setup/sessions/touch_input.hpp"
#include "setup/sessions/touch_run.hpp"
#include "setup/sessions/touch_schedule.hpp"
#include "setup/tasks/force_check.hpp"

namespace palpa::setup {

void add_task_options(CLI::App& app, SimulateTask& o) {
  add_touch_options(app, o.touch);
  add_felt_options(app, o.in_time);
  add_rig_options(app, o.rig);
  add_drive_options(app, o.drive, FingerMesh::known);
  add_air_options(app, o.air);
  add_spread_options(app, o.spread);
}

void check(const SimulateTask& options) {
  check(options.compute);
  check(options.touch);
  check(options.in_time, options.touch);
  if (!(std::abs(options.penetration_m) <= most_penetration_m))
    throw bad_usage("--penetration: out of range, give a length from -10 m to 10 m");
  check(options.spread, options.drive.medium);
  if (options.skin == Skin::cameras) return;
  if (options.noise_free) throw bad_usage("--noise-free goes with --skin cameras");
  refuse_finger_width(options.touch, "--skin cameras");
}

FingerBody::FingerBody(const std::string& file, const acoustics::Air& air, bool force)
    : FingerBody(file, geometry::load_triangles(file), air, force) {}

FingerBody::FingerBody(std::string name, geometry::Mesh mesh, const acoustics::Air& air, bool force)
    : name_(std::move(name)),
      given_(std::move(mesh)),
      body_(body_of(name_, given_, air, force)),
      wave_number_(air.wave_number()) {}

std::shared_ptr<const acoustics::RigidBody> FingerBody::standing(double dy) {
  geometry::Mesh moved = body_;
  for (Vec3& p : moved.positions)
    p.y += dy;
  return standing_.of(moved, wave_number_);
}

namespace {

/// The skin points are the mesh's vertices, each once, in the file's order.
TouchInput skin_of(const geometry::Mesh& finger, double dy) {
  TouchInput input;
  const std::vector<std::uint32_t> first = geometry::weld_indices(finger.positions);
  for (std::uint32_t v = 0; v < first.size(); ++v) {
    if (first[v] != v) continue;
    const auto index = static_cast<std::uint32_t>(input.points.size());
    input.points.push_back({glm::vec3(finger.positions[v] + Vec3(0, dy, 0)), index});
  }
  input.point_count = input.points.size();
  return input;
}

/// The points of the mesh that the rig's cameras see; the array's boards hide parts of it.
TouchInput seen_skin(const SimulateTask& o, const PosedRig& rig, const FingerBody& finger, double dy) {
  if (rig.rig.cameras.empty()) throw bad_input(rig.rig.file, "has no [[camera]]; --skin cameras needs one");
  sensing::FrameSet seen;
  const sensing::Posed posed{&finger.as_given(), glm::translate(Transform(1.0), Vec3(0, dy, 0)), finger.name()};
  sensing::SyntheticRig(rig.rig.cameras, array::board_mesh(rig.layout),
                        o.noise_free ? sensing::Noise::none : sensing::Noise::d415, o.compute.seed)
      .render({&posed, 1}, 0, seen);
  TouchInput input;
  input.cameras = rig.rig.cameras;
  input.frames = std::move(seen.frames);
  for (const sensing::DepthFrame& frame : input.frames)
    input.point_count += static_cast<std::uint64_t>(std::ranges::count_if(frame.depth, [](auto d) { return d != 0; }));
  return input;
}

std::vector<std::optional<Vec3>> foci_of(const session::Session& session) {
  std::vector<std::optional<Vec3>> foci;
  for (const session::ScheduledFinger& finger : session.scheduler().fingers()) {
    for (std::size_t i = 0; i < finger.placement.foci.size(); ++i) {
      foci.emplace_back();
      if (finger.placement.has(i)) foci.back() = Vec3(finger.placement.foci[i].position);
    }
  }
  return foci;
}

[[noreturn]] void refuse_untouched(const std::string& scene, std::span<const geometry::Solid> solids,
                                   const TouchInput& skin) {
  std::string line = "the finger touches nothing there";
  if (const auto nearest = nearest_skin(solids, skin)) line += ": its skin is " + place_of(*nearest, solids);
  throw bad_input(scene, line + "; give another --penetration");
}

/// The sound on a finger, once its place is known.
struct SoundThere {
  std::shared_ptr<const acoustics::RigidBody> body;
  std::optional<acoustics::FingerTransfer> transfer;  ///< with --transfer finger
  std::optional<acoustics::FingerField> field;        ///< for spectra and tuning, unless spots are requested

  /// All in the world; the layout must outlive it.
  SoundThere(const SimulateTask& o, std::shared_ptr<const acoustics::RigidBody> standing, const array::Layout& layout,
             const acoustics::Air& air, const array::DriveOptions& drive)
      : body(std::move(standing)) {
    // Without absorption, as in the solvers.
    if (!asks_for_finger(o.drive).empty())
      transfer.emplace(*body, layout, acoustics::without_absorption(air), o.drive.directivity);
    if ((o.in_time.spectrum || o.touch.tune) && !o.touch.spot_m)
      field.emplace(*body, layout, air, drive, transfer ? &*transfer : nullptr, o.drive.pressure_pa);
  }
};

/// The plan with drives for its foci on that finger.
session::Plan focused_on(acoustics::FingerTransfer& finger, session::Plan plan, const array::Layout& layout,
                         const array::DriveOptions& options, SimulateResult& result) {
  std::vector<Vec3> foci;
  for (const std::optional<Vec3>& focus : result.foci) {
    if (focus) foci.push_back(*focus);
  }
  const std::size_t placed = foci.size();
  for (std::uint32_t v = 0; v < plan.schedule.voice_count; ++v)
    foci.insert(foci.end(), plan.schedule.voices[v].foci.begin(), plan.schedule.voices[v].foci.end());
  result.aimed = finger.aim(foci);
  result.aimed.resize(placed);
  array::Loudness loudness(layout, options);
  session::SlotWork work;
  array::SlotDrives slots;
  session::drive_on_host(plan, layout, options, work, &loudness, slots);
  return plan;
}

/// Puts the finger as deep into the solids as the result says. Returns by how much its y grows.
double lower(const FingerBody& finger, std::span<const geometry::Solid> solids, SimulateResult& result) {
  const double dy = lowering(solids, finger.as_given().positions, result.penetration_m);
  result.tip = Vec3(0, dy, 0);
  result.body = finger.body();
  for (Vec3& p : result.body.positions)
    p.y += dy;
  return dy;
}

void check_array(const SimulateTask& o, const TouchArray& array, const std::vector<geometry::Solid>& solids,
                 const std::string& finger, const geometry::Mesh& body) {
  check(o.drive, solids);
  acoustics::check_clear_of(finger, body, array.layout);
  warn_of_reach(array.layout, solids);
  warn_of_frequency(array.layout, array.drive.medium);
  log::release_warnings();
}

/// The mean pressure on the finger, and the force on it; warns where the two ways to the force differ.
void put_pressure(const SimulateTask& o, const std::string& finger, const session::Sounds& sounds,
                  const array::Layout& layout, const acoustics::Air& air, const acoustics::Incident& incident,
                  const acoustics::RigidBody& body, Stopwatch& watch, SimulateResult& result) {
  std::vector<Vec3> transducers;
  for (const array::Transducer& transducer : layout.transducers)
    transducers.push_back(transducer.position);
  const std::optional<acoustics::FarForce> far = acoustics::FarForce::of(body, transducers);
  const acoustics::Incident lossless(layout, acoustics::without_absorption(air), o.drive.directivity);
  std::optional<session::FarSound> in_air;
  if (far) in_air.emplace(session::FarSound{.force = *far, .lossless = lossless});
  result.pressure = session::mean_pressure(sounds, incident, air, body, in_air ? &*in_air : nullptr);
  const double far_ms = in_air ? in_air->took_ms : 0;
  result.times.emplace_back("pressure", watch.lap_ms() - far_ms);
  result.times.emplace_back("far_force", far_ms);
  if (in_air) {
    result.far_force = in_air->mean;
    warn_of_force(finger, result.pressure, in_air->mean);
  }
  result.effort = body.effort();
}

/// What is felt over time.
void put_fingers(const SimulateTask& o, const OneTouch& one, Stopwatch& watch, SimulateResult& result) {
  const std::span<const session::ScheduledFinger> fingers = one.session.scheduler().fingers();
  result.fingers.assign(fingers.begin(), fingers.end());
  for (std::uint32_t f = 0; f < one.touch.finger_count; ++f)
    result.touched.push_back(one.session.solids()[one.touch.fingers[f].solid].name);
  if (!o.in_time.spectrum) return;
  result.spectra = spectra_of(one.session);
  result.times.emplace_back("spectrum", watch.lap_ms());
}

void put_spread(const SimulateTask& o, const session::Sounds& sounds, const array::Layout& layout,
                const std::shared_ptr<const acoustics::RigidBody>& body, Stopwatch& watch, SimulateResult& result) {
  watch.lap_ms();
  result.spread = spread_of_pressure({.sounds = sounds,
                                      .layout = layout,
                                      .directivity = o.drive.directivity,
                                      .medium = o.drive.medium,
                                      .air = o.air,
                                      .body = body,
                                      .tip = result.tip},
                                     parse_spread(o.spread.text), draws_of(o.spread, o.compute.seed));
  result.times.emplace_back("spread", watch.lap_ms());
}

}  // namespace

SimulateResult simulate(const SimulateTask& o, FingerBody& finger, const std::string& scene,
                        std::vector<geometry::Solid> solids) {
  if (solids.empty()) throw bad_input(scene, "has no solid to touch");
  SimulateResult result;
  const touch::Method method = o.touch.method.method;
  result.method = method;
  result.penetration_m = o.penetration_m;
  result.top_m = top_of(solids);
  Stopwatch watch;
  const acoustics::Air air = setup::air(o.drive.medium, o.air);
  const double dy = lower(finger, solids, result);
  const PosedRig rig = load_posed_rig(o.rig);
  const TouchInput skin = o.skin == Skin::cameras ? seen_skin(o, rig, finger, dy) : skin_of(finger.as_given(), dy);
  TouchArray array{.layout = rig.layout,
                   .drive = drive_options(o.drive, rig.layout, solving_of(method), FingerMesh::known),
                   .pressure_pa = o.drive.pressure_pa};
  check_array(o, array, solids, finger.name(), result.body);
  result.times.emplace_back("load", watch.lap_ms());
  array::DriveOptions drive = array.drive;
  std::optional<SoundThere> sound;
  const auto stand = [&] {
    watch.lap_ms();
    sound.emplace(o, finger.standing(dy), rig.layout, air, drive);
    result.times.emplace_back("operator", watch.lap_ms());
    if (sound->field) array.field = &*sound->field;
  };
  const bool in_time = o.in_time.spectrum || o.touch.tune;
  if (in_time) stand();

  const OneTouch one =
      touch_once(o.compute, o.touch, o.in_time, scene, std::move(solids), skin, std::move(array), result.times);
  if (one.touch.finger_count == 0) refuse_untouched(scene, one.session.solids(), skin);
  result.foci = foci_of(one.session);
  result.by = one.session.driven_by();
  if (!sound) stand();
  watch.lap_ms();
  session::Plan focused;
  if (sound->transfer) {
    drive.transfer = &*sound->transfer;
    focused = focused_on(*sound->transfer, one.session.plan(), rig.layout, drive, result);
    result.times.emplace_back("focus", watch.lap_ms());
  }
  const session::Plan& plan = sound->transfer ? focused : one.session.plan();
  result.unreached = session::unreached(plan.schedule, one.session.solid_names());
  const session::Sounds sounds = session::sounds_of(plan, rig.layout, drive);
  const acoustics::Incident incident(rig.layout, air, o.drive.directivity);
  put_pressure(o, finger.name(), sounds, rig.layout, air, incident, *sound->body, watch, result);
  if (in_time) put_fingers(o, one, watch, result);
  result.langevin = acoustics::spot_of(result.body, result.pressure.langevin);
  result.squared = acoustics::spot_of(result.body, result.pressure.squared);
  result.load = acoustics::about(result.tip, result.pressure.langevin_load);
  if (!o.spread.text.empty()) put_spread(o, sounds, rig.layout, sound->body, watch, result);
  if (o.bare_elongation)
    result.bare_elongation = session::bare_elongation(sounds, incident, one.touch.fingers[0].section.centroid);
  return result;
}

}  // namespace palpa::setup
