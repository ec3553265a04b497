// The line in which `palpa run` shows its state on a terminal.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <string>
#include <thread>

#include "session/plan/planner.hpp"
#include "session/watch/sound_watch.hpp"

namespace palpa::cli {

/// What the line says.
struct RunState {
  std::string link;                  ///< as --link names it
  std::uint64_t frames = 0;          ///< processed so far
  std::uint64_t of = 0;              ///< of so many; 0: no end
  double rate_hz = 0;                ///< frames per second
  double latency_s = 0;              ///< mean, from a frame in memory to its drives; only if frames came
  std::uint32_t fingers = 0;         ///< that touch in the newest frame
  double depth_m = 0;                ///< of the deepest of them
  bool sounds = false;               ///< a drive that sounds has just arrived
  bool stuck = false;                ///< drives that sound leave, and none arrives
  std::uint64_t to_be_recorded = 0;  ///< after the end: frames that still have to be written
};

/// "SOUNDING on openmpd:A | 2 fingers, 1.4 mm deep | 90 frames/s, 4.2 ms | Ctrl-C stops". With fewer words if it has
/// more than `columns`, or else cut.
std::string run_line(const RunState& state, std::size_t columns);

/// While this object lives, the line is shown twice a second. Nothing is shown if `quiet`, if stderr is no terminal, or
/// while palpa is in the background. Each function may be called on any thread, and returns at once.
class RunLine {
 public:
  /// Whether it would be shown.
  static bool is_shown(bool quiet);

  /// `frames`: see RunState::of.
  RunLine(std::string link, std::uint64_t frames, bool quiet);
  /// Erases the line.
  ~RunLine();
  RunLine(const RunLine&) = delete;
  RunLine& operator=(const RunLine&) = delete;

  void planned(const session::FrameReport& frame);
  void sent(bool sounds, const session::HandOver& counts);
  void recording_rest(std::uint64_t frames);

 private:
  void show();
  RunState take_state(double elapsed_s);

  std::mutex mutex_;
  std::condition_variable end_;
  RunState state_;
  session::SoundWatch sound_;
  std::uint64_t new_frames_ = 0;  ///< since the line was drawn,
  double new_latency_s_ = 0;      ///< and the sum of their latencies
  bool ending_ = false;
  std::thread thread_;
};

}  // namespace palpa::cli
