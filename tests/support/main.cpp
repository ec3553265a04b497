// main() of every test program: fails on any validation error, and on a missing barrier between dispatches.
// --of=FILE[,FILE...] runs only the tests of these sources.
#include <dlfcn.h>
#include <fnmatch.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

#include "gpu/device.hpp"
#include "support/barriers.hpp"

namespace {

// The loader unloads lavapipe at teardown. Leak reports would then name an unknown module that no suppression can
// match.
[[maybe_unused]] void* const keep_driver = dlopen("libvulkan_lvp.so", RTLD_LAZY | RTLD_NODELETE);

bool ends_with(std::string_view path, std::string_view file) {
  return path.size() > file.size() && path.ends_with(file) && path[path.size() - file.size() - 1] == '/';
}

/// Patterns as in --gtest_filter, separated by colons.
bool matches(std::string_view patterns, const std::string& name) {
  for (bool more = true; more;) {
    const std::size_t colon = patterns.find(':');
    if (fnmatch(std::string(patterns.substr(0, colon)).c_str(), name.c_str(), 0) == 0) return true;
    more = colon != std::string_view::npos;
    patterns.remove_prefix(more ? colon + 1 : 0);
  }
  return false;
}

/// Whether each of these has tests. Tests that a filter leaves out stay out.
bool keep_tests_of(std::string_view files) {
  const std::string before = GTEST_FLAG_GET(filter);
  const std::size_t left_out = std::min(before.find('-'), before.size());
  const std::string wanted = left_out > 0 ? before.substr(0, left_out) : "*";
  std::string kept;
  for (bool more = true; more;) {
    const std::size_t comma = files.find(',');
    const std::string_view file = files.substr(0, comma);
    bool any = false;
    const testing::UnitTest& all = *testing::UnitTest::GetInstance();
    for (int i = 0; i < all.total_test_suite_count(); ++i) {
      const testing::TestSuite& suite = *all.GetTestSuite(i);
      for (int j = 0; j < suite.total_test_count(); ++j) {
        const testing::TestInfo& test = *suite.GetTestInfo(j);
        if (!ends_with(test.file(), file)) continue;
        any = true;
        const std::string name = std::string(suite.name()) + "." + test.name();
        if (matches(wanted, name)) kept += (kept.empty() ? "" : ":") + name;
      }
    }
    if (!any) {
      std::fprintf(stderr, "--of=%.*s: no test is in that\n", static_cast<int>(file.size()), file.data());
      return false;
    }
    more = comma != std::string_view::npos;
    files.remove_prefix(more ? comma + 1 : 0);
  }
  // With an empty list, gtest would run all.
  GTEST_FLAG_SET(filter, (kept.empty() ? "none" : kept) + before.substr(left_out));
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  constexpr std::string_view of = "--of=";
  if (argc > 1 && std::string_view(argv[1]).starts_with(of) && !keep_tests_of(argv[1] + of.size())) return 2;
  // What a shell starts in the background ignores Ctrl-C, what nohup starts SIGHUP, and so would programs of tests.
  for (const int stop : {SIGINT, SIGQUIT, SIGHUP})
    signal(stop, SIG_DFL);
  // Most tests use the device, so that passes and drivers are tested wherever there is a driver.
  setenv("PALPA_BACKEND", "gpu", 1);
  // No test depends on the results of an earlier one.
  setenv("PALPA_CACHE", "off", 1);
  // Property tests draw the same cases on every run, so that a failure repeats and no change fails by chance. Set
  // RC_PARAMS to try other cases.
  setenv("RC_PARAMS", "seed=20240601", 0);
  palpa::test::watch_barriers();
  const int failed = RUN_ALL_TESTS();
  if (palpa::gpu::validation_errors() != 0) {
    std::fprintf(stderr, "FAILED: %llu Vulkan validation errors\n",
                 static_cast<unsigned long long>(palpa::gpu::validation_errors()));
    return 1;
  }
  return failed;
}
