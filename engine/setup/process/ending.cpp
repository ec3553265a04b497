#include "setup/process/ending.hpp"

#include <atomic>

namespace palpa::setup {
namespace {

constexpr int undecided = -1;
std::atomic<int> decided{undecided};

}  // namespace

void begin_ending() {
  decided = undecided;
}

bool decide_ending(Exit code) {
  int expected = undecided;
  return decided.compare_exchange_strong(expected, static_cast<int>(code));
}

Exit ending() {
  const int code = decided;
  return code == undecided ? Exit::ok : static_cast<Exit>(code);
}

}  // namespace palpa::setup
