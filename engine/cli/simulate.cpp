#include "cli/simulate.hpp"

#include <fmt/format.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "base/files/output_file.hpp"
#include "base/log.hpp"
#include "base/text.hpp"
#include "base/words.hpp"
#include "cli/commands.hpp"
#include "cli/felt.hpp"
#include "drawing/arrange.hpp"
#include "line/together.hpp"
#include "line/values.hpp"
#include "setup/files/assets.hpp"
#include "setup/options/options.hpp"
#include "setup/options/warnings.hpp"
#include "setup/process/progress.hpp"
#include "setup/sessions/load.hpp"
#include "setup/tasks/simulate_picture.hpp"

namespace palpa::cli {
namespace {

void add_options_of_simulate(CLI::App& app, SimulateCommand& o) {
  const line::Group group(app, "What touches what");
  setup::add_scene(group, o.scene, o.gltf_scene);
  setup::add_finger(group, o.finger);
  setup::add_allow_outside(group, o.common);
  group.quantity("--penetration", o.task.penetration_m, Quantity::length,
                 {-setup::most_penetration_m, setup::most_penetration_m},
                 "how far the finger's lowest point is below the solids' top");
  group.choice("--skin", o.task.skin, setup::skin_words,
               "which skin touches, the mesh's vertices or what the rig's cameras would see of the mesh");
  group.flag("--noise-free", o.task.noise_free, "with --skin cameras: cameras without the sensor's noise");
  group.flag("--figure6", o.figure6,
             "simulates the paper's four objects with the paper's finger and every method, instead of --scene");
  group.flag("--force", o.force, "also takes a finger whose faces are too coarse for the wavelength");
  const line::Group results(app, "Results");
  results.text("--csv", o.csv, "FILE|-", "writes every face: face,x,y,z,area,langevin,squared, time averages in Pa");
  results.text("--vtu", o.vtu, "FILE", "writes the same on the finger, for ParaView");
  results.text("--png", o.png, "FILE", "draws the finger from below, with its foci and its pressure");
  setup::add_solid_options(app, o.solids);
  setup::add_task_options(app, o.task);
  line::exclude(app, "--figure6",
                {"--scene", "--gltf-scene", "--method", "--csv", "--vtu", "--spread", "--surface", "--parts",
                 "--internal-faces"});
}

std::string spot_line(const char* name, const acoustics::Spot& spot) {
  const Vec3 at = spot.peak_at * 1e3;
  return fmt::format(
      "{}: at most {:.4g} Pa, at ({:.2f}, {:.2f}, {:.2f}) mm; above half of it {:.1f} mm2, as a disc of "
      "radius {:.2f} mm, elongation {:.2f}\n",
      name, spot.peak_pa, at.x, at.y, at.z, spot.half_area_m2 * 1e6, spot.half_radius_m * 1e3, spot.elongation);
}

/// The range of a number in another unit.
std::string range_in(const setup::Percentiles& range, double unit, int digits) {
  return setup::range_text({range.p05 / unit, range.p50 / unit, range.p95 / unit}, digits);
}

std::string spread_lines(const setup::SimulateSpread& spread) {
  const auto spot = [](const char* name, const setup::SpotSpread& one) {
    return fmt::format("{} as built: at most {} Pa; above half of it {} mm2, elongation {}\n", name,
                       setup::range_text(one.peak_pa, 0), range_in(one.half_area_m2, 1e-6, 1),
                       setup::range_text(one.elongation, 2));
  };
  const auto& force = spread.force;
  return spot("radiation pressure", spread.langevin) + spot("|p|^2 / (4 rho c^2)", spread.squared) +
         fmt::format("force as built ({}, {}, {}) mN\n", range_in(force[0], 1e-3, 2), range_in(force[1], 1e-3, 2),
                     range_in(force[2], 1e-3, 2)) +
         spread_line(spread.draws);
}

std::string summary_of_simulate(const setup::SimulateResult& result) {
  double ms = 0;
  for (const auto& stage : result.times)
    ms += stage.second;
  const Vec3& force = result.load.force;
  return fmt::format("{}, {}, {} ({:.2f} s)\n", counted(result.body.triangles.size(), "face"),
                     word_of(touch::method_words, result.method), counted(result.foci.size(), "focus"), ms / 1e3) +
         spot_line("radiation pressure", result.langevin) + spot_line("|p|^2 / (4 rho c^2)", result.squared) +
         fmt::format("force ({:.3g}, {:.3g}, {:.3g}) N\n", force.x, force.y, force.z) +
         (result.spread ? spread_lines(*result.spread) : "") + felt_lines(result.fingers, result.spectra) +
         (result.beyond_linear() ? setup::linear_line() : "");
}

void run_one(const SimulateCommand& o) {
  const Outputs outputs({{"--json", o.common.json}, {"--csv", o.csv}, {"--vtu", o.vtu}, {"--png", o.png}});
  std::optional<setup::Preparing> progress(std::in_place, o.common.quiet);
  std::vector<geometry::Solid> solids = setup::load_solids(o.scene, o.gltf_scene, o.solids);
  setup::FingerBody finger = load_finger(o);
  const setup::SimulateResult result = setup::simulate(o.task, finger, o.scene, std::move(solids));
  progress.reset();
  if (result.unreached) log::warning(*result.unreached);
  if (!o.csv.empty()) write_file(o.csv, to_csv(result));
  if (!o.vtu.empty()) write_vtu(o.vtu, result);
  if (!o.png.empty()) {
    drawing::write_png(
        o.png, drawing::side_by_side(
                   {foci_picture(result, result.top_m, "Foci"), pressure_picture(result, "Radiation pressure")}, 2));
  }
  if (!o.common.json.empty()) write_file(o.common.json, to_json(result));
  if (setup::shows_summary(o.common, outputs)) write_file("-", summary_of_simulate(result));
}

void run_simulate(const SimulateCommand& given) {
  SimulateCommand o = given;
  o.task.compute = o.common;
  check(o.task);
  if (o.figure6) {
    if (o.finger.empty()) o.finger = setup::find_asset("finger.ply");
    return run_figure6(o);
  }
  if (o.scene.empty()) throw bad_usage("--scene is missing: give the glTF model that is touched, or --figure6");
  if (o.finger.empty())
    throw bad_usage("--finger is missing: give the finger's closed mesh, such as assets/finger.ply");
  run_one(o);
}

}  // namespace

setup::FingerBody load_finger(const SimulateCommand& o) {
  return setup::FingerBody(o.finger, setup::air(o.task.drive.medium, o.task.air), o.force);
}

void add_simulate(Program& program) {
  add_subcommand<SimulateCommand>(
      program,
      {"simulate", "the radiation pressure on a finger that touches a model",
       "  palpa simulate --scene assets/cube.glb --finger assets/finger.ply --penetration 3mm \\\n"
       "                 --png pressure.png\n"
       "  palpa simulate --figure6 --png figure6.png --json figure6.json",
       "--scene --finger --penetration --method --foci --layout --skin --spectrum --csv --png",
       "The finger is rigid and the sound linear. Pressures are averages over the schedule. Coordinates are in the "
       "world."},
      add_options_of_simulate, run_simulate);
}

}  // namespace palpa::cli
