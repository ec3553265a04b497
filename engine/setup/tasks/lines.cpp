#include "setup/tasks/lines.hpp"

#include <fmt/format.h>

#include <limits>

#include "array/layouts/layout.hpp"
#include "base/error.hpp"
#include "base/words.hpp"
#include "line/values.hpp"
#include "setup/tasks/foci.hpp"

namespace palpa::setup {
namespace {

constexpr Word<Skin> skin_words[] = {{"vertices", Skin::vertices}, {"cameras", Skin::cameras}};

std::string layout_help() {
  return fmt::format("the array: {} or a TOML", array::known_layouts());
}

}  // namespace

void add_options(CLI::App& app, TouchLine& o) {
  add_touch_input(app, o.input);
  const line::Group group(app, "What touches what");
  add_allow_outside(group, o.common);
  group.text("--csv", o.csv, "FILE|-", "writes the contacts: index,x,y,z,depth,finger,solid");
  add_touch_options(app, o.task.touch);
  add_felt_options(app, o.task.felt);
  add_array_options(app, o.task.array);
}

void settle(TouchLine& o) {
  o.task.compute = o.common;
  check(o.input);
  check(o.task, !o.input.depths.empty());
}

void add_options(CLI::App& app, DriveLine& o) {
  const line::Group group(app, "What to drive");
  group.text("--layout", o.task.layout, "NAME|FILE", layout_help());
  group.texts("--focus", o.task.foci, "X,Y,Z[,A]", focus_help, check_focus_text);
  group.text("--touch", o.task.touch, "FILE",
             "drives the foci of a touch that palpa touch --json wrote, instead of --focus");
  group.integer("--slot", o.task.slot, 0, std::numeric_limits<std::int32_t>::max(),
                "with --touch: slot of the schedule, counted from 0 [0]");
  group.text("--rig", o.task.rig, "FILE", "with --touch: TOML file with the array's pose [the layout's default pose]");
  group.text("--mesh", o.task.mesh, "FILE",
             "with --transfer finger: the finger, a closed PLY or glTF mesh in the layout's frame");
  add_allow_outside(group, o.common);
  group.flag("--force", o.task.force, "also takes a finger whose faces are too coarse for the wavelength");
  group.text("--csv", o.csv, "FILE|-", "writes every transducer: index,x,y,z,nx,ny,nz,amplitude,phase");
  add_spread_options(app, o.task.spread);
  add_drive_options(app, o.task.drive, FingerMesh::known);
}

void settle(DriveLine& o) {
  check(o.task);
}

void add_options(CLI::App& app, FieldLine& o) {
  const line::Group group(app, "What sounds");
  group.text("--layout", o.task.layout, "NAME|FILE", layout_help());
  group.text("--drive", o.task.drive_file, "FILE", "the array's drive, as palpa drive --csv writes it");
  group.texts("--focus", o.task.foci, "X,Y,Z[,A]", fmt::format("instead of --drive: {}", focus_help), check_focus_text);
  add_place_options(app, o.task.place);
  const line::Group results(app, "Results");
  results.text("--csv", o.csv, "FILE|-",
               "writes every point: x,y,z,re,im in metres and Pa; with --spread also p05,p50,p95 of |p|");
  results.text("--vtu", o.vtu, "FILE", "writes the same for ParaView, with amplitude and phase");
  results.text("--png", o.png, "FILE",
               "draws |p|: on a plane with a bar in Pa, along a line as a curve; axes are in mm");
  add_drive_options(app, o.task.drive);
  add_air_options(app, o.task.air);
  add_spread_options(app, o.task.spread);
}

void settle(FieldLine& o) {
  check(o.task, !o.png.empty());
}

void add_options(CLI::App& app, SimulateLine& o) {
  const line::Group group(app, "What touches what");
  group.text("--scene", o.scene, "FILE", "glTF model whose meshes can be touched");
  add_gltf_scene(group, o.gltf_scene);
  group.text("--finger", o.finger, "FILE",
             "the finger, a closed PLY or glTF mesh with its tip at the origin and its body along +y");
  add_allow_outside(group, o.common);
  group.quantity("--penetration", o.task.penetration_m, Quantity::length, {-most_penetration_m, most_penetration_m},
                 "how far the finger's lowest point is below the solids' top");
  group.choice("--skin", o.task.skin, skin_words,
               "which skin touches, the mesh's vertices or what the rig's cameras would see of the mesh");
  group.flag("--noise-free", o.task.noise_free, "with --skin cameras: cameras without the sensor's noise");
  group.flag("--figure6", o.figure6,
             "simulates the paper's four objects with the paper's finger and every method, instead of --scene");
  group.flag("--force", o.force, "also takes a finger whose faces are too coarse for the wavelength");
  const line::Group results(app, "Results");
  results.text("--csv", o.csv, "FILE|-", "writes every face: face,x,y,z,area,langevin,squared, time averages in Pa");
  results.text("--vtu", o.vtu, "FILE", "writes the same on the finger, for ParaView");
  results.text("--png", o.png, "FILE", "draws the finger from below, with its foci and its pressure");
  add_solid_options(app, o.solids);
  add_touch_options(app, o.task.touch);
  add_felt_options(app, o.task.in_time);
  add_rig_options(app, o.task.rig);
  add_drive_options(app, o.task.drive, FingerMesh::known);
  add_air_options(app, o.task.air);
  add_spread_options(app, o.task.spread);
}

void settle(SimulateLine& o) {
  o.task.compute = o.common;
  check(o.task);
  if (o.figure6) {
    if (!o.scene.empty() || !o.csv.empty() || !o.vtu.empty() || o.gltf_scene || !o.task.spread.text.empty() ||
        o.task.touch.method.method != touch::Method{})
      throw bad_usage(
          "--figure6 computes the paper's objects by every method: --scene, --method, --csv, --vtu and --spread belong "
          "to a single touch");
    if (o.solids.surface != geometry::SurfaceKind::mesh || o.solids.parts || o.solids.internal_faces)
      throw bad_usage("--surface, --parts and --internal-faces go with --scene: --figure6 uses the meshes themselves");
    return;
  }
  if (o.scene.empty()) throw bad_usage("--scene is missing: give the glTF model that is touched, or --figure6");
  if (o.finger.empty())
    throw bad_usage("--finger is missing: give the finger's closed mesh, such as assets/finger.ply");
}

}  // namespace palpa::setup
