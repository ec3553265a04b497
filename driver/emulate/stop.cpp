#include "driver/emulate/stop.hpp"

#include <cstddef>
#include <iterator>

namespace palpa::driver::emulate {
namespace {

std::atomic<bool> flag{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler sets it");
constexpr int signals[] = {SIGINT, SIGTERM, SIGHUP, SIGPIPE};

}  // namespace

Stop::Stop() {
  flag = false;
  for (std::size_t i = 0; i < std::size(signals); ++i) {
    struct sigaction action {};
    action.sa_handler = signals[i] == SIGPIPE ? SIG_IGN : [](int) { flag = true; };
    sigaction(signals[i], &action, &before_[i]);
  }
}

Stop::~Stop() {
  for (std::size_t i = 0; i < std::size(signals); ++i)
    sigaction(signals[i], &before_[i], nullptr);
}

void Stop::ask() {
  flag = true;
}

const std::atomic<bool>& Stop::asked() {
  return flag;
}

}  // namespace palpa::driver::emulate
