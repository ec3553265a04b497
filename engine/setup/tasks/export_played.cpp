#include "setup/tasks/export_played.hpp"

#include <fmt/format.h>

#include <CLI/App.hpp>
#include <algorithm>
#include <memory>
#include <string_view>

#include "base/error.hpp"
#include "line/option_table.hpp"
#include "session/links/record_link.hpp"
#include "setup/load.hpp"
#include "setup/played_foci.hpp"
#include "setup/warnings.hpp"

namespace palpa::setup {

namespace {

/// Throws bad_usage for the first given option that has no effect.
void refuse_idle(const line::Given& given) {
  constexpr std::string_view used[] = {
      "--played",    "--drives",        "--json",   "--hold",       "--ceiling",     "--ramp",        "--rig",
      "--layout",    "--amplitude",     "--solver", "--constraint", "--directivity", "--temperature", "--sound-speed",
      "--frequency", "--allow-outside", "--quiet",  "--log-level",  "--backend"};
  for (const auto& [name, values] : given) {
    if (std::ranges::find(used, name) == std::end(used)) {
      throw bad_usage(
          fmt::format("{} has no effect with --played: the foci, their order and their times are those of "
                      "the file",
                      name));
    }
  }
}

}  // namespace

void add_played(CLI::App& app, const line::Group& group, ExportTask& task) {
  group.text(
      "--played", task.played, "FILE",
      "instead of --scene and --source: foci that palpa export --foci FILE.json or a study wrote, whose --drives "
      "are computed again");
  app.parse_complete_callback([&app, &task] {
    if (!task.played.empty()) refuse_idle(line::given_on(app));
  });
}

ExportResult export_played(const ExportTask& task, std::atomic<bool>& stop) {
  if (task.drives.empty()) throw bad_usage("--played goes with --drives, the file for the drives of these foci");
  if (task.hold_auto) throw bad_usage("--hold auto goes with palpa run: what was played is never late");
  refuse_gpu_options(task.common, "palpa export --played computes on the processor");
  const session::PlayedFoci played = load_played_foci(task.played);
  const PosedRig rig = load_posed_rig(task.rig);
  const session::OutputSetting setting{.layout = rig.layout,
                                       .drive = drive_options(task.drive),
                                       .slot_s = played.slot_s,
                                       .hold_s = task.hold_s,
                                       .safety = task.safety};
  warn_of_frequency(rig.layout, setting.drive.medium);
  const std::unique_ptr<session::Link> drives = session::open_record_link(
      task.drives, {.layout = rig.layout, .solid_names = played.solids, .slot_s = played.slot_s}, &stop);
  ExportResult result{.stats = session::replay(played, setting, *drives, stop)};
  result.stopped = stop;
  return result;
}

}  // namespace palpa::setup
