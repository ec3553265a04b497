#include "base/system/kept_from_forks.hpp"

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <optional>

namespace palpa {
namespace {

/// Whether the other end hears that this one is gone, while a process that fork() made lives on.
bool hangs_up_in_spite_of_a_fork(bool kept) {
  std::array<int, 2> ends{}, end_of_child{};
  EXPECT_EQ(socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()), 0);
  EXPECT_EQ(pipe(end_of_child.data()), 0);
  std::optional<KeptFromForks> own;
  if (kept) own.emplace(ends[0]);
  const pid_t child = fork();
  if (child == 0) {
    close(end_of_child[1]);
    char nothing = 0;
    static_cast<void>(!read(end_of_child[0], &nothing, 1));
    _exit(0);
  }
  own.reset();
  close(ends[0]);
  pollfd other{ends[1], POLLIN, 0};
  const bool heard = poll(&other, 1, kept ? 60'000 : 0) == 1 && (other.revents & POLLHUP) != 0;
  close(ends[1]);
  close(end_of_child[0]);
  close(end_of_child[1]);
  waitpid(child, nullptr, 0);
  return heard;
}

TEST(KeptFromForks, TheOtherEndHearsItAtOnce) {
  EXPECT_TRUE(hangs_up_in_spite_of_a_fork(true));
  EXPECT_FALSE(hangs_up_in_spite_of_a_fork(false)) << "otherwise this test shows nothing";
}

}  // namespace
}  // namespace palpa
