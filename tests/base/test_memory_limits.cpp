#include <gtest/gtest.h>
#include <sys/resource.h>

#include <filesystem>
#include <string>

#include "base/system/memory.hpp"
#include "base/system/memory_limits.hpp"
#include "support/files.hpp"
#include "support/shared_data.hpp"

namespace palpa {
namespace {

namespace fs = std::filesystem;

fs::path group(const fs::path& folder, const std::string& limit, const std::string& used, const std::string& stat,
               bool first_version = false) {
  fs::create_directories(folder);
  test::write_text(folder / (first_version ? "memory.limit_in_bytes" : "memory.max"), limit + "\n");
  test::write_text(folder / (first_version ? "memory.usage_in_bytes" : "memory.current"), used + "\n");
  test::write_text(folder / "memory.stat", stat);
  return folder;
}

TEST(MemoryLimits, TheTightestGroupAroundTheProcessCounts) {
  const fs::path root = test::scratch_folder("groups");
  group(root / "user/shell", "max", "5", "");
  group(root / "user", "1000", "700", "anon 300\nactive_file 150\ninactive_file 50\nshmem 9\n");
  EXPECT_EQ(group_memory_left("0::/user/shell\n", root), 500u);
  group(root / "user/shell", "400", "100", "");
  EXPECT_EQ(group_memory_left("0::/user/shell\n", root), 300u);
  group(root / "user/shell", "400", "500", "");
  EXPECT_EQ(group_memory_left("0::/user/shell\n", root), 0u);
  EXPECT_EQ(group_memory_left("0::/\n", root), no_limit);
}

TEST(MemoryLimits, OfTheFirstVersionOnlyTheMemoryControllerCounts) {
  const fs::path root = test::scratch_folder("groups-1");
  group(root / "memory/box", "1000", "700", "active_file 1\ntotal_active_file 100\ntotal_inactive_file 0\n", true);
  group(root / "memory", "9223372036854771712", "700", "", true);
  group(root / "cpu/box", "10", "7", "", true);
  EXPECT_EQ(group_memory_left("4:cpu,cpuacct:/box\n3:hugetlb,memory:/box\n1:name=systemd:/box\n", root), 400u);
}

// A container may see the host's path of its group, or its group at the place where all groups are on the host.
TEST(MemoryLimits, AGroupThatIsNotThereIsTheContainersOwn) {
  const fs::path root = test::scratch_folder("groups-2");
  group(root / "memory", "1000", "700", "", true);
  EXPECT_EQ(group_memory_left("3:memory:/docker/0123abc\n", root), 300u);
  EXPECT_EQ(group_memory_left("", root), no_limit);
  EXPECT_EQ(group_memory_left("nonsense\n\n::", root), no_limit);
}

TEST(MemoryLimits, AShellsLimitOfAddressesCounts) {
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_AS, &before), 0);
  if (before.rlim_cur != RLIM_INFINITY) GTEST_SKIP() << "this shell has a limit already";
#if defined(PALPA_ADDRESS_SANITIZER) || defined(PALPA_THREAD_SANITIZER)
  GTEST_SKIP() << "sanitizers reserve more addresses than any limit";
#endif
  constexpr std::uint64_t limit = std::uint64_t{64} << 30;
  rlimit now = before;
  now.rlim_cur = limit;
  ASSERT_EQ(setrlimit(RLIMIT_AS, &now), 0);
  const std::uint64_t left = addresses_left(), free = free_memory();
  setrlimit(RLIMIT_AS, &before);
  EXPECT_LT(left, limit);
  EXPECT_GT(left, limit / 2);
  EXPECT_LE(free, left);
}

}  // namespace
}  // namespace palpa
