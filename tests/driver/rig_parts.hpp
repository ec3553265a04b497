// What the rigs of boards share.
#pragma once

#include <chrono>
#include <functional>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "driver/board.hpp"

namespace palpa::test {

class KeptNotes final : public driver::BoardNotes {
 public:
  void warning(std::string_view line) noexcept override { warnings.emplace_back(line); }
  void info(std::string_view line) noexcept override { infos.emplace_back(line); }
  std::vector<std::string> warnings, infos;
};

/// Whether this becomes true within a minute. The lock is held while it is asked.
inline bool becomes(std::mutex& lock, const std::function<bool()>& wanted) {
  for (int i = 0; i < 60000; ++i, std::this_thread::sleep_for(std::chrono::milliseconds(1))) {
    const std::lock_guard held(lock);
    if (wanted()) return true;
  }
  return false;
}

}  // namespace palpa::test
