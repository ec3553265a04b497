#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "acoustics/bodies/radiation.hpp"
#include "array/layouts/layout.hpp"
#include "base/error.hpp"
#include "base/files/output_file.hpp"
#include "cli/commands.hpp"
#include "drawing/arrange.hpp"
#include "drawing/line_picture.hpp"
#include "drawing/png.hpp"
#include "experiment/afferents_task.hpp"
#include "line/together.hpp"
#include "line/values.hpp"
#include "setup/files/assets.hpp"
#include "setup/files/finger_picture.hpp"
#include "setup/options/options.hpp"
#include "setup/process/progress.hpp"
#include "setup/sessions/load.hpp"
#include "touch/types.hpp"

namespace palpa::cli {
namespace {

/// The site whose skin each face of the body is; -1 beyond the sites' faces.
std::vector<std::int64_t> sites_of_faces(const experiment::AfferentsResult& result) {
  std::vector<std::int64_t> sites(result.body.triangles.size(), -1);
  for (const std::uint32_t face : result.sites.faces) {
    const Vec3 centroid = acoustics::face_centroid(result.body, face);
    sites[face] = static_cast<std::int64_t>(observer::nearest_site(result.sites, centroid));
  }
  return sites;
}

drawing::Pixels rates_picture(const experiment::AfferentsResult& result, const setup::SeenFromBelow& seen,
                              const std::vector<std::int64_t>& site_of_face, std::size_t kind) {
  std::vector<double> values(setup::below_side * setup::below_side, std::numeric_limits<double>::quiet_NaN());
  double most = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (seen.face[i] < 0) continue;
    const std::int64_t site = site_of_face[static_cast<std::size_t>(seen.face[i])];
    if (site < 0) continue;
    values[i] = result.rates_hz[static_cast<std::size_t>(site)][kind];
    most = std::max(most, values[i]);
  }
  return setup::draw_from_below(
      values, result.class_name(kind) + ": rates",
      {fmt::format("{:.0f} afferents, {:.0f} % of them fire", result.afferents[kind], 100 * result.active[kind])},
      most > 0 ? most : 1, "spikes per second");
}

drawing::Pixels times_picture(const experiment::AfferentsResult& result, std::size_t kind) {
  // A line needs two values.
  std::vector<double> values;
  for (const experiment::ByClass& spikes : result.spikes)
    values.push_back(spikes[kind] / result.bin_s);
  if (values.size() == 1) values.push_back(values.front());
  drawing::LinePicture picture;
  picture.values = values;
  picture.length_mm = static_cast<double>(result.spikes.size()) * result.bin_s * 1e3;
  picture.along = "time";
  picture.along_unit = "ms";
  picture.title = result.class_name(kind) + ": all afferents";
  picture.notes = {fmt::format("in bins of {:g} ms", result.bin_s * 1e3)};
  picture.most = std::max(1.0, *std::ranges::max_element(values));
  picture.unit = "spikes per second";
  return drawing::draw(picture);
}

/// The afferents' response as a picture: above, a map of rates for each class, seen from below the finger; below, the
/// spikes of the class over time.
drawing::Pixels afferents_picture(const experiment::AfferentsResult& result) {
  const setup::SeenFromBelow seen(result.body, Vec3(0));
  const std::vector<std::int64_t> sites = sites_of_faces(result);
  std::vector<drawing::Pixels> pictures;
  for (std::size_t kind = 0; kind < observer::afferent_classes; ++kind)
    pictures.push_back(drawing::halved(rates_picture(result, seen, sites, kind)));
  for (std::size_t kind = 0; kind < observer::afferent_classes; ++kind)
    pictures.push_back(drawing::halved(times_picture(result, kind)));
  return drawing::side_by_side(pictures, observer::afferent_classes);
}

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
