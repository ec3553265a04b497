#include "cli/interrupt.hpp"

#include <array>
#include <atomic>
#include <csignal>

namespace palpa::cli {
namespace {

std::atomic<bool> interrupted{false};
static_assert(std::atomic<bool>::is_always_lock_free);

constexpr std::array<int, 3> watched{SIGINT, SIGTERM, SIGHUP};

}  // namespace

Interrupt::Interrupt() {
  interrupted = false;
  struct sigaction action {};
  action.sa_handler = [](int) { interrupted = true; };
  sigemptyset(&action.sa_mask);
  action.sa_flags = SA_RESTART | static_cast<int>(SA_RESETHAND);
  for (const int signal : watched)
    sigaction(signal, &action, nullptr);
}

Interrupt::~Interrupt() {
  for (const int signal : watched)
    std::signal(signal, SIG_DFL);
}

bool Interrupt::requested() const {
  return interrupted;
}

}  // namespace palpa::cli
