#include "setup/tasks/export.hpp"

#include <fmt/format.h>

#include <CLI/App.hpp>
#include <algorithm>
#include <optional>
#include <string_view>
#include <utility>

#include "base/error.hpp"
#include "base/files/output_file.hpp"
#include "base/log.hpp"
#include "base/text.hpp"
#include "cli/commands.hpp"
#include "line/option_table.hpp"
#include "line/values.hpp"
#include "setup/process/interrupt.hpp"
#include "setup/process/progress.hpp"
#include "setup/tasks/export_played.hpp"

namespace palpa::cli {
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

/// Adds --played. The line is refused if it also has an option without an effect on such foci.
void add_played(CLI::App& app, const line::Group& group, setup::ExportTask& task) {
  group.text(
      "--played", task.played, "FILE",
      "instead of --scene and --source: foci that palpa export --foci FILE.json or a study wrote, whose --drives "
      "are computed again");
  app.parse_complete_callback([&app, &task] {
    if (!task.played.empty()) refuse_idle(line::given_on(app));
  });
}

void add_options_of_export(CLI::App& app, setup::ExportTask& o) {
  const line::Group group(app, "What to export");
  add_frame_options(group, o, "number of frames to export; 0 exports all until the recording ends");
  group.text("--foci", o.foci, "FILE",
             "writes the foci of each frame, as .csv or .json; --foci-count sets their number");
  group.text("--drives", o.drives, "FILE", "writes the drive of every slot, as palpa run --link record:FILE does");
  add_played(app, group, o);
  add_session_options(app, o, setup::FingerMesh::unknown, "--foci-count");
}

std::string summary_of_export(const session::ReplayStats& stats) {
  return fmt::format("{} frames, {} with a touch; {} drives of {} ms, {} of them silent\n", stats.frames,
                     stats.touching, stats.drives, stats.slot_s * 1e3, stats.silent_drives) +
         (stats.untouched ? "nothing touched: " + stats.untouched->why + "\n" : "") +
         session::to_text(stats.dropped, stats.frames) + setup::pressures_summary(stats.fingers, stats.solids);
}

[[noreturn]] void throw_stopped(const setup::ExportResult& result, const std::string& unwritten) {
  throw failure(fmt::format("ended by a signal after {}{}", counted(result.stats.frames, "frame"),
                            unwritten.empty() ? "" : fmt::format(": {} is not written", unwritten)));
}

void run_played(const setup::ExportTask& o) {
  const Outputs outputs({{"--json", o.common.json}, {"--drives", o.drives}});
  const setup::Interrupt interrupt("ended without finishing, one second after the signal: a disk took longer");
  log::release_warnings();
  const setup::ExportResult result = export_played(o, setup::Interrupt::flag());
  if (result.stopped) throw_stopped(result, "");
  if (!o.common.json.empty()) write_file(o.common.json, to_json(result));
  if (setup::shows_summary(o.common, outputs)) write_file("-", summary_of_export(result.stats));
}

void run_export(const Extensions& extensions, const setup::ExportTask& o) {
  if (!o.played.empty()) return run_played(o);
  check(o, extensions.sources);
  const Outputs outputs({{"--json", o.common.json},
                         {"--foci", o.foci},
                         {"--drives", o.drives},
                         {"--events", o.events.starts_with("udp:") ? "" : o.events}});
  setup::ExportRun task(o, extensions.sources, setup::Interrupt::flag());
  const setup::Interrupt interrupt(
      "ended without finishing, one second after the signal: a frame or a disk took longer");
  log::release_warnings();
  std::optional<setup::Preparing> preparing(std::in_place, o.common.quiet);  // ends with the first frame
  setup::Progress progress("frames", o.frames, o.common.quiet);
  const setup::ExportResult result =
      task.run({.planned = [&, frames = std::uint64_t{0}](const session::FrameReport&) mutable {
        preparing.reset();
        progress.set(++frames);
      }});
  if (result.stopped) throw_stopped(result, o.foci);
  if (!o.common.json.empty()) write_file(o.common.json, to_json(result));
  if (setup::shows_summary(o.common, outputs)) write_file("-", summary_of_export(result.stats));
}

}  // namespace

void add_export(Program& program) {
  const Extensions& extensions = program.extensions;
  add_subcommand<setup::ExportTask>(
      program,
      {"export", "a recording's foci, events and drives as files, on its own clock",
       "  palpa export --scene assets/cube.glb --source recording:assets/depth/take --foci foci.csv\n"
       "  palpa export --scene assets/cube.glb --frames 90 --foci foci.json --events events.jsonl",
       "--scene --source --rig --foci --foci-count --drives --events --frames --method --pressure"},
      add_options_of_export, [&extensions](const setup::ExportTask& o) { run_export(extensions, o); });
}

}  // namespace palpa::cli
