#include "session/replay.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <utility>

#include "base/error.hpp"
#include "base/json_writer.hpp"
#include "session/links/safe_link.hpp"
#include "session/loop/output.hpp"
#include "session/predict/capture_times.hpp"

namespace palpa::session {
namespace {

/// Plays one plan after the other, slot by slot.
class Player {
 public:
  Player(Link& link, const OutputSetting& setting, ReplayStats& stats)
      : setting_(setting),
        stats_(stats),
        safe_(link, setting.layout.transducers.size(), setting.safety, setting.slot_s) {
    scratch_.reserve(setting);
    nothing_.slot_s = setting.slot_s;
  }

  void begin_at(double time_s) { begin_s_ = time_s; }

  /// The first slot that begins at that time or later. The tolerance ensures that rounding of summed times does not
  /// miss a slot.
  std::uint64_t slot_at(double time_s) const {
    const double slots = std::ceil((time_s - begin_s_) / setting_.slot_s - 1e-6);
    return std::max(slot_, static_cast<std::uint64_t>(std::max(slots, 0.0)));
  }

  std::uint64_t next_slot() const { return slot_; }

  /// The plan sounds from here on.
  void tell(const Plan& plan) {
    sounding_ = plan.schedule.voice_count > 0;
    if (sounding_) {
      const std::uint64_t until = slot_at(plan.captured_s + setting_.hold_s);
      safe_.plan(played(plan, setting_.layout.transducers.size(), slot_, until));
    } else {
      tell_nothing(plan);
    }
  }

  void play_until(std::uint64_t end, const Plan& plan, const std::atomic<bool>& stop) {
    const std::uint64_t expiry = slot_at(plan.captured_s + setting_.hold_s);
    for (; slot_ < end && !stop; ++slot_) {
      const bool silent = plan.schedule.voice_count == 0 || slot_ >= expiry;
      if (silent && (silent_slots_ >= most_silent_slots ||
                     static_cast<double>(silent_slots_) * setting_.slot_s >= most_silence_s)) {
        slot_ = end;
        break;
      }
      if (silent && sounding_) tell_nothing(plan);
      sounding_ = !silent;
      // The slot number identifies the drive; the time decides only whether the plan has expired.
      const double now_s = silent ? plan.captured_s + setting_.hold_s : plan.captured_s;
      safe_.send(slot_, drive_of_slot(plan, slot_, now_s, setting_, scratch_));
      ++stats_.drives;
      stats_.silent_drives += silent ? 1 : 0;
      silent_slots_ = silent && !safe_.must_fade() ? silent_slots_ + 1 : 0;
    }
  }

  /// Fades out the remaining sound.
  void fade(const Plan& plan, const std::atomic<bool>& stop) {
    if (safe_.must_fade() && std::exchange(sounding_, false)) tell_nothing(plan);
    while (safe_.must_fade() && !stop)
      play_until(slot_ + 1, plan, stop);
  }

  void finish() {
    safe_.finish();
    stats_.duration_s = static_cast<double>(slot_) * setting_.slot_s;
  }

 private:
  void tell_nothing(const Plan& plan) {
    nothing_.time_s = plan.schedule.time_s;
    safe_.plan({.schedule = nothing_, .slots = {slot_, slot_}});
  }

  OutputSetting setting_;
  ReplayStats& stats_;
  SafeLink safe_;
  SlotScratch scratch_;
  array::Schedule nothing_;
  double begin_s_ = 0;
  std::uint64_t slot_ = 0;
  std::uint64_t silent_slots_ = 0;  ///< consecutive silent slots so far
  bool sounding_ = false;
};

}  // namespace

std::string to_json(const ReplayStats& stats) {
  JsonWriter json;
  json.begin_object()
      .member("frames", stats.frames)
      .member("touching", stats.touching)
      .member("drives", stats.drives)
      .member("silent_drives", stats.silent_drives)
      .member("slot_s", stats.slot_s)
      .member("duration_s", stats.duration_s);
  if (stats.dropped) write_dropped(*stats.dropped, json);
  write_pressures(stats.fingers, stats.solids, json);
  json.end_object();
  return json.take();
}

ReplayStats replay(Session& session, sensing::DepthSource& source, Link& link, const std::atomic<bool>& stop,
                   const ReplayOptions& options) {
  const SessionSetting& setting = session.setting();
  if (!setting.live())
    throw bad_usage("a session without cameras or without an array, or one of single frames, cannot be played");
  const bool tells = options.events != nullptr;
  if (setting.schedule.tune == Tune::all) {
    throw bad_usage("a session that is played can tune strides only: the length of its slots is fixed");
  }
  if (tells && !setting.events) throw bad_usage("a session whose setting has no events cannot report any");
  constexpr double patience_s = 1;
  session.warm_up();
  ReplayStats stats;
  if (drops_points(setting)) stats.dropped.emplace();
  stats.slot_s = session.link_setting().slot_s;
  Player player(link, {setting.layout, setting.drive, stats.slot_s, setting.hold_s, setting.safety}, stats);
  stats.solids = session.solid_names();
  PressureLog pressures(session.solid_names());
  try {
    sensing::FrameSet set;
    CaptureTimes times;
    double time_s = 0;
    while (!stop && (options.frames == 0 || stats.frames < options.frames) && source.next(set, patience_s)) {
      if (set.frames.empty()) continue;
      if (stats.frames == 0) {
        player.begin_at(time_s = set.time_s);
      } else {
        time_s = std::max(time_s, set.time_s);
        player.play_until(player.slot_at(time_s), session.plan(), stop);
      }
      times.see(set.time_s);
      const touch::Touch& touch = session.touch(set.frames, time_s, player.next_slot());
      ++stats.frames;
      stats.touching += touch.finger_count > 0 ? 1 : 0;
      if (stats.dropped) *stats.dropped += touch.dropped;
      player.tell(session.plan());
      pressures.planned(session.schedule());
      if (options.planned) options.planned(session.report());
      if (tells) options.events(session.events());
    }
    if (stats.frames > 0) {
      player.play_until(player.slot_at(time_s + setting.hold_s), session.plan(), stop);
      player.fade(session.plan(), stop);
    }
    player.finish();
  } catch (...) {
    const std::exception_ptr fault = std::current_exception();
    try {
      if (tells) options.events(session.end());
    } catch (const std::exception&) {  // the first error is the one to report
    }
    std::rethrow_exception(fault);
  }
  stats.fingers = pressures.fingers();
  if (tells) options.events(session.end());
  return stats;
}

}  // namespace palpa::session
