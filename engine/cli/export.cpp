#include "setup/tasks/export.hpp"

#include <fmt/format.h>

#include <optional>
#include <utility>

#include "base/error.hpp"
#include "base/log.hpp"
#include "base/output_file.hpp"
#include "cli/commands.hpp"
#include "setup/interrupt.hpp"
#include "setup/progress.hpp"
#include "setup/values.hpp"

namespace palpa::cli {
namespace {

void add_options(CLI::App& app, setup::ExportTask& o) {
  const setup::Group group(app, "What to export");
  add_frame_options(group, o, "stop after that many frames; 0: at the recording's end");
  group.text("--foci", o.foci, "FILE", "foci of each frame, .csv or .json; how many: --foci-count");
  group.text("--drives", o.drives, "FILE", "every slot's drive, as run's --link record:FILE has them");
  add_session_options(app, o, "--foci-count");
}

std::string summary(const session::ReplayStats& stats) {
  return fmt::format("{} frames, {} with a touch; {} drives of {} ms, {} of them silent\n", stats.frames,
                     stats.touching, stats.drives, stats.slot_s * 1e3, stats.silent_drives) +
         setup::pressures_summary(stats.fingers, stats.solids);
}

void run(const Extensions& extensions, const setup::ExportTask& o) {
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
  if (result.stopped) {
    throw failure(fmt::format("ended by a signal after {} frames{}", result.stats.frames,
                              o.foci.empty() ? "" : fmt::format(": {} is not written", o.foci)));
  }
  if (!o.common.json.empty()) write_file(o.common.json, to_json(result));
  if (setup::shows_summary(o.common, outputs)) write_file("-", summary(result.stats));
}

}  // namespace

void add_export(Program& program) {
  const Extensions& extensions = program.extensions;
  add_subcommand<setup::ExportTask>(
      program,
      {"export", "a recording's foci, events and drives as files, on its own clock",
       "  palpa export --scene assets/cube.glb --source recording:take1 --foci foci.csv\n"
       "  palpa export --scene assets/cube.glb --source recording:take1 --drives drives.bin --events events.jsonl\n"
       "  palpa export --scene assets/cube.glb --frames 90 --foci foci.json --foci-count 8"},
      add_options, [&extensions](const setup::ExportTask& o) { run(extensions, o); });
}

}  // namespace palpa::cli
