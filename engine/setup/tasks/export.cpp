#include "setup/tasks/export.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <exception>

#include "base/error.hpp"
#include "session/links/record_link.hpp"

namespace palpa::setup {

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
    : frames_(task.frames), stop_(&stop), prepared_(prepare(task, sources, false)) {
  const session::Session& session = *prepared_.session;
  if (!task.events.empty()) sink_ = session::open_event_sink(task.events, session.solid_names(), stop_);
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
    result.stats = session::replay(*prepared_.session, *prepared_.source, *links_, *stop_, options);
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
