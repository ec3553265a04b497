#include "session/replay.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <utility>

#include "array/loudness.hpp"
#include "base/error.hpp"
#include "base/files/json_rows.hpp"
#include "base/files/json_writer.hpp"
#include "session/predict/capture_times.hpp"

namespace palpa::session {
std::string to_json(const ReplayStats& stats) {
  JsonWriter json;
  json.begin_object().member("frames", stats.frames).member("touching", stats.touching);
  if (stats.untouched) write_untouched(*stats.untouched, json);
  json.member("drives", stats.drives)
      .member("silent_drives", stats.silent_drives)
      .member("slot_s", stats.slot_s)
      .member("duration_s", stats.duration_s);
  if (stats.driven) array::driven_rows().write_members(json, *stats.driven);
  if (stats.dropped) write_dropped(*stats.dropped, json);
  write_pressures(stats.fingers, stats.solids, json);
  json.end_object();
  return json.take();
}

namespace {

void take_counts(const Player& player, ReplayStats& stats) {
  stats.drives = player.drives();
  stats.silent_drives = player.silent_drives();
  stats.duration_s = player.duration_s();
}

}  // namespace

Player::Player(Link& link, const OutputSetting& setting)
    : setting_(setting),
      safe_(link, setting.layout.transducers.size(), setting.safety, setting.slot_s, {}, setting.drive) {
  scratch_.reserve(setting);
  nothing_.slot_s = setting.slot_s;
}

std::uint64_t Player::slot_at(double time_s) const {
  // The tolerance ensures that rounding of summed times does not miss a slot.
  const double slots = std::ceil((time_s - begin_s_) / setting_.slot_s - 1e-6);
  return std::max(slot_, static_cast<std::uint64_t>(std::max(slots, 0.0)));
}

void Player::tell(const Plan& plan) {
  sounding_ = plan.schedule.voice_count > 0;
  if (sounding_) {
    const std::uint64_t until = slot_at(plan.captured_s + setting_.hold_s);
    safe_.plan(played(plan, setting_.layout.transducers.size(), slot_, until));
  } else {
    tell_nothing(plan);
  }
}

void Player::play_until(std::uint64_t end, const Plan& plan, const std::atomic<bool>& stop) {
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
    const auto drive = drive_of_slot(plan, slot_, now_s, setting_, scratch_);
    silent ? safe_.send(slot_, drive) : safe_.send_planned(slot_, drive);
    ++drives_;
    silent_drives_ += safe_.sounded() ? 0 : 1;
    silent_slots_ = silent && !safe_.must_fade() ? silent_slots_ + 1 : 0;
  }
}

void Player::fade(const Plan& plan, const std::atomic<bool>& stop) {
  if (safe_.must_fade() && std::exchange(sounding_, false)) tell_nothing(plan);
  while (safe_.must_fade() && !stop)
    play_until(slot_ + 1, plan, stop);
}

void Player::tell_nothing(const Plan& plan) {
  nothing_.time_s = plan.schedule.time_s;
  safe_.plan({.schedule = nothing_, .slots = {slot_, slot_}});
}

ReplayStats replay(const PlayedFoci& played, const OutputSetting& setting, Link& link, const std::atomic<bool>& stop) {
  ReplayStats stats;
  stats.slot_s = setting.slot_s;
  stats.solids = played.solids;
  stats.driven = array::driven_by(setting.drive, setting.layout.transducers.size(), false);
  Player player(link, setting);
  PressureLog pressures(played.solids);
  array::Loudness loudness(setting.layout, setting.drive);
  SlotWork work;
  array::SlotDrives slots;
  Plan plan;
  if (!played.frames.empty()) player.skip_to(played.frames.front().slot);
  for (auto frame = played.frames.begin(); frame != played.frames.end() && !stop; ++frame) {
    list_nothing(plan);
    plan.schedule = frame->schedule;
    plan.captured_s = static_cast<double>(frame->slot) * setting.slot_s;
    drive_on_host(plan, setting.layout, setting.drive, work, &loudness, slots);
    ++stats.frames;
    stats.touching += plan.schedule.voice_count > 0 ? 1 : 0;
    player.tell(plan);
    pressures.planned(plan.schedule);
    if (frame + 1 != played.frames.end()) {
      player.play_until((frame + 1)->slot, plan, stop);
    } else if (plan.schedule.voice_count > 0) {
      player.play_until(player.slot_at(plan.captured_s + setting.hold_s), plan, stop);
    }
  }
  player.fade(plan, stop);
  player.finish();
  take_counts(player, stats);
  stats.fingers = pressures.fingers();
  return stats;
}

ReplayStats replay(Session& session, sensing::DepthSource& source, Link& link, const std::atomic<bool>& stop,
                   const ReplayOptions& options) {
  const SessionSetting& setting = session.setting();
  if (!setting.live())
    throw bad_usage(
        "a session without cameras or a tracker, or without an array, or one of single frames, cannot be played");
  const bool tells = options.events != nullptr;
  check_run(setting, tells, "is played");
  constexpr double patience_s = 1;
  session.warm_up();
  ReplayStats stats;
  if (drops_points(setting)) stats.dropped.emplace();
  stats.slot_s = session.link_setting().slot_s;
  Player player(link, {setting.layout, setting.drive, stats.slot_s, setting.hold_s, setting.safety});
  stats.solids = session.solid_names();
  stats.driven = session.driven_by();
  PressureLog pressures(session.solid_names());
  try {
    sensing::FrameSet set;
    CaptureTimes times;
    double time_s = 0;
    while (!stop && (options.frames == 0 || stats.frames < options.frames) && source.next(set, patience_s)) {
      if (!set.came()) continue;
      if (stats.frames == 0) {
        player.begin_at(time_s = set.time_s);
      } else {
        time_s = std::max(time_s, set.time_s);
        player.play_until(player.slot_at(time_s), session.plan(), stop);
      }
      times.see(set.time_s);
      const touch::Touch& touch = set.tracked ? session.touch(set.capsules, time_s, player.next_slot(), set.in_doubt)
                                              : session.touch(set.frames, time_s, player.next_slot());
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
    take_counts(player, stats);
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
