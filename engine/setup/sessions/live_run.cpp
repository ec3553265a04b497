#include "setup/sessions/live_run.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "base/log.hpp"
#include "base/system/memory.hpp"
#include "base/text.hpp"
#include "sensing/rig.hpp"
#include "session/links/hand_over.hpp"
#include "session/links/real_time_service.hpp"
#include "session/links/spec.hpp"
#include "session/threads.hpp"
#include "setup/options/board_play.hpp"
#include "setup/options/warnings.hpp"
#include "setup/sessions/kept_frames.hpp"
#include "setup/sessions/load.hpp"
#include "setup/sessions/near_skin.hpp"
#include "setup/sessions/null_watch.hpp"
#include "setup/sessions/tracker.hpp"

namespace palpa::setup {
namespace {

/// Room for frames that wait for the recorder: a few seconds of the paper's cameras.
constexpr std::uint64_t most_waiting_bytes = std::uint64_t{1} << 30;

LiveOptions settled(LiveOptions options, std::span<const session::LinkKind> own) {
  const std::vector<session::LinkKind> links = with_builtin(own);
  session::check_board_files(options.link, links, options.board_files);
  take_layout_of_link(options.rig, options.link, links);
  if (options.steps_given) session::check_takes_steps(options.link, links);
  take_method_of_link(options, links);
  take_dwell_of_link(options, links);
  if (options.every_frame) options.leave_out_unmeasured_prediction();
  return options;
}

/// Opens the socket of --osc, lets its gain multiply the ceiling, and its messages change how solids feel.
std::unique_ptr<session::Osc> open_osc(LiveOptions& options) {
  if (options.osc.empty()) return nullptr;
  auto osc = std::make_unique<session::Osc>(options.osc);
  options.safety.gain_now = &osc->gain();
  options.feel_may_change = true;
  return osc;
}

Prepared prepare_live(const LiveOptions& options, std::span<const session::SourceKind> sources) {
  if (options.hold_auto && options.every_frame)
    throw bad_usage("--hold auto and --every-frame exclude each other: with --every-frame, no frame is late");
  if (!options.every_frame) session::go_first();  // before the device starts its threads
  return prepare(options, sources, !options.every_frame, FingerMesh::known);
}

}  // namespace

void add_link(const line::Group& group, LiveOptions& o) {
  group.text("--link", o.link, "LINK",
             "where drives go: null (nowhere), record:FILE, foci:udp:HOST:PORT or a board (docs/boards.md)");
  add_board_files(group, o.board_files);
  group.choice("--steps", o.steps, steps_words,
               "whether OpenMPD boards go from drive to drive in steps of 0.1 ms, which is quieter to the ear, or jump",
               &o.steps_given);
}

void add_link_options(const line::Group& group, LiveOptions& o) {
  add_link(group, o);
  group.flag("--every-frame", o.every_frame, "processes every frame, however long it takes, and not only the newest");
  group.text("--record", o.record, "DIR",
             "writes every depth frame into a new folder, for --source recording:DIR [no recording]");
  group.flag("--overwrite", o.overwrite, "with --record: replaces the recording that is already in that folder");
  group.text("--osc", o.osc, "PORT|ADDRESS:PORT",
             "takes gain, mute, and poses and feel of objects from other programs, as OSC messages by UDP; with a port "
             "alone, from this machine (docs/live-control.md) [no messages]",
             [](const std::string& text) { session::parse_osc_address(text); });
}

void add_run_options(CLI::App& app, RunCommand& o, const char* frames) {
  const line::Group group(app, "What to run");
  add_frame_options(group, o, frames);
  add_link_options(group, o);
  group.flag("--reload", o.reload, "reads the scene again whenever its file is saved, and goes on with it");
  group.choice("--stats", o.stats, {{"none", StatsFormat::none}, {"json", StatsFormat::json}},
               "prints the measurements of the loop on stdout; --json writes the same into a file");
  add_session_options(app, o, FingerMesh::known);
}

std::vector<Output> outputs_of(const LiveOptions& o, std::span<const session::LinkKind> links) {
  return {{"--json", o.common.json},
          {"--events", o.events.starts_with("udp:") ? "" : o.events},
          {"--link", session::file_of_link(o.link, links)},
          {"--record", o.record, o.overwrite ? Output::Kind::replaced_recording : Output::Kind::recording}};
}

void check(const LiveOptions& o) {
  check(static_cast<const FrameOptions&>(o));
  if (o.every_frame) o.refuse_unmeasured_prediction("frames that wait (--every-frame)");
  if (const std::string asks = asks_for_finger(o.drive); !asks.empty() && o.every_frame)
    throw bad_usage(asks + " follows fingers as time allows, so --every-frame cannot have it: leave one of them out");
  if (!o.record.empty() && is_tracker(o.source))
    throw bad_usage("--record goes with depth cameras; a file with a tracker's lines of JSON is --source joints:FILE");
  if (o.overwrite && o.record.empty()) throw bad_usage("--overwrite goes with --record: it replaces a recording");
}

void take_layout_of_link(RigOptions& rig, const std::string& link, std::span<const session::LinkKind> links) {
  if (!rig.layout.empty()) return;
  const std::string own = session::layout_of_link(link, links);
  if (own.empty() || (!rig.rig.empty() && sensing::load_rig(rig.rig).array)) return;
  rig.layout = own;
  log::info(
      fmt::format("--link {}: palpa uses the link's own array, --layout {}, because neither --layout nor {} names one",
                  link, own, rig.rig.empty() ? "a --rig" : rig.rig));
}

void take_method_of_link(LiveOptions& options, std::span<const session::LinkKind> links) {
  const std::string name = session::parse_spec(options.link).name;
  if (!session::find_kind(links, name, "link").least_moving_slot_s) return;
  const double least_s = session::least_moving_slot_s(options.link, links, load_placed_layout(options.rig).layout);
  take_method_of_boards(options.touch, least_s, "--link " + options.link, options.own_method != nullptr);
}

void take_dwell_of_link(LiveOptions& options, std::span<const session::LinkKind> links) {
  if (!session::find_kind(links, session::parse_spec(options.link).name, "link").takes_steps) return;
  take_dwell_of_boards(options.touch, load_placed_layout(options.rig).layout, options.steps);
}

bool plays_slot_by_slot(const std::string& link, std::span<const session::LinkKind> links) {
  const std::string name = session::parse_spec(link).name;
  return name != "null" && name != "foci" && !session::find_kind(links, name, "link").plays_plans;
}

std::vector<session::LinkKind> with_builtin(std::span<const session::LinkKind> links) {
  return added_to(session::builtin_links(), links);
}

LiveRun::LiveRun(const LiveOptions& options, std::span<const session::SourceKind> sources,
                 std::span<const session::LinkKind> links, std::atomic<bool>& stop)
    : options_(settled(options, links)),
      stop_(&stop),
      osc_(open_osc(options_)),
      scene_state_(options_.reload ? look_at_scene(options_.scene) : SceneState{}),
      prepared_(prepare_live(options_, sources)) {
  const session::SessionSetting& setting = session().setting();
  check_frequency(setting.layout, setting.drive.medium);
  if (plays_slot_by_slot(options_.link, with_builtin(links))) refuse_coarse_modulation(session());
  warn_of_boards(options_.link, session());
  // Opened last: a typing error elsewhere must not leave an empty recording or a switched-on array behind.
  if (!options_.events.empty()) {
    sink_ = session::open_event_sink(options_.events, session().solid_names(), stop_, options_.every_frame);
  }
  if (!options_.record.empty()) {
    recorder_.emplace(options_.record, source().cameras(),
                      options_.overwrite ? sensing::Existing::replaced : sensing::Existing::refused);
  }
  link_ = open_link(links);
  const auto asks_for_pressure = [](const geometry::Solid& solid) { return solid.haptics.pressure_pa.has_value(); };
  if (!std::ranges::all_of(session().solids(), asks_for_pressure))
    warn_of_full_amplitude(options_, options_.link, *link_);
}

/// If the link cannot be opened, there will be no frames, so an empty recording is removed.
std::unique_ptr<session::Link> LiveRun::open_link(std::span<const session::LinkKind> links) {
  try {
    session::LinkSetting setting = session().link_setting();
    setting.board_files = options_.board_files;
    setting.steps = options_.steps == Steps::on;
    return session::open_link(options_.link, with_builtin(links), setting);
  } catch (...) {
    if (recorder_) recorder_->discard();
    throw;
  }
}

/// A scene with another slot than the link was opened for is refused.
void LiveRun::watch_scene() {
  session::SessionSetting setting = session().setting();
  setting.solids.clear();
  const double slot_s = session().scheduler().slot_s();
  reload_.emplace(options_.scene, scene_state_, [this, setting, slot_s] {
    auto next = prepare_again(options_, prepared_.device.get(), setting);
    if (const double next_s = next->scheduler().slot_s(); next_s != slot_s) {
      throw bad_input(
          options_.scene,
          fmt::format("its shortest dwell is {:g} ms, but the link was opened for {:g} ms: start the run again",
                      1e3 * next_s, 1e3 * slot_s));
    }
    next->warm_up();
    return next;
  });
}

void LiveRun::before_frame(session::Session& session) {
  if (osc_) osc_->before_frame(session);
  if (before_frame_) before_frame_(session);
}

void LiveRun::take_scene(session::Session& session) {
  reload_->take(session);
  if (osc_) osc_->set_scene(session);
}

void tell_backend(const ComputeOptions& options, session::LoopStats& stats) {
  const UsedBackend used = used_backend(options);
  stats.backend = word_of(backend_words, used.backend);
  stats.backend_why = used.why;
}

session::LoopStats LiveRun::run(session::RunObserver& observer,
                                const std::function<void(const sensing::FrameSet&)>& record,
                                std::function<void(session::Session&)> before_frame) {
  before_frame_ = std::move(before_frame);
  WatchedNulls watched(session().setting(), observer, options_.every_frame);
  session::RunOptions options{.frames = options_.frames,
                              .every_frame = options_.every_frame,
                              .observer = &watched,
                              .events = sink_.get(),
                              .changes = osc_ || options_.reload || before_frame_ ? this : nullptr,
                              .record = record,
                              .steps = options_.steps == Steps::on};
  std::uint64_t out_of_order = 0;  // frames whose time cannot be recorded; used by the recorder's thread
  if (recorder_) {
    options.record = [&](const sensing::FrameSet& set) {
      out_of_order += recorder_->write(set) ? 0 : 1;
      if (record) record(set);
    };
    options.record_waiting_bytes = std::min(most_waiting_bytes, free_memory() / 4);
  }
  if (osc_) osc_->listen(session(), observer);
  if (options_.reload) watch_scene();
  session::LoopStats stats;
  KeptFrames kept(source());
  try {
    stats = session().run(kept, *link_, *stop_, options);
  } catch (...) {
    finish(sink_.get(), true);
    throw;
  }
  finish(sink_.get(), false);
  tell_backend(options_.common, stats);
  // Solids that other programs move may have been elsewhere: then nobody knows.
  if (stats.touching == 0 && stats.planned > 0 && !osc_ && !before_frame_)
    stats.untouched = find_untouched(session().setting(), kept.frames());
  if (sink_) stats.events = {sink_->written(), sink_->dropped()};
  if (osc_) stats.messages = osc_->end();
  if (reload_) stats.reload = reload_->end();
  if (recorder_ && stats.unrecorded > 0) {
    log::warning(fmt::format("{}: {} of {} frames came faster than they could be written; --every-frame waits for each",
                             options_.record, stats.unrecorded, stats.captured));
  }
  if (out_of_order > 0) {
    log::warning(fmt::format("{}: {} of {} {} missing, because the source's clock stepped back", options_.record,
                             out_of_order, counted(stats.captured, "frame"), out_of_order == 1 ? "is" : "are"));
    stats.unrecorded += out_of_order;
  }
  return stats;
}

namespace {

/// How the threads were scheduled that must not be late; empty if they did not ask.
std::string scheduling_summary(const session::OutputStats& output) {
  if (output.scheduling == Scheduling::unknown) return {};
  const bool guarded = output.hand_over.behind && output.hand_over.behind->guard;
  const Scheduling guard = guarded ? output.hand_over.behind->guard_scheduling : output.scheduling;
  if (output.scheduling == Scheduling::real_time && guard == Scheduling::real_time)
    return guarded ? "drives left by real-time scheduling, and so did the guard's\n"
                   : "drives left by real-time scheduling\n";
  return fmt::format("drives left by {} scheduling{}; for fewer late ones, {}\n", to_text(output.scheduling),
                     guarded ? fmt::format(" (the guard: {})", to_text(guard)) : "", session::how_to_get_real_time());
}

}  // namespace

std::string summary(const session::LoopStats& stats, const std::string& recording, double ceiling) {
  std::string text;
  if (!recording.empty() && stats.unrecorded == 0) {
    text = stats.captured == 1 ? fmt::format("{}: the frame is recorded\n", recording)
                               : fmt::format("{}: all {} frames are recorded\n", recording, stats.captured);
  } else if (!recording.empty()) {
    text = fmt::format("{}: {} of {} {} missing; --every-frame waits until each is written\n", recording,
                       stats.unrecorded, counted(stats.captured, "frame"), stats.unrecorded == 1 ? "is" : "are");
  }
  text += fmt::format(
      "{}, {} with a touch, {} left out for newer ones\n"
      "frame to drives: median {:.2f} ms, p99 {:.2f} ms; {}, {} of them silent, {} overslept\n",
      counted(stats.captured, "frame"), stats.touching, stats.replaced, stats.frame_to_plan_s.quantile(0.5) * 1e3,
      stats.frame_to_plan_s.quantile(0.99) * 1e3, counted(stats.output.drives, "drive"), stats.output.silent_drives,
      counted(stats.output.skipped_slots, "slot"));
  if (stats.captured == 0) text += "no frame came from the source\n";
  if (stats.untouched) text += "nothing touched: " + stats.untouched->why + "\n";
  const std::string shed = stats.shed ? fmt::format("{}, in {} of {} frames\n", session::to_text(stats.shed->least),
                                                    stats.shed->frames, stats.planned)
                                      : "";
  std::string ahead;
  if (stats.prediction && stats.prediction->distance_m.quantile(1) > 0) {
    ahead =
        fmt::format("foci played up to {:.1f} mm ahead of their fingers, for a latency of {:.0f} ms (median)\n",
                    stats.prediction->distance_m.quantile(1) * 1e3, stats.prediction->latency_s.quantile(0.5) * 1e3);
  }
  if (!stats.backend.empty()) {
    text += fmt::format("computed {}, because {}\n", stats.backend == "cpu" ? "on the processor" : "with Vulkan",
                        stats.backend_why);
  }
  if (stats.ear) {
    text += fmt::format("to the ear, {:g} m beside the beam, the loudest touch had {} (predicted, 10 dB either way)\n",
                        acoustics::EarOptions().distance_m, acoustics::to_text(*stats.ear));
  }
  text += scheduling_summary(stats.output);
  if (ceiling == 0) text += "the ceiling is 0: nothing sounds\n";
  return text + session::to_text(stats.output.hand_over) + "\n" + shed + ahead +
         session::to_text(stats.dropped, stats.planned) + pressures_summary(stats.fingers, stats.solids);
}

}  // namespace palpa::setup
