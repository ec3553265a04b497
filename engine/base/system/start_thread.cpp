#include "base/system/start_thread.hpp"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstdint>
#include <fstream>
#include <string>

namespace palpa {
namespace {

constexpr double mebibyte = 1 << 20;

/// The limit, or nothing if there is none.
rlim_t limit_of(__rlimit_resource_t what) {
  rlimit limit{};
  return ::getrlimit(what, &limit) == 0 ? limit.rlim_cur : RLIM_INFINITY;
}

/// Whether the address space lacks room for another stack.
bool stack_fits_not(rlim_t most) {
  std::uint64_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  const rlim_t stack = limit_of(RLIMIT_STACK);
  const double room = stack == RLIM_INFINITY ? 8 * mebibyte : static_cast<double>(stack);
  const double used = static_cast<double>(pages) * static_cast<double>(::sysconf(_SC_PAGESIZE));
  return used + room > static_cast<double>(most);
}

std::string missing() {
  const rlim_t memory = limit_of(RLIMIT_AS), processes = limit_of(RLIMIT_NPROC);
  if (memory != RLIM_INFINITY && stack_fits_not(memory)) {
    return fmt::format("the memory limit of {:.0f} MiB (ulimit -v) leaves no room for its stack; raise it",
                       static_cast<double>(memory) / mebibyte);
  }
  if (processes != RLIM_INFINITY) {
    return fmt::format(
        "memory is short, or the limit of {} threads (ulimit -u) or that of the container is reached; raise it, or end "
        "other programs",
        processes);
  }
  return "memory is short, or the machine or its container has reached its limit of threads; end other programs";
}

}  // namespace

Error no_thread(const char* purpose, const std::system_error& fault) {
  return failure(fmt::format("no thread for {}: {}: {}", purpose, fault.code().message(), missing()));
}

bool is_no_thread(const std::system_error& fault) {
  return fault.code() == std::errc::resource_unavailable_try_again;
}

}  // namespace palpa
