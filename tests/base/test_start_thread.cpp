// When the system gives no threads: one line says what is missing, and parts that can do without threads continue.
#include "base/system/start_thread.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <functional>
#include <string>

#include "base/system/parallel.hpp"
#include "support/instrumented.hpp"
#include "support/thrown.hpp"

namespace palpa {
namespace {

/// Leaves no room in this process for another thread's stack: no more memory, and all cached stacks are in use.
void use_up_threads() {
  std::uint64_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  const auto size = pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
  const rlimit limit{size + (1U << 20U), size + (1U << 20U)};
  ASSERT_EQ(setrlimit(RLIMIT_AS, &limit), 0);
  for (int i = 0; i < 100; ++i) {
    std::thread waits = try_thread([] { pause(); });
    if (!waits.joinable()) return;
    waits.detach();
  }
}

/// Whether `holds` is true of a process that gets no more threads.
bool without_threads(const std::function<bool()>& holds) {
  const pid_t child = fork();
  if (child == 0) {
    use_up_threads();
    _exit(holds() ? 0 : 1);
  }
  int status = 0;
  return waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

TEST(StartThread, RunsTheWork) {
  int done = 0;
  start_thread("a test", [&] { done = 1; }).join();
  EXPECT_EQ(done, 1);
}

TEST(StartThread, SaysWhatIsMissing) {
  if (test::instrumented()) GTEST_SKIP() << "skipped: sanitizers need memory of their own";
  EXPECT_TRUE(without_threads([] {
    const Error error = test::thrown_by([] { start_thread("the source", [] {}).join(); });
    const std::string line = error.what();
    const bool told = error.code() == Exit::failed && line.starts_with("no thread for the source: ") &&
                      line.find("the memory limit of ") != std::string::npos &&
                      line.find("(ulimit -v)") != std::string::npos;
    if (!told) std::fprintf(stderr, "%s\n", line.c_str());
    return told;
  }));
}

TEST(StartThread, WorkThatIsSharedOutIsDoneByFewer) {
  if (test::instrumented()) GTEST_SKIP() << "skipped: sanitizers need memory of their own";
  EXPECT_TRUE(without_threads([] {
    std::atomic<std::size_t> done{0};
    parallel_chunks(1000, 10, [&](std::size_t, std::size_t begin, std::size_t end) { done += end - begin; });
    return done == 1000;
  }));
}

}  // namespace
}  // namespace palpa
