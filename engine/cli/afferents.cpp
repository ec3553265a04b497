#include <fmt/format.h>

#include <algorithm>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "array/layouts/layout.hpp"
#include "base/error.hpp"
#include "base/files/output_file.hpp"
#include "cli/commands.hpp"
#include "experiment/afferents_picture.hpp"
#include "experiment/afferents_task.hpp"
#include "line/together.hpp"
#include "line/values.hpp"
#include "setup/files/assets.hpp"
#include "setup/options/options.hpp"
#include "setup/process/progress.hpp"
#include "setup/sessions/load.hpp"
#include "touch/types.hpp"

namespace palpa::cli {
namespace {

struct AfferentsCommand {
  setup::CommonOptions common;
  std::string scene, finger, csv, times, png;
  std::optional<double> crest_mn;
  double yaw_deg = 0;
  experiment::AfferentsTask task;
};

void add_options_of_afferents(CLI::App& app, AfferentsCommand& o) {
  study::PlanMethod& m = o.task.method;
  const line::Group group(app, "What touches what");
  group.text("--scene", o.scene, "FILE", "glTF model whose meshes can be touched");
  setup::add_finger(group, o.finger, " [the paper's]");
  setup::add_allow_outside(group, o.common);
  group.quantity("--penetration", o.task.penetration_m, Quantity::length, {1e-6, 1},
                 "how far the finger's lowest point is below the solids' top");
  group.quantity("--x", o.task.place.x_m, Quantity::length, {-1, 1}, "where the finger is, along x");
  group.quantity("--z", o.task.place.z_m, Quantity::length, {-1, 1}, "where the finger is, along z");
  group.number("--yaw", o.yaw_deg, {-180, 180}, "DEGREES", "how far the finger is turned about its own axis");
  const line::Group foci(app, "Foci");
  foci.choice("--method", m.method, touch::method_words, "how contacts become foci");
  foci.integer("--foci", m.foci, 1, touch::max_foci, "foci per finger");
  foci.integer("--stride", m.stride, 1, 1u << 20, "step from each focus to the next [the usual one]");
  foci.quantity("--dwell", m.dwell_s, Quantity::time, {1e-4, 1}, "how long each focus sounds");
  foci.quantity("--modulation-frequency", m.modulation_hz, Quantity::frequency, {1, 1000},
                "frequency of the modulation of foci that stand still");
  foci.quantity("--delta", m.delta_m, Quantity::length, {1e-5, 0.1}, "thickness of the shell");
  foci.text("--layout", m.layout, "NAME|FILE", "the array: a built-in name or a layout's file");
  const line::Group level(app, "Level of pressure");
  level.number("--crest", o.crest_mn, {0.1, 1000}, "NUMBER",
               "force in mN on the finger at the crest of a single focus on the paper's cube, 3 mm deep [16]");
  level.flag("--linear", o.task.linear, "the array's linear pressures, which are not physical if they are loud");
  line::exclude(app, "--linear", {"--crest"});
  const line::Group skin(app, "Skin");
  skin.quantity("--wave-speed", o.task.wave_m_s, Quantity::speed, {1, 100},
                "how fast waves travel on the skin; measurements are from 3 to 8 m/s");
  const line::Group results(app, "Results");
  results.quantity("--duration", o.task.duration_s, Quantity::time, {0.01, 10}, "how long the touch lasts");
  results.quantity("--bin", o.task.bin_s, Quantity::time, {2e-4, 10}, "the step in which spikes are counted over time");
  results.text("--csv", o.csv, "FILE|-", "writes the map: site,x,y,z,area_cm2,sa1_hz,ra_hz,pc_hz");
  results.text("--times", o.times, "FILE|-", "writes spikes over time: time_s,sa1,ra,pc");
  results.text("--png", o.png, "FILE", "draws both");
}

std::string summary_of_afferents(const experiment::AfferentsResult& result, double duration_s) {
  std::string text = fmt::format("level {:.3g} of the linear pressures, crest of the force {:.3g} mN\n", result.factor,
                                 result.crest_n * 1e3);
  for (std::size_t kind = 0; kind < observer::afferent_classes; ++kind) {
    double spikes = 0, most = 0;
    for (const experiment::ByClass& bin : result.spikes)
      spikes += bin[kind];
    for (const experiment::ByClass& site : result.rates_hz)
      most = std::max(most, site[kind]);
    text += fmt::format(
        "{:<3}: {:.0f} afferents, {:.0f} % fire; {:.0f} spikes per second in all, at most {:.0f} at a site\n",
        result.class_name(kind), result.afferents[kind], 100 * result.active[kind], spikes / duration_s, most);
  }
  return text;
}

void run_afferents(const AfferentsCommand& given) {
  AfferentsCommand o = given;
  if (o.scene.empty()) throw bad_usage("--scene is missing: give the glTF model that is touched");
  if (o.task.method.method == touch::Method::single_focus && o.task.method.stride)
    throw bad_usage("--stride: a single focus has no order");
  if (o.crest_mn) o.task.crest_n = *o.crest_mn * 1e-3;
  o.task.place.yaw_rad = o.yaw_deg * std::numbers::pi / 180;
  check(o.task);
  const Outputs outputs({{"--json", o.common.json}, {"--csv", o.csv}, {"--times", o.times}, {"--png", o.png}});
  std::optional<setup::Preparing> progress(std::in_place, o.common.quiet);
  const std::vector<geometry::Solid> solids = setup::load_solids(o.scene);
  experiment::ObservedFinger finger(o.finger.empty() ? setup::find_asset("finger.ply") : o.finger);
  const experiment::AfferentsResult result = experiment::afferents(o.task, finger, o.scene, solids);
  progress.reset();
  if (!o.csv.empty()) write_file(o.csv, sites_csv(result));
  if (!o.times.empty()) write_file(o.times, times_csv(result));
  if (!o.png.empty()) drawing::write_png(o.png, afferents_picture(result));
  if (!o.common.json.empty()) write_file(o.common.json, to_json(result));
  if (setup::shows_summary(o.common, outputs)) write_file("-", summary_of_afferents(result, o.task.duration_s));
}

}  // namespace

void add_afferents(Program& program) {
  add_subcommand<AfferentsCommand>(
      program,
      {"afferents", "how a finger's nerves respond when it touches a model",
       "  palpa afferents --scene assets/cube.glb --penetration 3mm --png spikes.png\n"
       "  palpa afferents --scene assets/prism.glb --method single-focus --json -",
       "--scene --penetration --method --foci --layout --crest --duration --csv --times --png",
       "The afferents are those of TouchSim, with the densities of a fingertip. Positions are the finger's own: its "
       "tip is the origin. docs/afferents.md explains the model."},
      add_options_of_afferents, run_afferents, setup::Computes::on_processor);
}

}  // namespace palpa::cli
