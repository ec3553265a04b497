#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "array/board_mesh.hpp"
#include "base/error.hpp"
#include "base/log.hpp"
#include "base/output_file.hpp"
#include "cli/commands.hpp"
#include "cli/interrupt.hpp"
#include "sensing/recording.hpp"
#include "session/event_sink.hpp"
#include "session/session.hpp"
#include "session/sources.hpp"
#include "setup/assets.hpp"
#include "setup/load.hpp"
#include "setup/options.hpp"
#include "setup/progress.hpp"
#include "setup/touch_schedule.hpp"
#include "setup/values.hpp"
#include "setup/warnings.hpp"

namespace palpa::cli {
namespace {

enum class StatsFormat { none, json };

struct RunCommand {
  setup::CommonOptions common;
  std::string scene;
  std::optional<std::uint32_t> gltf_scene;
  std::string source = "synthetic";
  std::string link = "null";
  setup::RigOptions rig;
  setup::SolidOptions solids;
  setup::TouchOptions touch;
  setup::DriveOptionsGroup drive;
  session::Safety safety;
  double hold_s = 0.1;
  std::uint64_t frames = 0;
  bool every_frame = false;
  bool noise_free = false;
  std::string record;
  std::string events;
  session::EventOptions event;
  touch::Axes axes = touch::Axes::steady;
  touch::Smoothing smoothing = touch::Smoothing::one_euro;
  StatsFormat stats = StatsFormat::none;
};

void add_options(CLI::App& app, RunCommand& o) {
  const setup::Group group(app, "What to run");
  group.text("--scene", o.scene, "FILE", "glTF model whose meshes can be touched");
  group.integer("--gltf-scene", o.gltf_scene, 0, 1'000'000, "scene of the file (default: the file's own)");
  group.text("--source", o.source, "SOURCE", "synthetic[:MESH] or recording:DIR");
  group.text("--link", o.link, "LINK", "null, record:FILE or foci:udp:HOST:PORT");
  group.integer("--frames", o.frames, 0, std::uint64_t{1} << 62,
                "stop after that many frames; 0: at the source's end or Ctrl-C");
  group.quantity("--hold", o.hold_s, Quantity::time, setup::positive(10), "silence when no frame came for that long");
  group.number("--ceiling", o.safety.ceiling, {0, 1}, "NUMBER",
               "multiplies every transducer's amplitude, 0 to 1; the pressure that skin feels follows its square");
  group.quantity("--ramp", o.safety.ramp_s, Quantity::time, {0, session::most_ramp_s},
                 "how long amplitudes take up when a touch begins, and down when it ends");
  group.flag("--every-frame", o.every_frame, "look at every frame, however long it takes, instead of the newest");
  group.flag("--noise-free", o.noise_free, "synthetic frames without the sensor's noise");
  group.text("--record", o.record, "DIR", "write every frame into a new folder, to be replayed as recording:DIR");
  group.text("--events", o.events, "-|FILE|udp:HOST:PORT",
             "a JSON line when a finger touches, moves on, presses past a solid's press depth, releases");
  group.quantity("--event-move", o.event.move_m, Quantity::length, {0, 1},
                 "how far a finger moves before that is an event; 0: every frame");
  group.choice("--stats", o.stats, {{"none", StatsFormat::none}, {"json", StatsFormat::json}},
               "what the loop measured, on stdout; --json writes the same");
  setup::add_solid_options(app, o.solids);
  setup::add_rig_options(app, o.rig);
  setup::add_touch_options(app, o.touch);
  setup::add_drive_options(app, o.drive);
  const setup::Group steadily(app, "From frame to frame");
  steadily.choice("--axes", o.axes, touch::axes_words,
                  "which way cross-sections face: turned the least that they must, or each frame's principal axes");
  steadily.choice("--smoothing", o.smoothing, touch::smoothing_words, "what keeps foci from jumping");
}

std::string summary(const session::LoopStats& stats) {
  std::string text = fmt::format(
      "{} frames, {} with a touch, {} left out for newer ones\n"
      "frame to drives: median {:.2f} ms, p99 {:.2f} ms; {} drives, {} of them silent, {} slots overslept\n",
      stats.captured, stats.touching, stats.replaced, stats.frame_to_plan_s.quantile(0.5) * 1e3,
      stats.frame_to_plan_s.quantile(0.99) * 1e3, stats.output.drives, stats.output.silent_drives,
      stats.output.skipped_slots);
  double most_pa = 0;
  for (const session::FingerPressure& finger : stats.fingers) {
    most_pa = std::max(most_pa, finger.most_pa);
    const double mean_pa = finger.sum_pa / static_cast<double>(finger.frames);
    text +=
        fmt::format("finger {} on {}: {:.0f} Pa on average, {:.0f} to {:.0f} Pa, of the {:.0f} Pa asked for\n",
                    finger.id, stats.solids[finger.solid], mean_pa, finger.least_pa, finger.most_pa, finger.asked_pa);
  }
  return most_pa > array::linear_pressure_pa ? text + setup::linear_line() : text;
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

void refuse_what_goes_unused(const RunCommand& o) {
  if (o.touch.spot_m && !o.touch.tune) throw bad_usage("--spot goes with --tune");
  if (o.noise_free && o.source.starts_with("recording:")) {
    throw bad_usage("--noise-free goes with --source synthetic: a recording has the noise that it has");
  }
}

void report(const RunCommand& o, const Outputs& outputs, const session::LoopStats& stats) {
  if (!o.common.json.empty()) write_file(o.common.json, session::to_json(stats));
  if (o.stats == StatsFormat::json) {
    if (o.common.json != "-") write_file("-", session::to_json(stats));
  } else if (setup::shows_summary(o.common, outputs)) {
    write_file("-", summary(stats));
  }
}

/// Says once that a frame had more fingers than are played.
void warn_of_left_out_fingers(const touch::Touch& touch, bool& warned) {
  if (touch.cluster_count <= touch.finger_count || std::exchange(warned, true)) return;
  log::warning(fmt::format("{} clusters of contacts make a finger, only the first {} are kept", touch.cluster_count,
                           touch.finger_count));
}

/// What the options make a session of, for the frames of `source`.
session::SessionSetting session_setting(const RunCommand& o, std::vector<geometry::Solid> solids,
                                        const sensing::DepthSource& source, array::Layout layout) {
  session::ScheduleOptions schedule = setup::schedule_options(o.touch);
  schedule.voice.pressure_pa = o.drive.pressure_pa;
  return {.scene = o.scene,
          .solids = std::move(solids),
          .cameras = source.cameras(),
          .layout = std::move(layout),
          .touch = o.touch.parameters,
          .schedule = std::move(schedule),
          .drive = setup::drive_options(o.drive, o.touch.method.method),
          .events = o.events.empty() ? std::nullopt : std::optional(o.event),
          .axes = o.axes,
          .smoothing = o.smoothing,
          .hold_s = o.hold_s,
          .safety = o.safety};
}

std::unique_ptr<sensing::DepthSource> open_source(const RunCommand& o, const Extensions& extensions,
                                                  const setup::PosedRig& rig) {
  std::vector<session::SourceKind> sources = session::builtin_sources();
  sources.insert(sources.end(), extensions.sources.begin(), extensions.sources.end());
  const geometry::Mesh boards = array::board_mesh(rig.layout);
  return session::open_source(o.source, sources,
                              {.cameras = rig.rig.cameras,
                               .occluders = boards,
                               .default_skin = setup::find_asset("finger.ply"),
                               .noise = !o.noise_free,
                               .seed = o.common.seed,
                               .paced = !o.every_frame,
                               .rig = rig.rig.file});
}

/// The link of the line. Where it cannot be opened there will be no frames, and no recording without any is left.
std::unique_ptr<session::Link> open_link(const RunCommand& o, std::span<const session::LinkKind> links,
                                         const session::Session& session,
                                         std::optional<sensing::RecordingWriter>& recorder) {
  try {
    return session::open_link(o.link, links, session.link_setting());
  } catch (...) {
    if (recorder) recorder->discard();
    throw;
  }
}

/// What is said where something keeps palpa from ending.
std::string late_line(const RunCommand& o) {
  std::string waits = "the GPU";
  for (const auto& [option, target] : {std::pair("--link", o.link), std::pair("--events", o.events),
                                       std::pair("--record", o.record), std::pair("--json", o.common.json)}) {
    if (!target.empty() && target != "null") waits += fmt::format(", {} {}", option, target);
  }
  return fmt::format("ended without finishing, a second after the signal: what it waited for did not answer ({})",
                     waits);
}

/// Hands over what waits. After an error that error is the one to report, not another of the sink's.
void finish(session::EventSink* sink, bool after_error) {
  try {
    if (sink) sink->finish();
  } catch (const std::exception&) {
    if (!after_error) throw;
  }
}

void run(const Extensions& extensions, const RunCommand& o) {
  if (o.scene.empty()) throw bad_usage("--scene is missing: give a glTF model, such as assets/cube.glb");
  check(o.touch);
  refuse_what_goes_unused(o);
  std::vector<session::LinkKind> links = session::builtin_links();
  links.insert(links.end(), extensions.links.begin(), extensions.links.end());
  const Outputs outputs(outputs_of(o, links));
  std::optional<setup::Preparing> preparing(std::in_place, o.common.quiet);
  std::vector<geometry::Solid> solids = setup::load_solids(o.scene, o.gltf_scene, o.solids);
  check(o.drive, solids);
  const setup::PosedRig rig = setup::load_posed_rig(o.rig);
  const std::unique_ptr<sensing::DepthSource> source = open_source(o, extensions, rig);
  setup::warn_of_reach(rig.layout, solids);
  session::SessionSetting setting = session_setting(o, std::move(solids), *source, rig.layout);
  setup::warn_of_frequency(setting.layout, setting.drive.medium);
  std::optional<gpu::Device> device;
  if (o.common.backend == setup::Backend::gpu) device.emplace(setup::device_options(o.common));
  session::Session session =
      device ? session::Session(*device, std::move(setting)) : session::Session(std::move(setting));
  preparing.reset();

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

  const log::Relay relay;
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
  report(o, outputs, stats);
}

}  // namespace

void add_run(Program& program) {
  const Extensions& extensions = program.extensions;
  add_subcommand<RunCommand>(
      program,
      {"run", "the live loop: frames in, drives out, until Ctrl-C",
       "  palpa run --scene assets/cube.glb --source synthetic --link null --frames 300 --stats json\n"
       "  palpa run --scene assets/cube.glb --link foci:udp:127.0.0.1:9000 --events - --pressure 8kPa\n"
       "  palpa run --scene assets/cube.glb --frames 90 --record take1\n"
       "  palpa run --scene assets/cube.glb --source recording:take1 --link record:drives.bin"},
      add_options, [&extensions](const RunCommand& o) { run(extensions, o); });
}

}  // namespace palpa::cli
