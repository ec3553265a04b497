#include "setup/tasks/decompose.hpp"

#include <fmt/format.h>

#include <iterator>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "base/files/output_file.hpp"
#include "base/log.hpp"
#include "base/text.hpp"
#include "cli/commands.hpp"
#include "geometry/gltf/write.hpp"
#include "line/values.hpp"
#include "setup/options/options.hpp"
#include "setup/process/progress.hpp"

namespace palpa::cli {
namespace {

struct DecomposeCommand {
  setup::CommonOptions common;
  setup::DecomposeTask task;
  std::string out;
};

void add_options_of_decompose(CLI::App& app, DecomposeCommand& o) {
  const line::Group group(app, "What to take apart");
  group.text("--scene", o.task.scene, "FILE", "glTF model; each mesh that can be touched is cut into parts");
  setup::add_gltf_scene(group, o.task.gltf_scene);
  add_allow_outside(group, o.common);
  group.text("--out", o.out, "FILE.glb|-", "writes the parts as glTF, which other commands read as --scene");
  setup::add_decompose_options(line::Group(app, "How"), o.task.options);
}

std::string summary_of_decompose(const DecomposeCommand& o, const std::vector<setup::Decomposed>& all) {
  std::string text;
  for (const setup::Decomposed& taken : all) {
    const geometry::PartsReport& r = taken.report;
    const auto out = std::back_inserter(text);
    fmt::format_to(out, "{}: {} in {:.1f} s", taken.solid.name, counted(r.parts, "part"), taken.seconds);
    if (const auto ratio = r.volume_ratio()) fmt::format_to(out, ", {:.3f} of its volume", *ratio);
    const auto mm = [](const geometry::Distances& d) {
      return fmt::format("mean {:.3g}, p95 {:.3g}, max {:.3g} mm", d.mean * 1e3, d.p95 * 1e3, d.max * 1e3);
    };
    fmt::format_to(out,
                   "\n  from the parts' surface to the mesh: {}\n  from the mesh to the parts' surface: {}\n"
                   "  {:.0f} % of the parts' faces are cuts\n",
                   mm(r.surface_error_m), mm(r.mesh_error_m), r.internal_share * 100);
  }
  return text + fmt::format("written to {}\n", o.out);
}

void run_decompose(const DecomposeCommand& o) {
  if (o.task.scene.empty()) throw bad_usage("--scene is missing: give a glTF model");
  if (o.out.empty()) throw bad_usage("--out is missing: give a file such as parts.glb");
  setup::DecomposeTask task = o.task;
  task.seed = o.common.seed;
  const Outputs outputs({{"--json", o.common.json}, {"--out", o.out}});
  std::optional<setup::Preparing> preparing(std::in_place, o.common.quiet);
  const std::vector<setup::Decomposed> all = setup::decompose(task, log::release_warnings);
  preparing.reset();
  geometry::write_glb(o.out, setup::part_meshes(all));
  if (!o.common.json.empty()) write_file(o.common.json, setup::to_json(all, o.out));
  if (setup::shows_summary(o.common, outputs)) write_file("-", summary_of_decompose(o, all));
}

}  // namespace

void add_decompose(Program& program) {
  add_subcommand<DecomposeCommand>(
      program,
      {"decompose", "convex parts of a concave model, as glTF",
       "  palpa decompose --scene assets/cube.glb --parts 32 --out parts.glb\n"
       "  palpa touch --scene parts.glb --points assets/finger.ply --penetration 3mm",
       "", "V-HACD cuts the model. The report says how far the parts' surface and the model's are from each other."},
      add_options_of_decompose, run_decompose, setup::Computes::on_processor);
}

}  // namespace palpa::cli
