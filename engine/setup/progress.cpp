#include "setup/progress.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <utility>

#include "base/log.hpp"

namespace palpa::setup {

Progress::Progress(std::string what, std::uint64_t total, bool quiet)
    : what_(std::move(what)), total_(total), on_(!quiet && isatty(STDERR_FILENO) != 0) {}

Progress::~Progress() {
  // Carriage return, then erase to the end of the line.
  if (drawn_) log::draw("\r\x1b[K");
}

void Progress::set(std::uint64_t done) {
  if (!on_ || tcgetpgrp(STDERR_FILENO) != getpgrp()) return;
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

}  // namespace palpa::setup
