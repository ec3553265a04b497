#include "viewer/study/touch_frames.hpp"

#include <algorithm>

namespace palpa::viewer {
namespace {

/// Between two frames; a source that counts in another way makes no more.
constexpr std::uint64_t most_missing = 1000;

}  // namespace

void TouchFrames::begin(double hold_s) {
  const std::lock_guard lock(mutex_);
  touching_ = true;
  hold_s_ = hold_s;
  waiting_.clear();
  counts_ = {};
}

void TouchFrames::end() {
  const std::lock_guard lock(mutex_);
  if (!touching_) return;
  touching_ = false;
  // No later frame is going to be seen.
  for (Frame& frame : waiting_) {
    if (!frame.over_object) frame.over_object = seen_ && seen_->counts;
  }
  judge(clock_->now());
  waiting_.clear();
}

FrameCounts TouchFrames::counts() const {
  const std::lock_guard lock(mutex_);
  return counts_;
}

void TouchFrames::arrived(std::uint64_t sequence) {
  const std::lock_guard lock(mutex_);
  const std::uint64_t last = last_.value_or(sequence);
  last_ = sequence;
  if (sequence > last) apart_ = std::min(apart_.value_or(sequence - last), sequence - last);
  if (sequence < last) apart_.reset();  // another source, or one that was opened again
  if (!touching_) return;
  const double now_s = clock_->now();
  judge(now_s);
  const std::uint64_t missing = sequence > last ? std::min((sequence - last) / *apart_ - 1, most_missing) : 0;
  for (std::uint64_t i = 1; i <= missing; ++i)
    waiting_.push_back({.sequence = last + i * *apart_, .arrived_s = now_s});
  waiting_.push_back({.sequence = sequence, .arrived_s = now_s});
}

void TouchFrames::planned(const session::FrameReport& report, const session::Plan& plan) {
  const std::lock_guard lock(mutex_);
  const auto frame = std::ranges::find(waiting_, report.sequence, &Frame::sequence);
  if (frame == waiting_.end()) return;
  frame->time_s = plan.schedule.time_s;
  frame->thinned = !report.effort.whole();
  frame->outdated = report.outdated;
  frame->fingers = plan.schedule.voice_count > 0;
}

void TouchFrames::passed(double time_s, bool sounds, bool reached) {
  const std::lock_guard lock(mutex_);
  const auto frame =
      std::find_if(waiting_.rbegin(), waiting_.rend(), [&](const Frame& one) { return one.time_s == time_s; });
  if (frame == waiting_.rend()) return;
  frame->passed = true;
  frame->sounded = frame->sounded || sounds;
  frame->reached = frame->reached || (sounds && reached);
}

void TouchFrames::seen(std::uint64_t sequence, bool over, bool deep) {
  const std::lock_guard lock(mutex_);
  const bool counts = over && !deep, before = seen_ ? seen_->counts : counts;
  for (Frame& frame : waiting_) {
    if (!frame.over_object && frame.sequence <= sequence)
      frame.over_object = frame.sequence == sequence ? counts : counts && before;
  }
  seen_ = {sequence, counts};
}

void TouchFrames::add(const Frame& frame, FrameCounts& counts) {
  if (!frame.over_object.value_or(false)) return;
  ++counts.skin;
  if (!frame.time_s) {
    ++counts.left_out;
  } else if (frame.outdated) {
    ++counts.outdated;
  } else if (frame.fingers && (!frame.passed || (frame.sounded && !frame.reached))) {
    ++counts.left_out;
  } else if (frame.thinned) {
    ++counts.thinned;
  }
}

/// With the mutex held.
void TouchFrames::judge(double now_s) {
  while (!waiting_.empty() && now_s - waiting_.front().arrived_s >= hold_s_ && waiting_.front().over_object) {
    add(waiting_.front(), counts_);
    waiting_.pop_front();
  }
}

}  // namespace palpa::viewer
