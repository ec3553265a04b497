#include <algorithm>
#include <chrono>
#include <thread>

#include "sensing/recording.hpp"

namespace palpa::sensing {
namespace {

using Clock = std::chrono::steady_clock;

class Replay : public DepthSource {
 public:
  Replay(Recording recording, PlaybackOptions options) : recording_(std::move(recording)), options_(options) {
    const auto& entries = recording_.entries;
    const double length = entries.back().time_s - entries.front().time_s;
    // One round lasts until the time of the frame that would follow.
    const double step = entries.size() > 1                       ? length / static_cast<double>(entries.size() - 1)
                        : recording_.cameras.front().rate_hz > 0 ? 1 / recording_.cameras.front().rate_hz
                                                                 : 1.0 / 90;
    round_s_ = length + step;
    round_sequences_ = entries.back().sequence - entries.front().sequence + 1;
  }

  const std::vector<Camera>& cameras() const override { return recording_.cameras; }

  bool next(FrameSet& out, double timeout_s) override {
    if (ended()) return false;
    if (options_.paced) {
      if (!started_) start_ = Clock::now();
      started_ = true;
      const double elapsed = std::chrono::duration<double>(Clock::now() - start_).count();
      // A late caller gets the newest frame; the very last frame is never dropped.
      while (has_next(next_) && due(next_ + 1) <= elapsed)
        ++next_;
      const double wait = due(next_) - elapsed;
      std::this_thread::sleep_for(std::chrono::duration<double>(std::clamp(wait, 0.0, std::max(timeout_s, 0.0))));
      if (wait > timeout_s) {
        out.frames.clear();
        return true;
      }
    }
    const std::uint64_t size = recording_.entries.size(), round = next_ / size;
    read_entry(recording_, next_ % size, out);
    if (round > 0) {
      const double shift = static_cast<double>(round) * round_s_;
      for (DepthFrame& frame : out.frames)
        frame.time_s += shift;
      out.time_s += shift;
      out.sequence += round * round_sequences_;
    }
    ++next_;
    return true;
  }

 private:
  bool ended() const { return !options_.loop && next_ >= recording_.entries.size(); }
  bool has_next(std::uint64_t frame) const { return options_.loop || frame + 1 < recording_.entries.size(); }
  /// Seconds after the first frame.
  double due(std::uint64_t frame) const {
    const std::uint64_t size = recording_.entries.size();
    const std::uint64_t round = frame / size;
    return recording_.entries[frame % size].time_s - recording_.entries.front().time_s +
           static_cast<double>(round) * round_s_;
  }

  Recording recording_;
  PlaybackOptions options_;
  double round_s_ = 0;
  std::uint64_t round_sequences_ = 1;
  std::uint64_t next_ = 0;
  bool started_ = false;
  Clock::time_point start_;
};

}  // namespace

std::unique_ptr<DepthSource> make_replay(Recording recording, PlaybackOptions options) {
  return std::make_unique<Replay>(std::move(recording), options);
}

}  // namespace palpa::sensing
