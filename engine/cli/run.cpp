#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "base/log.hpp"
#include "base/output_file.hpp"
#include "cli/commands.hpp"
#include "session/session.hpp"
#include "setup/interrupt.hpp"
#include "setup/live_run.hpp"
#include "setup/options.hpp"
#include "setup/progress.hpp"
#include "setup/values.hpp"
#include "setup/warnings.hpp"

namespace palpa::cli {
namespace {

using setup::StatsFormat;

struct RunCommand : setup::LiveOptions {
  StatsFormat stats = StatsFormat::none;
};

void add_options(CLI::App& app, RunCommand& o) {
  const setup::Group group(app, "What to run");
  add_frame_options(group, o, "stop after that many frames; 0: at the source's end or Ctrl-C");
  add_link_options(group, o);
  setup::add_stats_option(group, o.stats);
  add_session_options(app, o);
}

/// All outputs; --stats and --json are the same if both go to stdout.
std::vector<Output> outputs_of(const RunCommand& o, std::span<const session::LinkKind> links) {
  std::vector<Output> outputs = setup::outputs_of(o, links);
  if (o.stats == StatsFormat::json && o.common.json != "-") outputs.insert(outputs.begin() + 1, {"--stats", "-"});
  return outputs;
}

void report(const RunCommand& o, const Outputs& outputs, const session::LoopStats& stats) {
  if (!o.common.json.empty()) write_file(o.common.json, session::to_json(stats));
  if (o.stats == StatsFormat::json) {
    if (o.common.json != "-") write_file("-", session::to_json(stats));
  } else if (setup::shows_summary(o.common, outputs)) {
    write_file("-", setup::summary(stats));
  }
}

/// The message if something keeps palpa from ending.
std::string late_line(const RunCommand& o) {
  std::string waits = o.common.backend == setup::Backend::gpu ? "the GPU" : "a slow frame";
  for (const auto& [option, target] : {std::pair("--link", o.link), std::pair("--events", o.events),
                                       std::pair("--record", o.record), std::pair("--json", o.common.json)}) {
    if (!target.empty() && target != "null") waits += fmt::format(", {} {}", option, target);
  }
  return fmt::format("ended without finishing, one second after the signal: one of these did not answer: {}", waits);
}

void run(const Extensions& extensions, const RunCommand& o) {
  check(o);
  const Outputs outputs(outputs_of(o, setup::with_builtin(extensions.links)));
  setup::LiveRun live(o, extensions.sources, extensions.links, setup::Interrupt::flag());

  std::optional<log::Relay> relay(std::in_place);
  std::optional<setup::Interrupt> interrupt(std::in_place, late_line(o));
  log::release_warnings();
  std::optional<setup::Preparing> preparing(std::in_place, o.common.quiet);  // ends with the first frame
  setup::Progress progress("frames", o.frames, o.common.quiet);
  session::RunOptions looking;
  looking.planned = [&, warned = false, frames = std::uint64_t{0}](const session::FrameReport& frame,
                                                                   const session::Plan&) mutable {
    preparing.reset();
    setup::warn_of_left_out_fingers(*frame.touch, warned);
    progress.set(++frames);
  };
  const session::LoopStats stats = live.run(looking);
  preparing.reset();
  interrupt.reset();
  relay.reset();  // its last lines must not be mixed with those of the results
  report(o, outputs, stats);
}

}  // namespace

void add_run(Program& program) {
  const Extensions& extensions = program.extensions;
  add_subcommand<RunCommand>(
      program,
      {"run", "the live loop: frames in, drives out, until Ctrl-C",
       "  palpa run --scene assets/cube.glb --source synthetic --link null --frames 300 --stats json\n"
       "  palpa run --scene assets/cube.glb --link foci:udp:127.0.0.1:9000 --events - --pressure 8kPa --record take1\n"
       "  palpa run --scene assets/cube.glb --source recording:take1 --link record:drives.bin"},
      add_options, [&extensions](const RunCommand& o) { run(extensions, o); });
}

}  // namespace palpa::cli
