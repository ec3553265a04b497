// Programs with little memory: they do their work or report in one line why not. They never crash or hang.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "cli/support/process.hpp"
#include "house/small_body.hpp"
#include "support/shared_data.hpp"

namespace palpa::test {
namespace {

using Arguments = std::vector<std::string>;

/// With `ulimit -v`, in megabytes.
Result limited(int megabytes, const std::string& program, const Arguments& arguments) {
  const std::string limit = "ulimit -c 0; ulimit -v " + std::to_string(megabytes * 1000) + "; exec \"$0\" \"$@\"";
  return run_program("/bin/sh", with({"-c", limit, program}, arguments),
                     {.environment = {where_assets_are(), {"PALPA_CACHE", "off"}}});
}

void expect_work_or_a_line(const Result& result, const std::string& what) {
  EXPECT_FALSE(result.timed_out) << what << " hangs";
  EXPECT_EQ(result.signal, 0) << what << ": " << result.err;
  EXPECT_TRUE(result.exit_code == 0 || result.exit_code == 1 || result.exit_code == 3)
      << what << " exits with " << result.exit_code << ": " << result.err;
  EXPECT_EQ(result.err_lines().size(), result.exit_code == 0 ? 0u : 1u) << what << ": " << result.err;
  EXPECT_EQ(result.err.find(": error: ") != std::string::npos, result.exit_code != 0) << what << ": " << result.err;
}

/// From limits in which only the programs themselves fit to limits in which everything fits.
const std::vector<int> limits{80,  100, 130, 160, 206, 215,  220,  300,  400,
                              500, 600, 700, 800, 900, 1000, 1200, 1500, 2000};

class WithLittleMemory : public testing::TestWithParam<int> {};

TEST_P(WithLittleMemory, ProgramsWorkOrSayInOneLineWhyNot) {
  const std::filesystem::path folder = scratch_folder("little-memory");
  const std::string body = write_small_body(folder);
  const std::string cube = source_file("assets/cube.glb"), finger = source_file("assets/finger.ply");
  const Arguments drive{"drive", "--layout", "openmpd", "--focus", "0,0,15cm", "--quiet"};
  const std::vector<Arguments> commands{
      {"doctor", "--quiet"},
      drive,
      with(drive, {"--backend", "cpu"}),
      with(drive, {"--backend", "auto"}),
      {"scatter", "--mesh", body, "--plane-wave", "0,0,1", "--quiet"},
      {"run", "--scene", cube, "--frames", "2", "--every-frame", "--quiet"},
  };
  const int megabytes = GetParam();
  for (const Arguments& command : commands) {
    const Result result = limited(megabytes, palpa_binary(), command);
    expect_work_or_a_line(result, command.front() + " with " + std::to_string(megabytes) + " MB");
    if (megabytes >= 100 && command.back() == "cpu") {
      EXPECT_EQ(result.exit_code, 0) << megabytes << " MB: " << result.err;
    }
  }
#ifdef PALPA_VIEWER_BINARY
  expect_work_or_a_line(
      limited(megabytes, PALPA_VIEWER_BINARY,
              {"--scene", cube, "--points", finger, "--headless", "--quiet", "--screenshot", folder / "x.png"}),
      "palpa-viewer with " + std::to_string(megabytes) + " MB");
#endif
}

INSTANTIATE_TEST_SUITE_P(Megabytes, WithLittleMemory, testing::ValuesIn(limits), testing::PrintToStringParamName());

// A program with too little memory for a device says how much it needs.
TEST(LittleMemory, ADeviceThatDoesNotFitSaysWhatItNeeds) {
  const Result result = limited(500, palpa_binary(), {"drive", "--layout", "openmpd", "--focus", "0,0,15cm"});
  if (result.exit_code == 0) GTEST_SKIP() << "a GPU with memory of its own";
  expect_failure(result, 1, "raise them");
  EXPECT_NE(result.err.find("ulimit -v"), std::string::npos) << result.err;
  EXPECT_NE(result.err.find(" MB more"), std::string::npos) << result.err;
}

// OpenBLAS starts threads that wait busily, and that do not end if memory is short.
TEST(LittleMemory, OnlyScatteringLoadsOpenBlas) {
  const auto loads = [](const Arguments& arguments) {
    const Result result = palpa(arguments, {.environment = {{"LD_DEBUG", "files"}, {"PALPA_CACHE", "off"}}});
    EXPECT_EQ(result.exit_code, 0) << arguments.front();
    return result.err.find("libopenblas") != std::string::npos;
  };
  const std::string body = write_small_body(scratch_folder("openblas"));
  EXPECT_TRUE(loads({"scatter", "--mesh", body, "--plane-wave", "0,0,1"}));
  EXPECT_FALSE(loads({"--version"}));
  EXPECT_FALSE(loads({"doctor"}));
  EXPECT_FALSE(loads({"drive", "--layout", "openmpd", "--focus", "0,0,15cm"}));
  EXPECT_FALSE(loads({"run", "--scene", source_file("assets/cube.glb"), "--frames", "2", "--every-frame"}));
}

}  // namespace
}  // namespace palpa::test
