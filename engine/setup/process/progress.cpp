#include "setup/process/progress.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <utility>

#include "base/activity.hpp"
#include "base/log.hpp"
#include "base/system/start_thread.hpp"
#include "base/text.hpp"

namespace palpa::setup {
namespace {

/// The text for a line of a terminal.
std::string shown(const Doing& doing) {
  constexpr std::size_t width = 70;
  const std::string what = shortened(printable(doing.what), width);
  return doing.total == 0 ? what : fmt::format("{} {} %", what, doing.done * 100 / doing.total);
}

}  // namespace

bool is_in_foreground() {
  return tcgetpgrp(STDERR_FILENO) == getpgrp();
}

Progress::Progress(std::string what, std::uint64_t total, bool quiet)
    : what_(std::move(what)), total_(total), on_(!quiet && isatty(STDERR_FILENO) != 0) {}

Progress::~Progress() {
  // Carriage return, then erase to the end of the line.
  if (drawn_) log::draw("\r\x1b[K");
}

void Progress::set(std::uint64_t done) {
  if (!on_ || !is_in_foreground()) return;
  const auto now = std::chrono::steady_clock::now();
  if (now < next_) return;
  next_ = now + std::chrono::milliseconds(100);
  draw(done);
}

void Progress::draw(std::uint64_t done) {
  constexpr std::uint64_t width = 30;
  drawn_ = true;
  if (total_ == 0) {
    log::draw(fmt::format("\r{} {}\x1b[K", what_, done));
  } else {
    const std::uint64_t filled = std::min(width, done * width / total_);
    log::draw(fmt::format("\r{} [{:#<{}}{:.<{}}] {}/{}\x1b[K", what_, "", filled, "", width - filled, done, total_));
  }
}

Preparing::Preparing(bool quiet) : terminal_(isatty(STDERR_FILENO) != 0) {
  if (quiet || (!terminal_ && log::level() < log::Level::info)) return;
  thread_ = try_thread([this] { watch(); });  // the work continues without being shown
}

Preparing::~Preparing() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  end_.notify_one();
  thread_.join();
}

void Preparing::watch() {
  constexpr std::chrono::milliseconds moment(100);
  std::string last;
  bool drawn = false;
  std::unique_lock lock(mutex_);
  while (!end_.wait_for(lock, moment, [this] { return ending_; })) {
    const std::optional<Doing> now = doing();
    if (!now) continue;
    if (!terminal_) {
      if (now->what != last) log::info(now->what);
      last = now->what;
    } else if (is_in_foreground()) {
      drawn = true;
      log::draw(fmt::format("\r{}\x1b[K", shown(*now)));
    }
  }
  // Carriage return, then erase to the end of the line.
  if (drawn && is_in_foreground()) log::draw("\r\x1b[K");
}

}  // namespace palpa::setup
