// What the rigs of boards share.
#pragma once

#include <functional>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "driver/board.hpp"
#include "support/begins.hpp"

namespace palpa::test {

class KeptNotes : public driver::BoardNotes {
 public:
  void warning(std::string_view line) noexcept override { warnings.emplace_back(line); }
  void info(std::string_view line) noexcept override { infos.emplace_back(line); }
  void waits(std::string_view line) noexcept override { waits_for.emplace_back(line); }
  std::vector<std::string> warnings, infos, waits_for;
};

/// A rig whose board or link is open.
template <typename Rig>
struct Opened : Rig {
  Opened() { Rig::open(); }
};

/// Waits like begins(). The lock is held while it is asked.
inline bool becomes(std::mutex& lock, const std::function<bool()>& wanted) {
  return begins([&] {
    const std::lock_guard held(lock);
    return wanted();
  });
}

}  // namespace palpa::test
