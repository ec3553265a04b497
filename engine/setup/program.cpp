#include "setup/program.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <exception>
#include <new>

#include "base/error.hpp"
#include "base/log.hpp"
#include "base/text.hpp"
#include "gpu/device.hpp"
#include "gpu/handle.hpp"

namespace palpa::setup {
namespace {

/// A file opened later must not land on a descriptor that the shell left closed: what is printed would go into it. A
/// closed stdout becomes one that cannot be written, so that printing to it still fails.
void guard_standard_streams() {
  for (const int fd : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(fd, F_GETFD) == -1 && open("/dev/null", fd == STDERR_FILENO ? O_WRONLY : O_RDONLY) == -1) return;
  }
}

Exit report(Exit code, const std::string& line) {
  log::drop_warnings();
  log::error(one_line(line));
  return code;
}

}  // namespace

int run_program(const std::function<void()>& body) {
  guard_standard_streams();
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
  Exit code = Exit::ok;
  try {
    body();
    if (const std::uint64_t errors = gpu::validation_errors()) {
      throw failure(fmt::format("Vulkan validation reported {} error{}", errors, errors == 1 ? "" : "s"));
    }
    log::release_warnings();
  } catch (const Error& error) {
    code = report(error.code(), error.what());
  } catch (const std::bad_alloc&) {
    code = report(Exit::failed, "out of memory");
  } catch (const std::exception& error) {
    code = report(Exit::failed, error.what());
  } catch (...) {
    code = report(Exit::failed, "an unknown exception");
  }
  if (gpu::device_abandoned) std::_Exit(static_cast<int>(code));
  return static_cast<int>(code);
}

}  // namespace palpa::setup
