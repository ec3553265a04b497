#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "base/files/output_file.hpp"
#include "base/log.hpp"
#include "cli/commands.hpp"
#include "cli/run_line.hpp"
#include "line/values.hpp"
#include "session/session.hpp"
#include "setup/options/options.hpp"
#include "setup/options/warnings.hpp"
#include "setup/process/interrupt.hpp"
#include "setup/process/progress.hpp"
#include "setup/sessions/live_run.hpp"

namespace palpa::cli {
namespace {

using setup::RunCommand;
using setup::StatsFormat;

void add_options_of_run(CLI::App& app, RunCommand& o) {
  setup::add_run_options(app, o, "number of frames to run; 0 runs until the source ends or Ctrl-C");
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
    write_file("-", setup::summary(stats, o.record, o.safety.ceiling));
  }
}

/// The message if something keeps palpa from ending.
std::string late_line(const RunCommand& o) {
  std::string waits = setup::on_gpu(o.common) ? "the GPU" : "a slow frame";
  for (const auto& [option, target] : {std::pair("--link", o.link), std::pair("--events", o.events),
                                       std::pair("--record", o.record), std::pair("--json", o.common.json)}) {
    if (!target.empty() && target != "null") waits += fmt::format(", {} {}", option, target);
  }
  return fmt::format("ended without finishing, one second after the signal: one of these did not answer: {}", waits);
}

/// Whether the run's line would stand between events on the same terminal.
bool mixes_with_events(const RunCommand& o) {
  return o.events == "-" && isatty(STDOUT_FILENO) != 0;
}

/// Says that the run is being prepared, until the first frame, and then shows its line.
class RunDisplay final : public session::RunObserver {
 public:
  RunDisplay(const RunCommand& o, bool no_line)
      : preparing_(std::in_place, o.common.quiet), line_(o.link, o.frames, no_line) {}

  void planned(const session::FrameReport& frame, const session::Plan&) override {
    preparing_.reset();
    setup::warn_of_left_out_fingers(*frame.touch, warned_);
    line_.planned(frame);
  }
  void sent(bool sounds, const session::HandOver& counts) override { line_.sent(sounds, counts); }
  void recording_rest(std::uint64_t frames) override { line_.recording_rest(frames); }

 private:
  std::optional<setup::Preparing> preparing_;
  RunLine line_;
  bool warned_ = false;  ///< of fingers that were left out
};

void run_live(const Extensions& extensions, const RunCommand& given) {
  check(given);
  RunCommand o = given;
  const bool no_line = o.common.quiet || mixes_with_events(o);
  o.watched = RunLine::is_shown(no_line);  // the line says how deep fingers are
  const Outputs outputs(outputs_of(o, setup::with_builtin(extensions.links)));
  setup::LiveRun live(o, extensions.sources, extensions.links, setup::Interrupt::flag());

  std::optional<log::Relay> relay(std::in_place);
  std::optional<setup::Interrupt> interrupt(std::in_place, late_line(o));
  log::release_warnings();
  std::optional<RunDisplay> shown(std::in_place, o, no_line);
  const session::LoopStats stats = live.run(*shown);
  shown.reset();
  interrupt.reset();
  relay.reset();  // its last lines must not be mixed with those of the results
  report(o, outputs, stats);
}

}  // namespace

void add_run(Program& program) {
  const Extensions& extensions = program.extensions;
  add_subcommand<RunCommand>(
      program,
      {"run", "the live loop: depth frames in, drives out, until Ctrl-C",
       "  palpa run --scene assets/cube.glb --frames 300 --stats json\n"
       "  palpa run --scene assets/cube.glb --source recording:assets/depth/take --events -",
       "--scene --source --rig --link --frames --method --pressure --ceiling --events --record",
       "On a terminal, a line shows the state of the run, unless events go there. At the end of a run, palpa silences "
       "the array."},
      add_options_of_run, [&extensions](const RunCommand& o) { run_live(extensions, o); });
}

}  // namespace palpa::cli
