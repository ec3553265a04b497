// The paper's Fig. 6: the finger in each of its objects, as pictures and as a table.
#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/log.hpp"
#include "base/output_file.hpp"
#include "cli/simulate.hpp"
#include "cli/touch_picture.hpp"
#include "geometry/gltf/gltf.hpp"
#include "setup/assets.hpp"
#include "setup/progress.hpp"
#include "setup/warnings.hpp"

namespace palpa::cli {
namespace {

/// `turned`: a quarter about y, so that the prism's ridge runs along x.
struct Object {
  const char* name;
  const char* asset;
  bool turned = false;
};
constexpr Object objects[]{{"cube", "cube.glb"},
                           {"semi-sphere", "semi-sphere.glb"},
                           {"pyramid", "pyramid.glb"},
                           {"prism", "prism.glb"},
                           {"prism-along-x", "prism.glb", true}};

struct Entry {
  const char* object;
  Felt felt;
};

std::vector<geometry::Solid> solids_of(const Object& object) {
  geometry::Scene scene = geometry::load_gltf(setup::find_asset(object.asset));
  for (geometry::SceneMesh& part : scene.meshes) {
    if (!object.turned) continue;
    part.copy.reset();
    for (Vec3& p : part.mesh.positions)
      p = Vec3(p.z, p.y, -p.x);
  }
  return geometry::make_solids(scene);
}

std::string table(const std::vector<Entry>& entries) {
  std::string text = fmt::format("{:<14} {:<14} {:>9} {:>8} {:>8} {:>8} {:>9} {:>9} {:>8}\n", "object", "method",
                                 "peak Pa", "half mm2", "radius", "elongat.", "of bare", "of |p|^2", "force mN");
  for (const auto& [object, felt] : entries) {
    fmt::format_to(
        std::back_inserter(text), "{:<14} {:<14} {:>9.0f} {:>8.1f} {:>8.2f} {:>8.2f} {:>9.2f} {:>9.2f} {:>8.1f}\n",
        object, word_of(touch::method_words, felt.method), felt.langevin.peak_pa, felt.langevin.half_area_m2 * 1e6,
        felt.langevin.half_radius_m * 1e3, felt.langevin.elongation, felt.langevin.elongation / felt.bare_elongation,
        felt.squared.elongation, glm::length(felt.load.force) * 1e3);
  }
  return text;
}

std::string to_json(const SimulateCommand& o, const std::vector<Entry>& entries) {
  JsonWriter json;
  json.begin_array(JsonWriter::Style::block);
  for (const auto& [object, felt] : entries) {
    json.begin_object().member("object", object);
    add_felt(json, o, felt);
    json.member("bare_elongation", felt.bare_elongation).end_object();
  }
  json.end_array();
  return json.take();
}

}  // namespace

void run_figure6(const SimulateCommand& o) {
  const Outputs outputs({{"--json", o.common.json}, {"--png", o.png}});
  std::optional<setup::Preparing> progress(std::in_place, o.common.quiet);
  Finger finger(o, setup::air(o.drive.medium, o.air));
  std::vector<Entry> entries;
  std::vector<drawing::Pixels> foci, pressures;
  for (const auto& [word, method] : touch::method_words) {
    for (const Object& object : objects) {
      entries.push_back({object.name, feel(o, finger, object.asset, solids_of(object), method)});
      if (method != touch::Method::cross_section || o.png.empty()) continue;
      foci.push_back(halved(foci_picture(entries.back().felt, 0, object.name)));
      pressures.push_back(halved(pressure_picture(entries.back().felt, object.name)));
    }
  }
  progress.reset();
  const auto quiet = std::ranges::find_if(entries, [](const Entry& entry) { return entry.felt.unreached.has_value(); });
  if (quiet != entries.end()) log::warning(*quiet->felt.unreached);
  if (!o.png.empty()) {
    const auto columns = static_cast<std::uint32_t>(foci.size());
    foci.insert(foci.end(), pressures.begin(), pressures.end());
    drawing::write_png(o.png, side_by_side(foci, columns));
  }
  if (!o.common.json.empty()) write_file(o.common.json, to_json(o, entries));
  if (!setup::shows_summary(o.common, outputs)) return;
  const bool loud = std::ranges::any_of(entries, [](const Entry& entry) { return entry.felt.beyond_linear(); });
  write_file("-", table(entries) + (loud ? setup::linear_line() : ""));
}

}  // namespace palpa::cli
