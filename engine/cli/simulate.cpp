#include "cli/simulate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <glm/ext/matrix_transform.hpp>
#include <iterator>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "acoustics/air.hpp"
#include "acoustics/bodies/body_mesh.hpp"
#include "acoustics/bodies/finger_field.hpp"
#include "acoustics/bodies/finger_transfer.hpp"
#include "acoustics/bodies/radiation.hpp"
#include "acoustics/bodies/rigid_body.hpp"
#include "acoustics/field/incident.hpp"
#include "array/board_mesh.hpp"
#include "base/error.hpp"
#include "base/json_writer.hpp"
#include "base/log.hpp"
#include "base/output_file.hpp"
#include "base/words.hpp"
#include "cli/commands.hpp"
#include "cli/felt.hpp"
#include "cli/touch_picture.hpp"
#include "geometry/files/load_triangles.hpp"
#include "geometry/files/vtu.hpp"
#include "sensing/synthetic.hpp"
#include "session/links/plan.hpp"
#include "session/previews/skin_pressure.hpp"
#include "session/watch/pressure_log.hpp"
#include "setup/assets.hpp"
#include "setup/body.hpp"
#include "setup/load.hpp"
#include "setup/nearest_skin.hpp"
#include "setup/options.hpp"
#include "setup/progress.hpp"
#include "setup/touch_input.hpp"
#include "setup/touch_run.hpp"
#include "setup/touch_schedule.hpp"
#include "setup/values.hpp"
#include "setup/warnings.hpp"

namespace palpa::cli {
namespace {

constexpr Word<Skin> skin_words[] = {{"vertices", Skin::vertices}, {"cameras", Skin::cameras}};

void add_options(CLI::App& app, SimulateCommand& o) {
  const setup::Group group(app, "What touches what");
  group.text("--scene", o.scene, "FILE", "glTF model: the solids, in world coordinates");
  group.integer("--gltf-scene", o.gltf_scene, 0, 1u << 30, "scene of that file, if not its default one");
  group.text("--finger", o.finger, "FILE", "the finger, a closed PLY or glTF mesh: tip at the origin, body along +y");
  add_allow_outside(group, o.common);
  group.quantity("--penetration", o.penetration_m, Quantity::length, {-10, 10},
                 "how far below the solids' top the finger's lowest point is");
  group.choice("--skin", o.skin, skin_words,
               "what touches: the mesh's vertices, or what the rig's cameras see of it, simulated");
  group.flag("--noise-free", o.noise_free, "cameras without the sensor's noise");
  group.flag("--figure6", o.figure6,
             "in place of --scene: the paper's four objects, by every method, with the paper's finger");
  group.flag("--force", o.force, "take a finger that is too coarse for the wavelength, too");
  const setup::Group results(app, "Results");
  results.text("--csv", o.csv, "FILE|-", "face,x,y,z,area,langevin,squared of every face: time averages in Pa");
  results.text("--vtu", o.vtu, "FILE", "the same on the finger for ParaView");
  results.text("--png", o.png, "FILE", "pictures from below: where the foci are, and the pressure");
  setup::add_solid_options(app, o.solids);
  setup::add_touch_options(app, o.touch);
  setup::add_felt_options(app, o.in_time);
  setup::add_rig_options(app, o.rig);
  setup::add_drive_options(app, o.drive, setup::FingerMesh::known);
  setup::add_air_options(app, o.air);
}

/// The skin points are the mesh's vertices, each once, in the file's order.
setup::TouchInput skin_of(const geometry::Mesh& finger, double dy) {
  setup::TouchInput input;
  const std::vector<std::uint32_t> first = geometry::weld_indices(finger.positions);
  for (std::uint32_t v = 0; v < first.size(); ++v) {
    if (first[v] != v) continue;
    const auto index = static_cast<std::uint32_t>(input.points.size());
    input.points.push_back({glm::vec3(finger.positions[v] + Vec3(0, dy, 0)), index});
  }
  input.point_count = input.points.size();
  return input;
}

/// What the rig's cameras see of the mesh, the array's boards in their way.
setup::TouchInput seen_skin(const SimulateCommand& o, const setup::PosedRig& rig, const geometry::Mesh& finger,
                            double dy) {
  if (rig.rig.cameras.empty()) throw bad_input(rig.rig.file, "has no [[camera]]; --skin cameras is what they see");
  sensing::FrameSet seen;
  const sensing::Posed posed{&finger, glm::translate(Transform(1.0), Vec3(0, dy, 0)), o.finger};
  sensing::SyntheticRig(rig.rig.cameras, array::board_mesh(rig.layout),
                        o.noise_free ? sensing::Noise::none : sensing::Noise::d415, o.common.seed)
      .render({&posed, 1}, 0, seen);
  setup::TouchInput input;
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
                                   const setup::TouchInput& skin) {
  std::string line = "the finger touches nothing there";
  if (const auto nearest = setup::nearest_skin(solids, skin)) {
    line += fmt::format(": its skin is {:.1f} mm {} the surface of {}{}", nearest->distance_m * 1e3,
                        nearest->inside ? "below" : "away from", solids[nearest->solid].name,
                        nearest->inside ? ", deeper than its shell" : "");
  }
  throw bad_input(scene, line + "; give another --penetration");
}

}  // namespace

Finger::Finger(const SimulateCommand& o, const acoustics::Air& air)
    : given_(geometry::load_triangles(o.finger)),
      body_(setup::load_body(o.finger, air, o.force)),
      wave_number_(air.wave_number()) {}

std::shared_ptr<const acoustics::RigidBody> Finger::standing(double dy) {
  geometry::Mesh moved = body_;
  for (Vec3& p : moved.positions)
    p.y += dy;
  return standing_.of(moved, wave_number_);
}

namespace {

/// What the sound on a finger is asked for, once it is known where it stands.
struct OnFinger {
  std::shared_ptr<const acoustics::RigidBody> body;
  std::optional<acoustics::FingerTransfer> transfer;  ///< with --transfer finger
  std::optional<acoustics::FingerField> field;        ///< of spectra and tuning, unless spots are asked for

  /// All in the world; the layout outlives it.
  OnFinger(const SimulateCommand& o, std::shared_ptr<const acoustics::RigidBody> standing, const array::Layout& layout,
           const acoustics::Air& air, const array::DriveOptions& drive)
      : body(std::move(standing)) {
    // Without absorption, as in the solvers.
    if (!setup::asks_for_finger(o.drive).empty())
      transfer.emplace(*body, layout, acoustics::without_absorption(air), o.drive.directivity);
    if ((o.in_time.spectrum || o.touch.tune) && !o.touch.spot_m)
      field.emplace(*body, layout, air, drive, transfer ? &*transfer : nullptr, o.drive.pressure_pa);
  }
};

/// The plan, driven anew for what its foci are on that finger.
session::Plan focused_on(acoustics::FingerTransfer& finger, session::Plan plan, const array::Layout& layout,
                         const array::DriveOptions& options, Felt& felt) {
  std::vector<Vec3> foci;
  for (const std::optional<Vec3>& focus : felt.foci) {
    if (focus) foci.push_back(*focus);
  }
  const std::size_t placed = foci.size();
  for (std::uint32_t v = 0; v < plan.schedule.voice_count; ++v)
    foci.insert(foci.end(), plan.schedule.voices[v].foci.begin(), plan.schedule.voices[v].foci.end());
  felt.aimed = finger.aim(foci);
  felt.aimed.resize(placed);
  array::Loudness loudness(layout, options);
  session::SlotWork work;
  array::DriveScratch scratch;
  session::drive_on_host(plan, layout, options, work, &loudness, scratch);
  return plan;
}

}  // namespace

Felt feel(const SimulateCommand& o, Finger& finger, const std::string& scene, std::vector<geometry::Solid> solids,
          touch::Method method) {
  Felt felt;
  felt.method = method;
  setup::Stopwatch watch;
  const acoustics::Air air = setup::air(o.drive.medium, o.air);
  const double dy = setup::lowering(solids, finger.as_given().positions, o.penetration_m);
  felt.tip = Vec3(0, dy, 0);
  felt.body = finger.body();
  for (Vec3& p : felt.body.positions)
    p.y += dy;
  const setup::PosedRig rig = setup::load_posed_rig(o.rig);
  const setup::TouchInput skin =
      o.skin == Skin::cameras ? seen_skin(o, rig, finger.as_given(), dy) : skin_of(finger.as_given(), dy);
  setup::TouchArray array{.layout = rig.layout,
                          .drive = setup::drive_options(o.drive, method, setup::FingerMesh::known),
                          .pressure_pa = o.drive.pressure_pa};
  check(o.drive, solids);
  acoustics::check_clear_of(o.finger, felt.body, array.layout);
  setup::warn_of_reach(array.layout, solids);
  setup::warn_of_frequency(array.layout, array.drive.medium);
  log::release_warnings();
  felt.times.emplace_back("load", watch.lap_ms());
  array::DriveOptions drive = array.drive;
  std::optional<OnFinger> sound;
  const auto stand = [&] {
    watch.lap_ms();
    sound.emplace(o, finger.standing(dy), rig.layout, air, drive);
    felt.times.emplace_back("operator", watch.lap_ms());
    if (sound->field) array.field = &*sound->field;
  };
  if (o.in_time.spectrum || o.touch.tune) stand();

  setup::TouchOptions touch = o.touch;
  touch.method.method = method;
  const setup::OneTouch one =
      setup::touch_once(o.common, touch, o.in_time, scene, std::move(solids), skin, std::move(array), felt.times);
  if (one.touch.finger_count == 0) refuse_untouched(scene, one.session.solids(), skin);
  felt.foci = foci_of(one.session);
  if (!sound) stand();
  watch.lap_ms();
  session::Plan focused;
  if (sound->transfer) {
    drive.transfer = &*sound->transfer;
    focused = focused_on(*sound->transfer, one.session.plan(), rig.layout, drive, felt);
    felt.times.emplace_back("focus", watch.lap_ms());
  }
  const session::Plan& plan = sound->transfer ? focused : one.session.plan();
  felt.unreached = session::unreached(plan.schedule, one.session.solid_names());
  const session::Sounds sounds = session::sounds_of(plan, rig.layout, drive);
  const acoustics::Incident incident(rig.layout, air, o.drive.directivity);
  felt.pressure = session::mean_pressure(sounds, incident, air, *sound->body);
  felt.times.emplace_back("pressure", watch.lap_ms());
  if (o.in_time.spectrum || o.touch.tune) {
    const std::span<const session::ScheduledFinger> fingers = one.session.scheduler().fingers();
    felt.fingers.assign(fingers.begin(), fingers.end());
    for (std::uint32_t f = 0; f < one.touch.finger_count; ++f)
      felt.touched.push_back(one.session.solids()[one.touch.fingers[f].solid].name);
  }
  if (o.in_time.spectrum) {
    felt.spectra = setup::spectra_of(one.session);
    felt.times.emplace_back("spectrum", watch.lap_ms());
  }
  felt.langevin = acoustics::spot_of(felt.body, felt.pressure.langevin);
  felt.squared = acoustics::spot_of(felt.body, felt.pressure.squared);
  felt.load = acoustics::load_on(felt.body, felt.pressure.langevin, felt.tip);
  if (o.figure6)
    felt.bare_elongation = session::bare_elongation(sounds, incident, one.touch.fingers[0].section.centroid);
  return felt;
}

namespace {

void add_spot(JsonWriter& json, const char* name, const acoustics::Spot& spot) {
  json.key(name)
      .begin_object()
      .member("peak_pa", spot.peak_pa)
      .member("peak_m", spot.peak_at)
      .member("half_area_m2", spot.half_area_m2)
      .member("half_radius_m", spot.half_radius_m)
      .member("elongation", spot.elongation)
      .end_object();
}

/// As the foci: null for an empty sector.
void add_aimed(JsonWriter& json, const Felt& felt) {
  json.key("aimed_m").begin_array();
  std::size_t next = 0;
  for (const std::optional<Vec3>& focus : felt.foci) {
    if (focus) {
      json.value(felt.aimed[next++]);
    } else {
      json.null();
    }
  }
  json.end_array();
}

/// As a touch has them: an object for each finger.
void add_in_time(JsonWriter& json, const Felt& felt) {
  json.key("fingers").begin_array(JsonWriter::Style::block);
  for (std::size_t f = 0; f < felt.fingers.size(); ++f) {
    json.begin_object().member("solid", felt.touched[f]);
    add_felt(json, felt.fingers[f], felt.spectra.empty() ? nullptr : &felt.spectra[f]);
    json.end_object();
  }
  json.end_array();
}

}  // namespace

void add_felt(JsonWriter& json, const SimulateCommand& o, const Felt& felt) {
  json.key("finger")
      .begin_object()
      .member("faces", std::uint64_t{felt.body.triangles.size()})
      .member("vertices", std::uint64_t{felt.body.positions.size()})
      .end_object();
  json.member("method", word_of(touch::method_words, felt.method)).member("penetration_m", o.penetration_m);
  json.key("foci_m").begin_array();
  for (const std::optional<Vec3>& focus : felt.foci) {
    if (focus) {
      json.value(*focus);
    } else {
      json.null();
    }
  }
  json.end_array();
  if (!felt.aimed.empty()) add_aimed(json, felt);
  add_spot(json, "langevin", felt.langevin);
  add_spot(json, "squared", felt.squared);
  json.member("force_N", felt.load.force).member("torque_Nm", felt.load.torque);
  if (!felt.fingers.empty()) add_in_time(json, felt);
  json.key("timing_ms").begin_object();
  for (const auto& [stage, ms] : felt.times)
    json.member(stage, ms);
  json.end_object();
}

namespace {

std::string to_json(const SimulateCommand& o, const Felt& felt) {
  JsonWriter json;
  json.begin_object();
  add_felt(json, o, felt);
  json.end_object();
  return json.take();
}

void write_csv(const std::string& file, const Felt& felt) {
  OutputFile csv(file);
  csv.write("face,x,y,z,area,langevin,squared\n");
  for (std::size_t face = 0; face < felt.body.triangles.size(); ++face) {
    const Vec3 at = acoustics::face_centroid(felt.body, face);
    csv.write(fmt::format("{},{},{},{},{},{},{}\n", face, at.x, at.y, at.z, acoustics::face_area(felt.body, face),
                          felt.pressure.langevin[face], felt.pressure.squared[face]));
  }
  csv.finish();
}

void write_vtu(const std::string& file, const Felt& felt) {
  geometry::VtuCells cells{.shape = geometry::VtuCells::Shape::triangle, .corners = {}};
  for (const glm::uvec3& t : felt.body.triangles)
    cells.corners.insert(cells.corners.end(), {t.x, t.y, t.z});
  const std::vector<float> langevin(felt.pressure.langevin.begin(), felt.pressure.langevin.end());
  const std::vector<float> squared(felt.pressure.squared.begin(), felt.pressure.squared.end());
  const geometry::VtuValues values[]{{"langevin (Pa)", langevin}, {"squared (Pa)", squared}};
  geometry::write_vtu(file, felt.body.positions, cells, {}, values);
}

std::string spot_line(const char* name, const acoustics::Spot& spot) {
  const Vec3 at = spot.peak_at * 1e3;
  return fmt::format(
      "{}: at most {:.4g} Pa, at ({:.2f}, {:.2f}, {:.2f}) mm; above half of it {:.1f} mm2, as a disc of "
      "radius {:.2f} mm, elongation {:.2f}\n",
      name, spot.peak_pa, at.x, at.y, at.z, spot.half_area_m2 * 1e6, spot.half_radius_m * 1e3, spot.elongation);
}

std::string summary(const Felt& felt) {
  double ms = 0;
  for (const auto& stage : felt.times)
    ms += stage.second;
  return fmt::format("{} faces, {}, {} foci ({:.2f} s)\n", felt.body.triangles.size(),
                     word_of(touch::method_words, felt.method), felt.foci.size(), ms / 1e3) +
         spot_line("radiation pressure", felt.langevin) + spot_line("|p|^2 / (4 rho c^2)", felt.squared) +
         fmt::format("force ({:.3g}, {:.3g}, {:.3g}) N\n", felt.load.force.x, felt.load.force.y, felt.load.force.z) +
         felt_lines(felt.fingers, felt.spectra) + (felt.beyond_linear() ? setup::linear_line() : "");
}

void check(const SimulateCommand& o) {
  setup::check(o.touch);
  setup::check(o.in_time, o.touch);
  if (o.skin != Skin::cameras) {
    if (o.noise_free) throw bad_usage("--noise-free goes with --skin cameras");
    setup::refuse_finger_width(o.touch, "--skin cameras");
  }
  if (o.figure6) {
    if (!o.scene.empty() || !o.csv.empty() || !o.vtu.empty() || o.gltf_scene ||
        o.touch.method.method != touch::Method{})
      throw bad_usage(
          "--figure6 is the paper's objects by every method: --scene, --method, --csv and --vtu are of one touch");
    if (o.solids.surface != geometry::SurfaceKind::mesh || o.solids.parts || o.solids.internal_faces)
      throw bad_usage("--surface, --parts and --internal-faces go with --scene: --figure6 has the meshes themselves");
    return;
  }
  if (o.scene.empty()) throw bad_usage("--scene is missing: give the glTF model that is touched, or --figure6");
  if (o.finger.empty())
    throw bad_usage("--finger is missing: give the finger's closed mesh, such as assets/finger.ply");
}

void run_one(const SimulateCommand& o) {
  const Outputs outputs({{"--json", o.common.json}, {"--csv", o.csv}, {"--vtu", o.vtu}, {"--png", o.png}});
  std::optional<setup::Preparing> progress(std::in_place, o.common.quiet);
  std::vector<geometry::Solid> solids = setup::load_solids(o.scene, o.gltf_scene, o.solids);
  Box all;
  for (const geometry::Solid& solid : solids)
    all.add(solid.bounds.high);
  Finger finger(o, setup::air(o.drive.medium, o.air));
  const Felt felt = feel(o, finger, o.scene, std::move(solids), o.touch.method.method);
  progress.reset();
  if (felt.unreached) log::warning(*felt.unreached);
  if (!o.csv.empty()) write_csv(o.csv, felt);
  if (!o.vtu.empty()) write_vtu(o.vtu, felt);
  if (!o.png.empty()) {
    drawing::write_png(
        o.png, side_by_side({foci_picture(felt, all.high.y, "Foci"), pressure_picture(felt, "Radiation pressure")}, 2));
  }
  if (!o.common.json.empty()) write_file(o.common.json, to_json(o, felt));
  if (setup::shows_summary(o.common, outputs)) write_file("-", summary(felt));
}

void run(const SimulateCommand& given) {
  check(given);
  SimulateCommand o = given;
  if (o.figure6 && o.finger.empty()) o.finger = setup::find_asset("finger.ply");
  if (o.figure6) {
    run_figure6(o);
  } else {
    run_one(o);
  }
}

}  // namespace

void add_simulate(Program& program) {
  add_subcommand<SimulateCommand>(
      program,
      {"simulate", "the radiation pressure on a finger that touches a model",
       "  palpa simulate --scene assets/cube.glb --finger assets/finger.ply --penetration 3mm --csv pressure.csv\n"
       "  palpa simulate --scene assets/pyramid.glb --finger assets/finger.ply --method single-focus --json -\n"
       "  palpa simulate --figure6 --png figure6.png --json figure6.json\n"
       "A rigid finger, linear sound; pressures are time averages over the schedule. Coordinates in the world."},
      add_options, run);
}

}  // namespace palpa::cli
