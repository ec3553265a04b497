#include "viewer/live/frame_gaps.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace palpa::viewer {
namespace {

constexpr double longest_s = 0.25;  ///< a frame that takes longer, or is farther from the next, is no rhythm

double mean(double before, double now) {
  constexpr double weight = 1.0 / 8;
  return before > 0 ? before + weight * (now - before) : now;
}

}  // namespace

void Rhythm::arrived(std::uint64_t sequence, double now_s) {
  if (last_s_) {
    const double after_s = now_s - *last_s_;
    // A single skipped frame says nothing about the rate; several in a row do.
    gaps_ = every_s_ > 0 && after_s > 1.5 * every_s_ ? gaps_ + 1 : 0;
    if (after_s > longest_s)
      every_s_ = 0;
    else if (gaps_ == 0 || gaps_ > 3)
      every_s_ = mean(gaps_ ? 0 : every_s_, after_s);
  }
  // Anything that holds up a source makes its frames late, never early.
  const double late_s = now_s - due_s_;
  due_s_ = std::abs(late_s) < 0.5 * every_s_ ? due_s_ + (late_s > 0 ? 0.05 : 0.5) * late_s : now_s;
  due_s_ += every_s_;
  if (!under_way_) begun_s_ = now_s;
  last_s_ = now_s;
  newest_ = sequence;
  under_way_ = true;
}

void Rhythm::planned(std::uint64_t sequence, double now_s) {
  begun_s_ = now_s;  // for the next frame, if that has come
  if (!last_s_ || sequence != newest_) return;
  takes_s_ = mean(takes_s_, now_s - *last_s_);
  under_way_ = false;
}

std::optional<double> Rhythm::wait_until(double now_s, double work_s) const {
  if (under_way_) return now_s < begun_s_ + longest_s ? std::optional(begun_s_ + longest_s) : std::nullopt;
  if (every_s_ == 0) return std::nullopt;
  const double between_s = std::max(every_s_ - takes_s_, 0.0);
  if (now_s + std::min(work_s, 0.75 * between_s) <= due_s_) return std::nullopt;
  const double late_s = due_s_ + 0.25 * every_s_;
  return now_s < late_s ? std::optional(late_s) : std::nullopt;
}

void FrameGaps::arrived(std::uint64_t sequence) {
  const std::lock_guard lock(mutex_);
  rhythm_.arrived(sequence, clock_.now());
}

void FrameGaps::planned(std::uint64_t sequence) {
  {
    const std::lock_guard lock(mutex_);
    rhythm_.planned(sequence, clock_.now());
  }
  news_.notify_all();
}

void FrameGaps::over() {
  {
    const std::lock_guard lock(mutex_);
    rhythm_ = {};
  }
  news_.notify_all();
}

double FrameGaps::wait(double work_s, double most_s) {
  std::unique_lock lock(mutex_);
  const double begin_s = clock_.now();
  for (;;) {
    const double now_s = clock_.now();
    const std::optional<double> until_s = rhythm_.wait_until(now_s, work_s);
    if (!until_s || now_s >= begin_s + most_s) return now_s - begin_s;
    news_.wait_for(lock, std::chrono::duration<double>(std::min(*until_s, begin_s + most_s) - now_s));
  }
}

void PictureSteps::begin() {
  next_ = 0;
  waited_s_ = 0;
}

void PictureSteps::ends() {
  if (next_ > 0) take_s_[next_ - 1] = mean(take_s_[next_ - 1], clock_.now() - begun_s_);
}

double PictureSteps::end() {
  ends();
  return waited_s_;
}

void PictureSteps::pause() {
  ends();
  if (next_ == take_s_.size()) take_s_.push_back(0);
  // Some pieces take longer than usual. A piece that took very long once, e.g. because a driver compiled, will hardly
  // do so again.
  const double work_s = std::min(1.25 * take_s_[next_] + 2e-3, 12e-3);
  if (waited_s_ < most_s) waited_s_ += let_run_(work_s, most_s - waited_s_);
  begun_s_ = clock_.now();
  ++next_;
}

}  // namespace palpa::viewer
