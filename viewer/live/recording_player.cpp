#include "viewer/live/recording_player.hpp"

#include <algorithm>
#include <chrono>
#include <string>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "sensing/recording.hpp"

namespace palpa::viewer {

class PlayerSource final : public sensing::DepthSource {
 public:
  PlayerSource(sensing::Recording recording, RecordingPlayer& hand) : recording_(std::move(recording)), hand_(&hand) {
    const std::lock_guard lock(hand_->mutex_);
    Playback play = hand_->now_.value_or(Playback{});
    play.frame = 0;
    play.frames = recording_.entries.size();
    play.time_s = 0;
    play.length_s = seconds(recording_.entries.size() - 1);
    play.playing = true;
    hand_->now_ = play;
    hand_->go_to_ = 0;
  }
  ~PlayerSource() override {
    const std::lock_guard lock(hand_->mutex_);
    hand_->now_.reset();
  }
  PlayerSource(const PlayerSource&) = delete;
  PlayerSource& operator=(const PlayerSource&) = delete;

  const std::vector<sensing::Camera>& cameras() const override { return recording_.cameras; }

  bool next(sensing::FrameSet& out, double timeout_s) override {
    const Clock::time_point until = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                                       std::chrono::duration<double>(std::max(timeout_s, 0.0)));
    std::uint64_t frame = 0;
    {
      std::unique_lock lock(hand_->mutex_);
      const std::optional<std::uint64_t> next = wait_for_frame(lock, until);
      if (!next) {
        out.frames.clear();
        return true;
      }
      frame = *next;
      Playback& play = *hand_->now_;
      if (frame >= play.frames) return false;
      play.frame = frame;
      play.time_s = seconds(frame);
    }
    sensing::read_entry(recording_, frame, out);
    stamp(out);
    return true;
  }

 private:
  using Clock = std::chrono::steady_clock;

  double seconds(std::uint64_t frame) const {
    return recording_.entries[frame].time_s - recording_.entries.front().time_s;
  }

  /// nullopt if no frame is due until then; `frames` at the end.
  std::optional<std::uint64_t> wait_for_frame(std::unique_lock<std::mutex>& lock, Clock::time_point until) {
    for (;;) {
      const Playback play = *hand_->now_;
      if (const std::optional<std::uint64_t> asked = std::exchange(hand_->go_to_, std::nullopt)) {
        shown_ = Clock::now();
        return std::min(*asked, play.frames - 1);
      }
      if (play.playing) {
        const std::uint64_t following = play.frame + 1;
        if (following >= play.frames && !play.loop) return play.frames;
        const double usual = 1.0 / 90;
        const double apart = following < play.frames ? seconds(following) - seconds(play.frame) : usual;
        const auto due = shown_ + std::chrono::duration_cast<Clock::duration>(
                                      std::chrono::duration<double>(apart / std::max(play.speed, 1e-3)));
        if (Clock::now() >= due) {
          // A late frame does not shorten the time to the next one.
          shown_ = Clock::now() - due > std::chrono::milliseconds(50) ? Clock::now() : due;
          return following < play.frames ? following : 0;
        }
        if (due < until) {
          hand_->changed_.wait_until(lock, due);
          continue;
        }
      }
      if (hand_->changed_.wait_until(lock, until) == std::cv_status::timeout) return std::nullopt;
    }
  }

  /// Sets times as they pass here, and numbers in the order of showing.
  void stamp(sensing::FrameSet& out) {
    const double now_s = std::chrono::duration<double>(Clock::now() - begin_).count();
    const double shift = now_s - out.time_s;
    for (sensing::DepthFrame& frame : out.frames)
      frame.time_s += shift;
    out.time_s = now_s;
    out.sequence = number_++;
  }

  sensing::Recording recording_;
  RecordingPlayer* hand_;
  Clock::time_point begin_ = Clock::now(), shown_ = Clock::now();
  std::uint64_t number_ = 0;
};

std::optional<Playback> RecordingPlayer::now() const {
  const std::lock_guard lock(mutex_);
  return now_;
}

void RecordingPlayer::play(const Playback& wanted) {
  const std::lock_guard lock(mutex_);
  if (!now_) return;
  now_->playing = wanted.playing;
  now_->speed = wanted.speed;
  now_->loop = wanted.loop;
  changed_.notify_all();
}

void RecordingPlayer::go_to(std::uint64_t frame) {
  const std::lock_guard lock(mutex_);
  if (!now_) return;
  go_to_ = frame;
  changed_.notify_all();
}

void RecordingPlayer::step(int frames) {
  const std::lock_guard lock(mutex_);
  if (!now_) return;
  now_->playing = false;
  const std::int64_t to = static_cast<std::int64_t>(go_to_.value_or(now_->frame)) + frames;
  go_to_ = static_cast<std::uint64_t>(std::clamp<std::int64_t>(to, 0, static_cast<std::int64_t>(now_->frames) - 1));
  changed_.notify_all();
}

session::SourceKind RecordingPlayer::source() {
  return {"recording", "recording:DIR: what palpa run --record wrote, or a folder with a recording.toml",
          [this](const std::string& folder,
                 const session::SourceSetting& setting) -> std::unique_ptr<sensing::DepthSource> {
            if (folder.empty()) throw bad_usage("source recording needs a folder: recording:DIR");
            sensing::Recording recording = sensing::load_recording(folder);
            if (!setting.paced) return sensing::make_replay(std::move(recording), {.paced = false});
            return std::make_unique<PlayerSource>(std::move(recording), *this);
          }};
}

}  // namespace palpa::viewer
