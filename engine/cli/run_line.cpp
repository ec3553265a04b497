#include "cli/run_line.hpp"

#include <fmt/core.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "base/log.hpp"
#include "base/system/start_thread.hpp"
#include "base/text.hpp"
#include "session/threads.hpp"
#include "setup/process/progress.hpp"

namespace palpa::cli {
namespace {

using Clock = std::chrono::steady_clock;

std::size_t columns_of_terminal() {
  constexpr std::size_t usual = 80;
  winsize size{};
  return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : usual;
}

/// How much of it is written out.
enum class Words { all, most, few, fewest };

std::string link_text(const RunState& state, Words words) {
  const char* sound = state.stuck ? "MAY SOUND" : state.sounds ? "SOUNDING" : "silent";
  if (words == Words::fewest) return sound;
  const char* note = state.stuck                                   ? ", which takes no drives"
                     : words == Words::all && state.link == "null" ? " (no array)"
                                                                   : "";
  return fmt::format("{} on {}{}", sound, shortened(printable(state.link), 30), note);
}

std::string fingers_text(const RunState& state, Words words) {
  if (state.fingers == 0) return "no touch";
  const char* deep = words <= Words::most ? " deep" : "";
  return fmt::format("{}, {:.1f} mm{}", counted(state.fingers, "finger"), state.depth_m * 1e3, deep);
}

std::string frames_text(const RunState& state, Words words) {
  const bool all = words <= Words::most;
  std::string text;
  if (state.of > 0) text = fmt::format("{}{}{}{}, ", state.frames, all ? " of " : "/", state.of, all ? " frames" : "");
  if (state.rate_hz == 0) return text + "no frames now";
  const char* frames = all && state.of == 0 ? " frames" : "";
  return text + fmt::format("{:.0f}{}/s, {:.1f} ms", state.rate_hz, frames, state.latency_s * 1e3);
}

}  // namespace

std::string run_line(const RunState& state, std::size_t columns) {
  std::string line;
  if (state.to_be_recorded > 0) {
    line =
        fmt::format("silent | writing the recording: {} left | Ctrl-C stops", counted(state.to_be_recorded, "frame"));
  } else {
    for (const Words words : {Words::all, Words::most, Words::few, Words::fewest}) {
      line = fmt::format("{} | {} | {} | Ctrl-C stops", link_text(state, words), fingers_text(state, words),
                         frames_text(state, words));
      if (line.size() <= columns) break;
    }
  }
  if (line.size() > columns) line.resize(columns);
  return line;
}

bool RunLine::is_shown(bool quiet) {
  return !quiet && isatty(STDERR_FILENO) != 0;
}

RunLine::RunLine(std::string link, std::uint64_t frames, bool quiet) {
  state_.link = std::move(link);
  state_.of = frames;
  if (is_shown(quiet)) thread_ = try_thread([this] { show(); });  // the run continues without being shown
}

RunLine::~RunLine() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  end_.notify_one();
  thread_.join();
}

void RunLine::planned(const session::FrameReport& frame) {
  const std::lock_guard lock(mutex_);
  ++state_.frames;
  ++new_frames_;
  new_latency_s_ += frame.planned_s - frame.arrived_s;
  state_.fingers = frame.touch->finger_count;
  state_.depth_m = 0;
  for (std::uint32_t f = 0; f < frame.touch->finger_count; ++f)
    state_.depth_m = std::max(state_.depth_m, double{frame.touch->fingers[f].depth_m});
}

void RunLine::sent(bool sounds, const session::HandOver& counts) {
  sound_.sent(sounds, counts.behind);
}

void RunLine::recording_rest(std::uint64_t frames) {
  const std::lock_guard lock(mutex_);
  state_.to_be_recorded = frames;
}

/// With the mutex held.
RunState RunLine::take_state(double elapsed_s) {
  const auto count = static_cast<double>(std::exchange(new_frames_, 0));
  const double latency_s = std::exchange(new_latency_s_, 0);
  state_.rate_hz = count / elapsed_s;
  state_.sounds = sound_.sounding();
  state_.stuck = sound_.stuck();
  if (count > 0) state_.latency_s = latency_s / count;
  // A touch of a frame that is out of date is no touch.
  if (count == 0) state_.fingers = 0;
  return state_;
}

void RunLine::show() {
  session::take_turns();  // the thread that started this one may have precedence
  constexpr std::chrono::milliseconds moment(500);
  bool drawn = false;
  std::unique_lock lock(mutex_);
  Clock::time_point last = Clock::now();
  while (!end_.wait_for(lock, moment, [this] { return ending_; })) {
    if (state_.frames == 0) continue;  // Preparing has the line
    const Clock::time_point now = Clock::now();
    const RunState state = take_state(std::chrono::duration<double>(now - std::exchange(last, now)).count());
    lock.unlock();
    if (setup::is_in_foreground()) {
      log::draw(fmt::format("\r{}\x1b[K", run_line(state, columns_of_terminal() - 1)));
      drawn = true;
    }
    lock.lock();
  }
  // Carriage return, then erase to the end of the line.
  if (drawn && setup::is_in_foreground()) log::draw("\r\x1b[K");
}

}  // namespace palpa::cli
