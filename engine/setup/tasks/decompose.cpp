#include "setup/tasks/decompose.hpp"

#include <fmt/format.h>

#include <chrono>
#include <utility>

#include "base/activity.hpp"
#include "base/error.hpp"
#include "base/files/json_writer.hpp"
#include "base/log.hpp"
#include "base/text.hpp"
#include "geometry/text.hpp"
#include "line/values.hpp"

namespace palpa::setup {
namespace {

using Clock = std::chrono::steady_clock;

/// Not named `quoted`, because std::quoted would also be found.
std::string in_quotes(const std::string& name) {
  return geometry::text::quoted(name);
}

/// The solids to decompose: those of --surface parts, and open ones too. Throws bad_input for solids that cannot be
/// decomposed.
std::vector<geometry::Solid> load_solids_to_decompose(const DecomposeTask& task) {
  const std::optional<int> index = task.gltf_scene ? std::optional(static_cast<int>(*task.gltf_scene)) : std::nullopt;
  geometry::Scene scene = [&] {
    const Activity work("reading " + task.scene);
    return geometry::load_gltf(task.scene, index);
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
      log::warning(fmt::format("{}: mesh {} has {}; its holes are closed before it is cut", scene.file,
                               in_quotes(solid.name), counted(open, "open edge")));
    }
  }
  return solids;
}

Decomposed take_apart(geometry::Solid solid, const DecomposeTask& task) {
  const Activity work("mesh " + in_quotes(solid.name));
  const auto begin = Clock::now();
  std::optional<geometry::Parts> parts;
  try {
    parts = geometry::decompose(solid.mesh, task.options);
  } catch (const Error& error) {
    throw Error(error.code(), fmt::format("{}: mesh {}: {}", task.scene, in_quotes(solid.name), error.what()));
  }
  const double seconds = std::chrono::duration<double>(Clock::now() - begin).count();
  geometry::PartsReport report = geometry::measure(solid.mesh, *parts, task.seed);
  if (const std::string lost = geometry::lost_cavities(report); !lost.empty())
    log::warning(fmt::format("{}: mesh {} {}", task.scene, in_quotes(solid.name), lost));
  return {std::move(solid), std::move(*parts), report, seconds};
}

}  // namespace

void add_decompose_options(const line::Group& group, geometry::DecomposeOptions& options) {
  group.integer("--parts", options.parts, 1, geometry::most_parts, "the most parts that a solid is cut into");
  group.count("--resolution", options.resolution, geometry::least_voxels, geometry::most_voxels,
              "number of voxels that V-HACD divides a mesh into");
  group.number("--error", options.error_percent, {0, 100, true}, "PERCENT",
               "share of its volume by which a part may exceed its voxels; above it, the part is cut again");
}

std::string to_json(const std::vector<Decomposed>& solids, const std::string& file) {
  JsonWriter json;
  json.begin_object().member("file", file).key("solids").begin_array(JsonWriter::Style::block);
  for (const Decomposed& taken : solids) {
    const geometry::PartsReport& r = taken.report;
    json.begin_object(JsonWriter::Style::line).member("name", taken.solid.name).member("parts", r.parts);
    json.member("volume_m3", r.union_volume_m3).member("mesh_volume_m3", r.mesh_volume_m3);
    json.member("volume_ratio", r.volume_ratio());
    for (const auto& [key, d] :
         {std::pair("surface_error_m", r.surface_error_m), std::pair("mesh_error_m", r.mesh_error_m)}) {
      json.key(key).begin_object(JsonWriter::Style::line);
      json.member("mean", d.mean).member("p95", d.p95).member("max", d.max).end_object();
    }
    json.member("filled_cavities", r.filled_cavities);
    json.member("internal_area", r.internal_share).member("seconds", taken.seconds).end_object();
  }
  json.end_array().end_object();
  return json.take();
}

std::vector<geometry::SceneMesh> part_meshes(const std::vector<Decomposed>& solids) {
  std::vector<geometry::SceneMesh> meshes;
  for (std::uint32_t s = 0; s < solids.size(); ++s) {
    const Decomposed& taken = solids[s];
    for (std::size_t i = 0; i < taken.parts.parts.size(); ++i) {
      geometry::SceneMesh mesh{fmt::format("{} part {}", taken.solid.name, i), taken.parts.parts[i].mesh,
                               taken.solid.haptics, geometry::PartOf{taken.solid.name, s, taken.parts.seam_m}};
      meshes.push_back(std::move(mesh));
    }
  }
  return meshes;
}

std::vector<Decomposed> decompose(const DecomposeTask& task, const std::function<void()>& all_read) {
  std::vector<geometry::Solid> solids = load_solids_to_decompose(task);
  if (all_read) all_read();
  std::vector<Decomposed> all;
  all.reserve(solids.size());
  for (geometry::Solid& solid : solids)
    all.push_back(take_apart(std::move(solid), task));
  return all;
}

}  // namespace palpa::setup
