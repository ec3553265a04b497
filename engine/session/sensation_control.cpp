#include "session/sensation_control.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"

namespace palpa::session {

void SensationControl::play(double from_s, double in_s) {
  for (const double time_s : {from_s, in_s}) {
    if (!(std::abs(time_s) <= most_start_s))
      throw bad_usage(fmt::format("a sensation starts at a time of at most {:g} s, not {:g}", most_start_s, time_s));
  }
  const std::lock_guard lock(mutex_);
  now_ = {true, now_.follows, from_s, in_s, now_.number + 1};
  newest_.clear();
}

void SensationControl::pause() {
  const std::lock_guard lock(mutex_);
  now_.plays = false;
  ++now_.number;
}

void SensationControl::follow(bool follows) {
  const std::lock_guard lock(mutex_);
  now_.follows = follows;
}

std::vector<sensation::Point> SensationControl::newest(std::size_t most) const {
  const std::lock_guard lock(mutex_);
  const std::size_t count = std::min(most, newest_.size());
  return {newest_.end() - static_cast<std::ptrdiff_t>(count), newest_.end()};
}

SensationControl::State SensationControl::now() const {
  const std::lock_guard lock(mutex_);
  return now_;
}

void SensationControl::ended(std::uint64_t number) {
  const std::lock_guard lock(mutex_);
  if (now_.number == number) now_.plays = false;
}

void SensationControl::sounded(const sensation::Point& point) {
  constexpr std::size_t most_kept = 1024;
  const std::lock_guard lock(mutex_);
  newest_.push_back(point);
  if (newest_.size() > most_kept) newest_.pop_front();
}

}  // namespace palpa::session
