#include "driver/guard/process.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <poll.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "base/error.hpp"
#include "base/system/descriptor.hpp"
#include "base/system/now.hpp"
#include "driver/guard/guard.hpp"

namespace palpa::driver {
namespace {

constexpr double exit_s = 1;  // how long a loop waits for its guard

Error not_started(const std::string& program, int fault) {
  return failure(fmt::format("{} does not start: {}", program, std::strerror(fault)));
}

struct Actions {
  Actions() { posix_spawn_file_actions_init(&value); }
  ~Actions() { posix_spawn_file_actions_destroy(&value); }
  Actions(const Actions&) = delete;
  Actions& operator=(const Actions&) = delete;
  posix_spawn_file_actions_t value;
};

struct Attributes {
  Attributes() { posix_spawnattr_init(&value); }
  ~Attributes() { posix_spawnattr_destroy(&value); }
  Attributes(const Attributes&) = delete;
  Attributes& operator=(const Attributes&) = delete;
  posix_spawnattr_t value;
};

/// The guard gets no signal until it has set which ones it ignores.
pid_t spawn(const std::string& program, int socket, int memory) {
  // Moves both away from the descriptors that they will get.
  const Descriptor socket_there(fcntl(socket, F_DUPFD_CLOEXEC, guard_memory + 1));
  const Descriptor memory_there(fcntl(memory, F_DUPFD_CLOEXEC, guard_memory + 1));
  Actions actions;
  posix_spawn_file_actions_addopen(&actions.value, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions.value, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&actions.value, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_adddup2(&actions.value, socket_there.get(), guard_socket);
  posix_spawn_file_actions_adddup2(&actions.value, memory_there.get(), guard_memory);
  Attributes attributes;
  sigset_t all;
  sigfillset(&all);
  posix_spawnattr_setsigmask(&attributes.value, &all);
  posix_spawnattr_setsigdefault(&attributes.value, &all);
  posix_spawnattr_setflags(&attributes.value, POSIX_SPAWN_SETSID | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
  std::string name = "palpa-guard";
  std::array<char*, 2> arguments{name.data(), nullptr};
  pid_t child = -1;
  const int fault = posix_spawn(&child, program.c_str(), &actions.value, &attributes.value, arguments.data(), environ);
  if (fault != 0) throw not_started(program, fault);
  return child;
}

bool ready(int fd, double at_most_s) {
  const double until_s = monotonic_s() + at_most_s;
  while (true) {
    pollfd one{fd, POLLIN, 0};
    const double left_s = std::max(until_s - monotonic_s(), 0.0);
    if (poll(&one, 1, static_cast<int>(1000 * left_s)) > 0) return true;
    if (monotonic_s() >= until_s) return false;
  }
}

/// The places of look_for_guard_at().
std::vector<std::string>& own_places() {
  static std::vector<std::string> places;
  return places;
}

}  // namespace

void look_for_guard_at(std::vector<std::string> places) {
  own_places() = std::move(places);
}

std::string guard_program() {
  std::vector<std::string> places = own_places();
  std::error_code fault;
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", fault).parent_path();
  if (!fault) {
    places.push_back((self / "palpa-guard").string());
    places.push_back((self / PALPA_LIBEXEC_FROM_BIN / "palpa-guard").lexically_normal().string());
  }
  for (const std::string& program : places) {
    if (access(program.c_str(), X_OK) == 0) return program;
  }
  throw failure(fmt::format("a board needs palpa-guard, which is not at {}: install all of palpa",
                            fmt::join(places, ", nor at ")));
}

GuardProcess::GuardProcess(const std::string& program, const Brief& brief, std::uint32_t most_cycle)
    : memory_(SharedMemory::make(to_bytes(brief), brief.board.layout.transducers.size(), most_cycle)) {
  std::array<int, 2> ends{};
  if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()) != 0) throw not_started(program, errno);
  socket_ = Descriptor(ends[0]);
  kept_socket_.emplace(ends[0]);
  const Descriptor other(ends[1]);
  child_ = spawn(program, other.get(), memory_.fd());
  child_handle_ = Descriptor(static_cast<int>(syscall(SYS_pidfd_open, child_, 0)));
}

GuardProcess::~GuardProcess() {
  hang_up();
  wake();  // a stopped guard would be left behind and hold its board
  wait_for_exit(exit_s);
}

void GuardProcess::hang_up() {
  shutdown(socket_.get(), SHUT_WR);
}

void GuardProcess::wake() const {
  syscall(SYS_pidfd_send_signal, child_handle_.get(), SIGCONT, nullptr, 0);
}

void GuardProcess::kill() const {
  syscall(SYS_pidfd_send_signal, child_handle_.get(), SIGKILL, nullptr, 0);
}

bool GuardProcess::wait_for_word(double at_most_s) const {
  return ready(socket_.get(), at_most_s);
}

GuardProcess::Exit GuardProcess::wait_for_exit(double at_most_s) {
  if (exit_.ended || !ready(child_handle_.get(), at_most_s)) return exit_;
  int status = 0;
  exit_.ended = true;
  if (waitpid(child_, &status, 0) != child_) return exit_;  // something else has waited for it
  if (WIFEXITED(status)) exit_.code = WEXITSTATUS(status);
  if (WIFSIGNALED(status)) exit_.by_signal = WTERMSIG(status);
  return exit_;
}

}  // namespace palpa::driver
