#include <fmt/format.h>

#include <exception>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "base/log.hpp"
#include "base/output_file.hpp"
#include "cli/commands.hpp"
#include "session/links/foci_file.hpp"
#include "session/links/record_link.hpp"
#include "session/links/sources.hpp"
#include "session/replay.hpp"
#include "session/watch/event_sink.hpp"
#include "setup/frames.hpp"
#include "setup/interrupt.hpp"
#include "setup/progress.hpp"
#include "setup/warnings.hpp"

namespace palpa::cli {
namespace {

struct ExportCommand : setup::FrameOptions {
  std::string foci;
  std::string drives;
};

void add_options(CLI::App& app, ExportCommand& o) {
  const setup::Group group(app, "What to export");
  add_frame_options(group, o, "stop after that many frames; 0: at the recording's end");
  group.text("--foci", o.foci, "FILE", "foci of each frame, .csv or .json; how many: --foci-count");
  group.text("--drives", o.drives, "FILE", "every slot's drive, as run's --link record:FILE has them");
  add_session_options(app, o, "--foci-count");
}

/// Several links at once.
class Links final : public session::Link {
 public:
  /// It outlives this.
  void add(session::Link& link) { links_.push_back(&link); }
  void plan(const session::ToldPlan& told) override {
    for (session::Link* const link : links_)
      link->plan(told);
  }
  void send(std::uint64_t slot, std::span<const array::TransducerDrive> drive) override {
    for (session::Link* const link : links_)
      link->send(slot, drive);
  }
  /// All of them, whatever fails.
  void finish() override {
    std::exception_ptr fault;
    for (session::Link* const link : links_) {
      try {
        link->finish();
      } catch (const Error&) {
        fault = fault ? fault : std::current_exception();
      }
    }
    if (fault) std::rethrow_exception(fault);
  }

 private:
  std::vector<session::Link*> links_;
};

std::string summary(const session::ReplayStats& stats) {
  return fmt::format("{} frames, {} with a touch; {} drives of {} ms, {} of them silent\n", stats.frames,
                     stats.touching, stats.drives, stats.slot_s * 1e3, stats.silent_drives) +
         setup::pressures_summary(stats.fingers, stats.solids);
}

void check_export(const ExportCommand& o, const Extensions& extensions) {
  if (o.hold_auto) throw bad_usage("--hold auto goes with palpa run: what is exported is never late");
  check(o);
  if (o.foci.empty() && o.events.empty() && o.drives.empty())
    throw bad_usage("nothing to export: give --foci, --events or --drives");
  if (!o.foci.empty()) session::check_foci_file(o.foci);
  if (o.frames == 0 && !session::ends_by_itself(o.source, setup::with_builtin(extensions.sources)))
    throw bad_usage(fmt::format("--source {} does not end: give --frames, or recording:DIR or bag:FILE", o.source));
}

void run(const Extensions& extensions, const ExportCommand& o) {
  check_export(o, extensions);
  const Outputs outputs({{"--json", o.common.json},
                         {"--foci", o.foci},
                         {"--drives", o.drives},
                         {"--events", o.events.starts_with("udp:") ? "" : o.events}});
  const auto [source, device, prepared] = prepare(o, extensions.sources, false);
  session::Session& session = *prepared;

  session::ReplayOptions options{.frames = o.frames};
  std::unique_ptr<session::EventSink> sink;
  if (!o.events.empty()) {
    sink = session::open_event_sink(o.events, session.solid_names(), &setup::Interrupt::flag());
    options.events = [&](std::span<const session::Event> events) { sink->write(events); };
  }
  Links links;
  const auto foci = o.foci.empty() ? nullptr : session::open_foci_file(o.foci, session.link_setting());
  const auto drives = o.drives.empty()
                          ? nullptr
                          : session::open_record_link(o.drives, session.link_setting(), &setup::Interrupt::flag());
  if (foci) links.add(*foci);
  if (drives) links.add(*drives);
  const setup::Interrupt interrupt("ended without finishing, a second after the signal: a frame or a disk took longer");
  log::release_warnings();
  std::optional<setup::Preparing> preparing(std::in_place, o.common.quiet);  // ends with the first frame
  setup::Progress progress("frames", o.frames, o.common.quiet);
  options.planned = [&, warned = false, frames = std::uint64_t{0}](const session::FrameReport& frame) mutable {
    preparing.reset();
    setup::warn_of_left_out_fingers(*frame.touch, warned);
    progress.set(++frames);
  };
  session::ReplayStats stats;
  try {
    stats = session::replay(session, *source, links, setup::Interrupt::flag(), options);
  } catch (...) {
    setup::finish(sink.get(), true);
    throw;
  }
  setup::finish(sink.get(), false);
  if (interrupt.requested()) {
    throw failure(fmt::format("ended by a signal after {} frames{}", stats.frames,
                              foci ? fmt::format(": {} is not written", o.foci) : ""));
  }
  if (foci) foci->commit();
  if (!o.common.json.empty()) write_file(o.common.json, session::to_json(stats));
  if (setup::shows_summary(o.common, outputs)) write_file("-", summary(stats));
}

}  // namespace

void add_export(Program& program) {
  const Extensions& extensions = program.extensions;
  add_subcommand<ExportCommand>(
      program,
      {"export", "a recording's foci, events and drives as files, on its own clock",
       "  palpa export --scene assets/cube.glb --source recording:take1 --foci foci.csv\n"
       "  palpa export --scene assets/cube.glb --source recording:take1 --drives drives.bin --events events.jsonl\n"
       "  palpa export --scene assets/cube.glb --frames 90 --foci foci.json --foci-count 8"},
      add_options, [&extensions](const ExportCommand& o) { run(extensions, o); });
}

}  // namespace palpa::cli
