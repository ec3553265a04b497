#include "session/loop/frame_queue.hpp"

#include <cstdint>
#include <utility>

namespace palpa::session {
namespace {

/// At least 1, so that no queue is endless.
std::uint64_t bytes_of(const sensing::FrameSet& set) {
  std::uint64_t bytes = 1;
  for (const sensing::DepthFrame& frame : set.frames)
    bytes += frame.depth.size() * sizeof(std::uint16_t);
  return bytes;
}

/// Empties are kept up to this number.
constexpr std::size_t most_spare = 4;

}  // namespace

bool FrameQueue::add(const sensing::FrameSet& set) {
  sensing::FrameSet copy;
  {
    const std::lock_guard lock(mutex_);
    if (!spare_.empty()) {
      copy = std::move(spare_.back());
      spare_.pop_back();
    }
  }
  copy = set;  // a large copy, so without the lock
  const std::uint64_t bytes = bytes_of(copy);
  bool replaced = false;
  {
    const std::lock_guard lock(mutex_);
    replaced = !frames_.empty() && bytes_ + bytes > most_bytes_;
    if (replaced) {
      bytes_ -= bytes_of(frames_.back());
      std::swap(frames_.back(), copy);
      if (spare_.size() < most_spare) spare_.push_back(std::move(copy));
    } else {
      frames_.push_back(std::move(copy));
    }
    bytes_ += bytes;
  }
  clock_.wake(arrived_);
  return replaced;
}

void FrameQueue::close() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  clock_.wake(arrived_);
  clock_.wake(emptied_);
}

bool FrameQueue::take(sensing::FrameSet& out, std::chrono::duration<double> timeout) {
  std::unique_lock lock(mutex_);
  clock_.wait(arrived_, lock, timeout.count(), [this] { return !frames_.empty() || closed_; });
  if (frames_.empty()) return false;
  bytes_ -= bytes_of(frames_.front());
  std::swap(out, frames_.front());
  if (spare_.size() < most_spare) spare_.push_back(std::move(frames_.front()));
  frames_.pop_front();
  const bool emptied = frames_.empty();
  lock.unlock();
  if (emptied) clock_.wake(emptied_);
  return true;
}

bool FrameQueue::wait_empty(std::chrono::duration<double> timeout) {
  std::unique_lock lock(mutex_);
  return clock_.wait(emptied_, lock, timeout.count(), [this] { return frames_.empty() || closed_; });
}

bool FrameQueue::closed() {
  const std::lock_guard lock(mutex_);
  return closed_;
}

bool FrameQueue::over() {
  const std::lock_guard lock(mutex_);
  return closed_ && frames_.empty();
}

std::size_t FrameQueue::waiting() {
  const std::lock_guard lock(mutex_);
  return frames_.size();
}

std::size_t FrameQueue::discard() {
  const std::lock_guard lock(mutex_);
  const std::size_t count = frames_.size();
  frames_.clear();
  bytes_ = 0;
  return count;
}

}  // namespace palpa::session
