#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "base/log.hpp"
#include "base/output_file.hpp"
#include "cli/commands.hpp"
#include "cli/frames.hpp"
#include "cli/interrupt.hpp"
#include "sensing/recording.hpp"
#include "session/event_sink.hpp"
#include "session/session.hpp"
#include "session/sources.hpp"
#include "setup/load.hpp"
#include "setup/options.hpp"
#include "setup/progress.hpp"
#include "setup/values.hpp"
#include "setup/warnings.hpp"

namespace palpa::cli {
namespace {

enum class StatsFormat { none, json };

struct RunCommand : FrameOptions {
  std::string link = "null";
  std::string board_files;
  bool every_frame = false;
  std::string record;
  StatsFormat stats = StatsFormat::none;
};

void add_options(CLI::App& app, RunCommand& o) {
  const setup::Group group(app, "What to run");
  add_frame_options(group, o, "stop after that many frames; 0: at the source's end or Ctrl-C");
  group.text("--link", o.link, "LINK",
             "null, record:FILE, foci:udp:HOST:PORT, or a board; a name that is none lists them all");
  group.text("--board-files", o.board_files, "DIR", "with the boards' own files: how their transducers differ");
  group.flag("--every-frame", o.every_frame, "look at every frame, however long it takes, instead of the newest");
  group.text("--record", o.record, "DIR", "write every frame into a new folder, to be replayed as recording:DIR");
  group.choice("--stats", o.stats, {{"none", StatsFormat::none}, {"json", StatsFormat::json}},
               "what the loop measured, on stdout; --json writes the same");
  add_session_options(app, o);
}

std::string summary(const session::LoopStats& stats) {
  const std::string text = fmt::format(
      "{} frames, {} with a touch, {} left out for newer ones\n"
      "frame to drives: median {:.2f} ms, p99 {:.2f} ms; {} drives, {} of them silent, {} slots overslept\n",
      stats.captured, stats.touching, stats.replaced, stats.frame_to_plan_s.quantile(0.5) * 1e3,
      stats.frame_to_plan_s.quantile(0.99) * 1e3, stats.output.drives, stats.output.silent_drives,
      stats.output.skipped_slots);
  return text + pressures_summary(stats.fingers, stats.solids);
}

/// All that is written; --stats and --json are the same where both go to stdout.
std::vector<Output> outputs_of(const RunCommand& o, std::span<const session::LinkKind> links) {
  const bool stats = o.stats == StatsFormat::json && o.common.json != "-";
  return {{"--json", o.common.json},
          {"--stats", stats ? "-" : ""},
          {"--events", o.events.starts_with("udp:") ? "" : o.events},
          {"--link", session::file_of_link(o.link, links)},
          {"--record", o.record, Output::Kind::folder}};
}

void report(const RunCommand& o, const Outputs& outputs, const session::LoopStats& stats) {
  if (!o.common.json.empty()) write_file(o.common.json, session::to_json(stats));
  if (o.stats == StatsFormat::json) {
    if (o.common.json != "-") write_file("-", session::to_json(stats));
  } else if (setup::shows_summary(o.common, outputs)) {
    write_file("-", summary(stats));
  }
}

/// The link of the line. Where it cannot be opened there will be no frames, and no recording without any is left.
std::unique_ptr<session::Link> open_link(const RunCommand& o, std::span<const session::LinkKind> links,
                                         const session::Session& session,
                                         std::optional<sensing::RecordingWriter>& recorder) {
  try {
    session::LinkSetting setting = session.link_setting();
    setting.board_files = o.board_files;
    return session::open_link(o.link, links, setting);
  } catch (...) {
    if (recorder) recorder->discard();
    throw;
  }
}

/// What is said where something keeps palpa from ending.
std::string late_line(const RunCommand& o) {
  std::string waits = o.common.backend == setup::Backend::gpu ? "the GPU" : "a frame that takes long";
  for (const auto& [option, target] : {std::pair("--link", o.link), std::pair("--events", o.events),
                                       std::pair("--record", o.record), std::pair("--json", o.common.json)}) {
    if (!target.empty() && target != "null") waits += fmt::format(", {} {}", option, target);
  }
  return fmt::format("ended without finishing, a second after the signal: what it waited for did not answer ({})",
                     waits);
}

void run(const Extensions& extensions, const RunCommand& o) {
  check(o);
  std::vector<session::LinkKind> links = session::builtin_links();
  links.insert(links.end(), extensions.links.begin(), extensions.links.end());
  const Outputs outputs(outputs_of(o, links));
  const auto [source, device, prepared] = prepare(o, extensions, !o.every_frame);
  session::Session& session = *prepared;

  // Last of all: a typing error elsewhere must not leave an empty recording behind, nor an array that is switched on.
  session::RunOptions options{.frames = o.frames, .every_frame = o.every_frame};
  std::unique_ptr<session::EventSink> sink;
  if (!o.events.empty()) {
    sink = session::open_event_sink(o.events, session.solid_names(), o.every_frame ? &Interrupt::flag() : nullptr);
    options.events = [&](std::span<const session::Event> events) { sink->write(events); };
  }
  std::optional<sensing::RecordingWriter> recorder;
  if (!o.record.empty()) recorder.emplace(o.record, source->cameras());
  std::uint64_t out_of_order = 0;  // frames whose time a recording cannot hold; of the recorder's thread
  if (recorder) options.record = [&](const sensing::FrameSet& set) { out_of_order += recorder->write(set) ? 0 : 1; };
  const std::unique_ptr<session::Link> link = open_link(o, links, session, recorder);

  std::optional<log::Relay> relay(std::in_place);
  std::optional<Interrupt> interrupt(std::in_place, late_line(o));
  log::release_warnings();
  setup::Progress progress("frames", o.frames, o.common.quiet);
  options.planned = [&, warned = false, frames = std::uint64_t{0}](const session::FrameReport& frame,
                                                                   const session::Plan&) mutable {
    warn_of_left_out_fingers(*frame.touch, warned);
    progress.set(++frames);
  };
  session::LoopStats stats;
  try {
    stats = session.run(*source, *link, Interrupt::flag(), options);
  } catch (...) {
    finish(sink.get(), true);
    throw;
  }
  finish(sink.get(), false);
  interrupt.reset();
  if (sink) stats.events = {sink->written(), sink->dropped()};
  if (stats.unrecorded > 0) {
    log::warning(fmt::format("{}: {} of {} frames came too fast to be written; --every-frame waits for each", o.record,
                             stats.unrecorded, stats.captured));
  }
  if (out_of_order > 0) {
    log::warning(fmt::format("{}: {} of {} frames are not in it, since the source's clock stepped back", o.record,
                             out_of_order, stats.captured));
    stats.unrecorded += out_of_order;
  }
  relay.reset();  // its last lines must not come between those of the results
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
