// The frames of a file, at their times or one after the other.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "base/error.hpp"
#include "base/files/input_file.hpp"
#include "base/log.hpp"
#include "sensing/joints/hand_check.hpp"
#include "sensing/joints/left_out.hpp"
#include "sensing/joints/read_frame.hpp"
#include "sensing/joints/tracker.hpp"
#include "sensing/recording.hpp"

namespace palpa::sensing {
namespace {

using Clock = std::chrono::steady_clock;

std::vector<TrackedFrame> load_frames(const std::string& file) {
  const std::string text = read_text_file(file, most_tracker_bytes);
  std::vector<TrackedFrame> frames;
  std::size_t number = 0;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string line = text.substr(begin, end - begin), place = fmt::format("{}: line {}", file, ++number);
    const bool torn = end == text.size();
    begin = end + 1;
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    std::optional<TrackedFrame> frame;
    try {
      frame = read_frame(line, place);
    } catch (const Error&) {
      if (!torn || frames.empty() || line[0] != '{') throw;
      log::warning(place + ": it has no end, and is no whole frame; it is left out");
    }
    if (!frame) continue;
    if (!frames.empty() && frame->time_s <= frames.back().time_s)
      throw bad_input(
          place, fmt::format("its time, {} s, is not after the one before, {} s", frame->time_s, frames.back().time_s));
    if (frames.size() == most_tracker_frames)
      throw bad_input(place, fmt::format("more than {} frames", most_tracker_frames));
    frames.push_back(*std::move(frame));
  }
  if (frames.empty()) throw bad_input(file, "has no frame: give a line of JSON for each (docs/trackers.md)");
  std::vector<double> times_s;
  for (const TrackedFrame& frame : frames)
    times_s.push_back(frame.time_s);
  if (const std::string odd = implausible_times(times_s, 0); !odd.empty())
    log::warning(fmt::format("{}: {}", file, odd));
  return frames;
}

class FileTracker final : public Tracker {
 public:
  FileTracker(const std::string& file, bool paced)
      : left_out_("joints:" + file), frames_(load_frames(file)), paced_(paced) {}

  bool next(TrackedFrame& out, bool& came, std::uint64_t& number, double timeout_s) override {
    came = false;
    if (next_ == frames_.size()) return false;
    if (paced_) {
      if (!begin_) begin_ = Clock::now();
      const double elapsed_s = std::chrono::duration<double>(Clock::now() - *begin_).count();
      // A late caller gets the newest frame.
      while (next_ + 1 < frames_.size() && due_s(next_ + 1) <= elapsed_s)
        ++next_;
      const double wait_s = due_s(next_) - elapsed_s;
      std::this_thread::sleep_for(std::chrono::duration<double>(std::clamp(wait_s, 0.0, std::max(timeout_s, 0.0))));
      if (wait_s > timeout_s) return true;
    }
    came = true;
    number = next_;
    out = frames_[next_++];
    if (const auto doubt = check_.check(out, out.time_s)) left_out_.add(to_text(*doubt));
    return true;
  }

 private:
  double due_s(std::size_t frame) const { return frames_[frame].time_s - frames_.front().time_s; }

  LeftOut left_out_;
  std::vector<TrackedFrame> frames_;
  bool paced_;
  HandCheck check_;
  std::size_t next_ = 0;
  std::optional<Clock::time_point> begin_;
};

}  // namespace

std::unique_ptr<Tracker> open_file_tracker(const std::string& file, bool paced) {
  return std::make_unique<FileTracker>(file, paced);
}

}  // namespace palpa::sensing
