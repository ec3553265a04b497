#include "geometry/parts/decompose.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/activity.hpp"
#include "base/error.hpp"
#include "base/json_writer.hpp"
#include "base/log.hpp"
#include "base/output_file.hpp"
#include "cli/commands.hpp"
#include "geometry/gltf/gltf.hpp"
#include "geometry/gltf/write.hpp"
#include "geometry/solid.hpp"
#include "geometry/text.hpp"
#include "setup/options.hpp"
#include "setup/progress.hpp"
#include "setup/values.hpp"

namespace palpa::cli {
namespace {

struct DecomposeCommand {
  setup::CommonOptions common;
  std::string scene;
  std::optional<std::uint32_t> gltf_scene;
  std::string out;
  geometry::DecomposeOptions decompose;
  std::optional<double> error_percent;
};

void add_options(CLI::App& app, DecomposeCommand& o) {
  const setup::Group group(app, "What to take apart");
  group.text("--scene", o.scene, "FILE", "glTF model; each of its meshes that can be touched becomes parts");
  group.integer("--gltf-scene", o.gltf_scene, 0, 1'000'000, "scene of the file (default: the file's own)");
  add_allow_outside(group, o.common);
  group.text("--out", o.out, "FILE.glb|-", "the parts as glTF, which touch, run and palpa-viewer read as --scene");
  const setup::Group how(app, "How");
  how.integer("--parts", o.decompose.parts, 1, geometry::most_parts, "convex parts per solid, at most");
  how.count("--resolution", o.decompose.resolution, geometry::least_voxels, geometry::most_voxels,
            "voxels that V-HACD looks at");
  o.error_percent = o.decompose.error_percent;
  how.number("--error", o.error_percent, {0, 100, true}, "PERCENT",
             "volume by which a part may exceed its voxels before it is cut again");
}

struct Taken {
  const geometry::Solid* solid;
  geometry::Parts parts;
  geometry::PartsReport report;
  double seconds;
};

double seconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

/// std::quoted would be found, too.
std::string in_quotes(const std::string& name) {
  return geometry::text::quoted(name);
}

/// The solids to take apart, as --surface parts takes them, and open ones too. Throws bad_input for what cannot be.
std::vector<geometry::Solid> load_solids_to_decompose(const DecomposeCommand& o) {
  const std::optional<int> index = o.gltf_scene ? std::optional(static_cast<int>(*o.gltf_scene)) : std::nullopt;
  geometry::Scene scene = [&] {
    const Activity work("reads " + o.scene);
    return geometry::load_gltf(o.scene, index);
  }();
  std::erase_if(scene.meshes, [](const geometry::SceneMesh& mesh) { return !mesh.haptics.touchable; });
  if (scene.meshes.empty()) throw bad_input(scene.file, "the scene has no mesh that can be touched; give one that has");
  for (const geometry::SceneMesh& mesh : scene.meshes) {
    if (!mesh.part) continue;
    throw bad_input(scene.file, fmt::format("mesh {} is already a part of {}; give the model that it was made of",
                                            in_quotes(mesh.name), in_quotes(mesh.part->solid)));
  }
  std::vector<geometry::Solid> solids = geometry::solids_to_decompose(scene);
  for (const geometry::Solid& solid : solids) {
    if (const std::string fault = geometry::unfit_for_parts(solid.mesh); !fault.empty())
      throw bad_input(scene.file, fmt::format("mesh {} {}", in_quotes(solid.name), fault));
    if (const std::uint64_t open = geometry::find_defects(solid.mesh).open; open > 0) {
      log::warning(fmt::format("{}: mesh {} has {} open edge{}; its holes are closed before it is cut", scene.file,
                               in_quotes(solid.name), open, open == 1 ? "" : "s"));
    }
  }
  return solids;
}

std::vector<Taken> take_apart(const DecomposeCommand& o, const std::vector<geometry::Solid>& solids) {
  std::vector<Taken> all;
  for (const geometry::Solid& solid : solids) {
    const Activity work("mesh " + in_quotes(solid.name));
    const auto begin = std::chrono::steady_clock::now();
    std::optional<geometry::Parts> parts;
    try {
      parts = geometry::decompose(solid.mesh, o.decompose);
    } catch (const Error& error) {
      throw Error(error.code(), fmt::format("{}: mesh {}: {}", o.scene, in_quotes(solid.name), error.what()));
    }
    const double seconds = seconds_since(begin);
    geometry::PartsReport report = geometry::measure(solid.mesh, *parts, o.common.seed);
    all.push_back({&solid, std::move(*parts), report, seconds});
  }
  return all;
}

void write_parts(const DecomposeCommand& o, const std::vector<Taken>& all) {
  std::vector<geometry::SceneMesh> meshes;
  for (std::uint32_t s = 0; s < all.size(); ++s) {
    const Taken& taken = all[s];
    for (std::size_t i = 0; i < taken.parts.parts.size(); ++i) {
      geometry::SceneMesh mesh{fmt::format("{} part {}", taken.solid->name, i), taken.parts.parts[i].mesh,
                               taken.solid->haptics, geometry::PartOf{taken.solid->name, s, taken.parts.seam_m}};
      meshes.push_back(std::move(mesh));
    }
  }
  geometry::write_glb(o.out, meshes);
}

std::string to_json(const DecomposeCommand& o, const std::vector<Taken>& all) {
  JsonWriter json;
  json.begin_object().member("file", o.out).key("solids").begin_array(JsonWriter::Style::block);
  for (const Taken& taken : all) {
    const geometry::PartsReport& r = taken.report;
    json.begin_object(JsonWriter::Style::line).member("name", taken.solid->name).member("parts", r.parts);
    json.member("volume_m3", r.union_volume_m3).key("mesh_volume_m3");
    r.mesh_volume_m3 ? json.value(*r.mesh_volume_m3) : json.null();
    json.key("volume_ratio");
    r.volume_ratio() ? json.value(*r.volume_ratio()) : json.null();
    json.key("surface_error_m").begin_object(JsonWriter::Style::line);
    json.member("mean", r.error_mean_m).member("p95", r.error_p95_m).member("max", r.error_max_m).end_object();
    json.member("internal_area", r.internal_share).member("seconds", taken.seconds).end_object();
  }
  json.end_array().end_object();
  return json.take();
}

std::string summary(const DecomposeCommand& o, const std::vector<Taken>& all) {
  std::string text;
  for (const Taken& taken : all) {
    const geometry::PartsReport& r = taken.report;
    const auto out = std::back_inserter(text);
    fmt::format_to(out, "{}: {} part{} in {:.1f} s", taken.solid->name, r.parts, r.parts == 1 ? "" : "s",
                   taken.seconds);
    if (const auto ratio = r.volume_ratio()) fmt::format_to(out, ", {:.3f} of its volume", *ratio);
    fmt::format_to(out,
                   "\n  surface error mean {:.3g}, p95 {:.3g}, max {:.3g} mm; {:.0f} % of the parts' faces are cuts\n",
                   r.error_mean_m * 1e3, r.error_p95_m * 1e3, r.error_max_m * 1e3, r.internal_share * 100);
  }
  return text + fmt::format("written to {}\n", o.out);
}

void run(const DecomposeCommand& given) {
  DecomposeCommand o = given;
  if (o.scene.empty()) throw bad_usage("--scene is missing: give a glTF model");
  if (o.out.empty()) throw bad_usage("--out is missing: give a file such as parts.glb");
  setup::refuse_gpu_options(o.common, "palpa decompose computes on the processor");
  o.decompose.error_percent = o.error_percent.value_or(o.decompose.error_percent);
  const Outputs outputs({{"--json", o.common.json}, {"--out", o.out}});
  std::optional<setup::Preparing> preparing(std::in_place, o.common.quiet);
  const std::vector<geometry::Solid> solids = load_solids_to_decompose(o);
  log::release_warnings();
  const std::vector<Taken> all = take_apart(o, solids);
  preparing.reset();
  write_parts(o, all);
  if (!o.common.json.empty()) write_file(o.common.json, to_json(o, all));
  if (setup::shows_summary(o.common, outputs)) write_file("-", summary(o, all));
}

}  // namespace

void add_decompose(Program& program) {
  add_subcommand<DecomposeCommand>(
      program,
      {"decompose", "convex parts of a concave model, as glTF",
       "  palpa decompose --scene bunny.glb --parts 32 --out parts.glb\n"
       "  palpa touch --scene parts.glb --points assets/finger.ply --penetration 3mm\n"
       "V-HACD cuts the model; the report says how far the parts' surface lies from the model's."},
      add_options, run);
}

}  // namespace palpa::cli
