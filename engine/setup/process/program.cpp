#include "setup/process/program.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <exception>
#include <memory>
#include <new>
#include <system_error>

#include "base/error.hpp"
#include "base/files/outputs.hpp"
#include "base/log.hpp"
#include "base/system/real_time.hpp"
#include "base/system/start_thread.hpp"
#include "base/text.hpp"
#include "gpu/device.hpp"
#include "gpu/handle.hpp"
#include "setup/process/ending.hpp"

namespace palpa::setup {
namespace {

/// A file opened later must not get a descriptor that the shell left closed, because printed text would go into that
/// file. A closed stdout is replaced by one that cannot be written, so that printing to it still fails.
void guard_standard_streams() {
  for (const int fd : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(fd, F_GETFD) == -1 && open("/dev/null", fd == STDERR_FILENO ? O_WRONLY : O_RDONLY) == -1) return;
  }
}

/// A pipe that nobody reads and a file that may not grow are errors of the writing code and must not end the program.
/// If the parent process ignores these signals, they stay ignored. Otherwise, they get a handler, so that
/// setup::Interrupt can distinguish the two sources. Sent by another process, they end the program as usual: a loop
/// that is still opening its board must not continue and sound.
void survive_signals_of_writes() {
  for (const int signal : {SIGPIPE, SIGXFSZ}) {
    struct sigaction action {};
    if (sigaction(signal, nullptr, &action) != 0 || action.sa_handler == SIG_IGN) continue;
    action = {};
    action.sa_sigaction = [](int number, siginfo_t* from, void*) {
      if (from->si_pid == getpid()) return;
      std::signal(number, SIG_DFL);
      raise(number);
    };
    action.sa_flags = SA_RESTART | SA_SIGINFO;
    sigaction(signal, &action, nullptr);
  }
}

/// If the watch for signals has already reported that the program ended too late, this line is not printed.
Exit report(Exit code, const std::string& line) {
  log::drop_warnings();
  if (decide_ending(code)) tell_ending(line);
  return ending();
}

}  // namespace

int run_program(const std::function<void()>& body) {
  begin_ending();
  allow_lower_limit();
  guard_standard_streams();
  const std::shared_ptr<void> all_files = keep_register();
  survive_signals_of_writes();
  Exit code = Exit::ok;
  try {
    body();
    if (const std::uint64_t errors = gpu::validation_errors()) {
      throw failure("Vulkan validation reported " + counted(errors, "error"));
    }
    log::release_warnings();
    decide_good_ending();
    code = ending();
  } catch (const Error& error) {
    code = report(error.code(), error.what());
  } catch (const std::system_error& error) {  // from a thread that a library starts
    code = report(Exit::failed, is_no_thread(error) ? no_thread("a library", error).what() : error.what());
  } catch (const std::bad_alloc&) {
    code = report(Exit::failed, "out of memory");
    // The error may have passed through a driver or a library that now holds a lock forever. Its shutdown would wait
    // for that lock.
    gpu::device_abandoned = true;
  } catch (const std::exception& error) {
    code = report(Exit::failed, error.what());
  } catch (...) {
    code = report(Exit::failed, "an unknown exception");
  }
  if (gpu::device_abandoned) std::_Exit(static_cast<int>(code));
  return static_cast<int>(code);
}

}  // namespace palpa::setup
