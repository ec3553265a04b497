#include "session/replay.hpp"

#include <algorithm>
#include <exception>

#include "array/loudness.hpp"
#include "base/error.hpp"
#include "base/files/json_writer.hpp"
#include "session/player.hpp"
#include "session/predict/capture_times.hpp"

namespace palpa::session {
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

namespace {

void take_counts(const Player& player, ReplayStats& stats) {
  stats.drives = player.drives();
  stats.silent_drives = player.silent_drives();
  stats.duration_s = player.duration_s();
}

}  // namespace

ReplayStats replay(const PlayedFoci& played, const OutputSetting& setting, Link& link, const std::atomic<bool>& stop) {
  ReplayStats stats;
  stats.slot_s = setting.slot_s;
  stats.solids = played.solids;
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
