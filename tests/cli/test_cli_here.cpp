// A line that tests run in their own process (here.hpp) has the same output as in the program.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "cli/support/here.hpp"
#include "support/instrumented.hpp"
#include "support/shared_data.hpp"

namespace palpa::test {
namespace {

/// Lines of every outcome. Some follow a line that leaves state behind in its process: a log level, or warnings that
/// were kept or printed.
std::vector<std::vector<std::string>> lines() {
  const std::string cube = source_file("assets/cube.glb").string(), finger = source_file("assets/finger.ply").string();
  const std::vector<std::string> drive{"drive", "--layout", "openmpd", "--focus", "0,0,150mm", "--backend", "cpu"},
      touch{"touch", "--scene", cube, "--points", finger, "--penetration", "3mm", "--backend", "cpu"};
  return {
      {"--help"},
      {"feel"},
      with(drive, {"--frequency", "60.1kHz", "--json", "-"}),
      with(touch, {"--dwell", "51ms", "--gltf-scene", "7"}),
      with(drive, {"--frequency", "60.1kHz"}),
      with(drive, {"--frequency", "60.1kHz", "--log-level", "info", "--csv", "-"}),
      with(drive, {"--frequency", "60.1kHz"}),
      with(drive, {"--log-level", "quiet", "--layout", "openmpd"}),
      with(drive, {"--log-level", "quiet", "--solver", "adjoint"}),
      {},
      {"--version"},
      {"emulate", "--help"},
      with(drive, {"--csv", "-"}),
      with(drive, {"--csv", "/dev/full"}),
      with(drive, {"--csv", "/dev/stdout", "--json", "-"}),
      with(touch, {"--csv", finger}),
      with(touch, {"--csv", "-"}),
      {"drive", "--layout", "openmpd", "--focus", "0,0,150mm", "--gpu", "no such device"},
      {"run", "--scene", cube, "--link", "nobody:"},
      {"run", "--scene", cube, "--source", "bag:none.bag"},
      {"emulate", "autd3", "--port", "0", "--uart"},
  };
}

TEST(Here, ALineSaysWhatTheProgramSays) {
  for (const std::vector<std::string>& line : the_first(6, lines())) {
    SCOPED_TRACE(testing::PrintToString(line));
    const Result here = palpa_here(line), program = palpa(line);
    EXPECT_EQ(here.exit_code, program.exit_code);
    EXPECT_EQ(here.out, program.out);
    EXPECT_EQ(here.err, program.err);
  }
}

TEST(Here, AFullStdoutIsSeen) {
  expect_failure(palpa_here({"--version"}, "/dev/full"), 1, "stdout: cannot be written: No space left on device");
}

}  // namespace
}  // namespace palpa::test
