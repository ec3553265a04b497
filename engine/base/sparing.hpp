// Which of many warnings to write, so that a person hears of each fault and a flood fills no log.
#pragma once

#include <chrono>
#include <cstddef>
#include <set>
#include <string>

namespace palpa {

/// For one thread.
class Sparing {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr int most_in_second = 3;
  static constexpr std::size_t most_in_all = 100;

  /// Whether to write this text: each once. One that comes too soon after others is written if it comes again.
  bool writes(const std::string& text, Clock::time_point now = Clock::now());

 private:
  std::set<std::string> written_;
  Clock::time_point second_{};  ///< its begin
  int in_second_ = 0;
};

}  // namespace palpa
