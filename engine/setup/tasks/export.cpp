#include "setup/tasks/export.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <exception>
#include <initializer_list>
#include <utility>

#include "base/error.hpp"
#include "session/links/record_link.hpp"
#include "session/links/spec.hpp"
#include "setup/options/warnings.hpp"
#include "setup/sessions/kept_frames.hpp"
#include "setup/sessions/near_skin.hpp"

namespace palpa::setup {
namespace {

/// Throws bad_usage if one of these options is given: its name, whether it is given.
void refuse_given(std::initializer_list<std::pair<const char*, bool>> options, const char* why) {
  for (const auto& [name, given] : options) {
    if (given) throw bad_usage(fmt::format("{} {}", name, why));
  }
}

/// Throws bad_usage if an option is given that none of the task's outputs depends on.
void refuse_idle(const ExportTask& task, std::span<const geometry::Solid> solids) {
  const ExportTask usual;
  const TouchOptions& touch = task.touch;
  const FocusingOptions &drive = task.drive, &usual_drive = usual.drive;
  const bool drives = !task.drives.empty(), foci = !task.foci.empty();
  // Requested pressures are reported even if no drives are written.
  const bool pressure = drive.pressure_pa || std::ranges::any_of(solids, [](const geometry::Solid& solid) {
                          return solid.haptics.pressure_pa.has_value();
                        });
  const bool order = drives || pressure || (foci && !task.foci.ends_with(".csv"));
  if (!drives && !foci && !pressure) {
    refuse_given({{touch.foci_name, touch.parameters.foci != usual.touch.parameters.foci},
                  {"--spacing", touch.parameters.spacing != usual.touch.parameters.spacing},
                  {"--method", touch.method.method != usual.touch.method.method},
                  {"--axes", task.axes != usual.axes},
                  {"--smoothing", task.smoothing != usual.smoothing},
                  {"--predict-latency", task.predict_latency_s.has_value()}},
                 "goes with --foci, --drives or --pressure: events do not depend on foci");
  }
  if (!drives && !foci) {
    refuse_given({{"--ceiling", task.safety.ceiling != usual.safety.ceiling}},
                 "goes with --foci or --drives: events and pressures do not depend on it");
  }
  if (!order) {
    refuse_given({{"--stride", touch.stride.has_value()},
                  {"--modulation", touch.modulation != usual.touch.modulation},
                  {"--modulation-frequency", touch.modulation_hz != usual.touch.modulation_hz},
                  {"--tune", touch.tune}},
                 "goes with --drives, --pressure or --foci FILE.json, which have the order and the modulation of foci");
  }
  if (drives || pressure) return;
  const std::string source = session::parse_spec(task.source).name;
  const bool hides = source == "synthetic" || source == "mouse";  // boards hide what is behind them
  refuse_given({{"--amplitude", drive.weighting != usual_drive.weighting},
                {"--solver", drive.solver.has_value()},
                {"--constraint", drive.constraint.has_value()},
                {"--directivity", drive.directivity != usual_drive.directivity},
                {"--temperature", drive.medium.celsius.has_value()},
                {"--sound-speed", drive.medium.sound_speed.has_value()},
                {"--frequency", drive.medium.frequency != usual_drive.medium.frequency},
                {"--layout", !task.rig.layout.empty() && task.rig.rig.empty() && !hides},
                {"--rig", !task.rig.rig.empty() && source == "recording"}},
               "goes with --drives or --pressure: nothing else that is exported depends on the array's sound");
}

FrameOptions unmeasured(FrameOptions options) {
  options.leave_out_unmeasured_prediction();
  return options;
}

}  // namespace

/// Several links at once. A fault of one of them does not keep a plan, a drive, above all the silence at the end, from
/// the others; the first fault is thrown when all have been called.
class ExportRun::Links final : public session::Link {
 public:
  explicit Links(std::span<session::Link* const> links) {
    for (session::Link* const link : links)
      add(link);
  }
  /// `link` must outlive this object; nothing is added if it is null.
  void add(session::Link* link) {
    if (link) links_.push_back({link});
  }
  void plan(const session::PlayedPlan& plan) override {
    each([&](Output& output) { output.link->plan(plan); });
  }
  void send(std::uint64_t slot, std::span<const array::TransducerDrive> drive) override {
    // If another link failed, the silence that follows takes the same slot. For a link that got that slot's drive, it
    // comes one later, because a link's slots ascend.
    each([&](Output& output) {
      const std::uint64_t free = std::max(slot, output.next_slot);
      output.link->send(free, drive);
      output.next_slot = free + 1;
    });
  }
  void finish() override {
    each([](Output& output) { output.link->finish(); });
  }

 private:
  struct Output {
    session::Link* link;
    std::uint64_t next_slot = 0;
  };

  template <typename Call>
  void each(Call call) {
    std::exception_ptr fault;
    for (Output& output : links_) {
      try {
        call(output);
      } catch (...) {
        fault = fault ? fault : std::current_exception();
      }
    }
    if (fault) std::rethrow_exception(fault);
  }

  std::vector<Output> links_;
};

void check(const ExportTask& task, std::span<const session::SourceKind> sources, bool own_links) {
  if (task.hold_auto) throw bad_usage("--hold auto goes with palpa run: exported frames are never late");
  check(task);
  task.refuse_unmeasured_prediction("exported frames");
  if (task.foci.empty() && task.events.empty() && task.drives.empty() && !own_links)
    throw bad_usage("nothing to export: give --foci, --events or --drives");
  if (!task.foci.empty()) session::check_foci_file(task.foci);
  if (task.frames == 0 && !session::ends_by_itself(task.source, with_builtin(sources)))
    throw bad_usage(fmt::format("--source {} does not end: give --frames, or recording:DIR or bag:FILE", task.source));
}

void FocusRows::plan(const session::PlayedPlan& plan) {
  for (std::uint32_t v = 0; v < plan.schedule.voice_count; ++v) {
    const array::Voice& voice = plan.schedule.voices[v];
    for (std::uint32_t n = 0; n < voice.foci.size(); ++n) {
      rows_.push_back(
          {plan.slots.from, plan.schedule.time_s, voice.id, voice.solid, n, glm::vec3(voice.foci[n]), voice.gain});
    }
  }
}

std::string to_json(const ExportResult& result) {
  return session::to_json(result.stats);
}

ExportRun::ExportRun(const ExportTask& task, std::span<const session::SourceKind> sources, std::atomic<bool>& stop,
                     std::span<session::Link* const> links)
    : frames_(task.frames), stop_(&stop), prepared_(prepare(unmeasured(task), sources, false)) {
  const session::Session& session = *prepared_.session;
  if (links.empty()) refuse_idle(task, session.solids());
  const session::SessionSetting& setting = session.setting();
  if (task.drives.empty() && links.empty()) {
    warn_of_frequency(setting.layout, setting.drive.medium);
  } else {
    check_frequency(setting.layout, setting.drive.medium);
    refuse_coarse_modulation(session);
  }
  if (!task.events.empty()) sink_ = session::open_event_sink(task.events, session.solid_names(), stop_, true);
  if (!task.foci.empty()) foci_ = session::open_foci_file(task.foci, session.link_setting());
  if (!task.drives.empty()) drives_ = session::open_record_link(task.drives, session.link_setting(), stop_);
  links_ = std::make_unique<Links>(links);
  links_->add(foci_.get());
  links_->add(drives_.get());
}

ExportRun::~ExportRun() = default;

ExportResult ExportRun::run(const session::ReplayOptions& looking) {
  session::ReplayOptions options{.frames = frames_};
  if (sink_ || looking.events) {
    options.events = [&](std::span<const session::Event> events) {
      if (sink_) sink_->write(events);
      if (looking.events) looking.events(events);
    };
  }
  options.planned = [&, warned = false](const session::FrameReport& frame) mutable {
    if (looking.planned) looking.planned(frame);
    warn_of_left_out_fingers(*frame.touch, warned);
  };
  ExportResult result;
  try {
    KeptFrames kept(*prepared_.source);
    result.stats = session::replay(*prepared_.session, kept, *links_, *stop_, options);
    if (result.stats.touching == 0 && result.stats.frames > 0)
      result.stats.untouched = find_untouched(prepared_.session->setting(), kept.frames());
  } catch (...) {
    finish(sink_.get(), true);
    throw;
  }
  finish(sink_.get(), false);
  result.stopped = *stop_;
  if (foci_ && !result.stopped) foci_->commit();
  return result;
}

}  // namespace palpa::setup
