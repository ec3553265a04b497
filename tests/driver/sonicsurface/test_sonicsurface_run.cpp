// `palpa run` with emulated SonicSurface boards: the real programs, with a line between them.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "cli/support/process.hpp"
#include "driver/boards_run.hpp"
#include "driver/sonicsurface/sonicsurface_rig.hpp"
#include "support/begins.hpp"
#include "support/files.hpp"
#include "support/pseudo_terminal.hpp"
#include "support/shared_data.hpp"
#include "support/side_by_side.hpp"
#include "support/thrown.hpp"

namespace palpa::test {
namespace {

/// palpa, repeated while the guard of the previous run still holds the line: on a busy machine, that guard ends a
/// little later.
Result palpa_on_free_line(const std::vector<std::string>& arguments) {
  Result result;
  begins([&] {
    result = palpa(arguments);
    return result.err.find("another program has it") == std::string::npos;
  });
  return result;
}

TEST(SonicSurfaceRun, ABoardHearsASingleFocusToItsSilentEnd) {
  PALPA_TERMINAL_OR_SKIP();
  SonicSurfaceLine line, of_the_link_alone, of_long_dwells;
  const auto link = [](const SonicSurfaceLine& to) { return "sonicsurface:" + to.path(); };
  const auto as_asked = [&] {
    const Result result = succeeded(palpa_on_free_line(
        with(run_to_board(link(line), "sonicsurface"), {"--method", "single-focus", "--json", "-"})));
    expect_counts(result.out);
  };
  // Only the link names the array, and no option names a method: the small rig without its array.
  const auto rig = scratch_folder("sonicsurface-run") / "rig.toml";
  const std::string small_rig = read_text(source_file("tests/cli/support/small_rig.toml"));
  write_text(rig, small_rig.substr(0, small_rig.find("[array]")));
  const auto as_the_link_says = [&] {
    const Result chosen = succeeded(palpa_on_free_line(
        {"run", "--scene", source_file("assets/cube.glb").string(), "--source", "synthetic", "--rig", rig.string(),
         "--noise-free", "--frames", "30", "--hold", "500ms", "--link", link(of_the_link_alone)}));
    EXPECT_CONTAINS(chosen.err, "takes 11.3 ms for each focus");
    EXPECT_CONTAINS(chosen.err, "palpa plays --method single-focus");
  };
  const auto slowly = [&] {
    const Result slow = succeeded(palpa(with(run_to_board(link(of_long_dwells), "sonicsurface"), {"--dwell", "12ms"})));
    EXPECT_EQ(slow.err.find("single-focus"), std::string::npos) << "this dwell time can be played: " << slow.err;
  };
  side_by_side({as_asked, as_the_link_says, slowly});
  for (SonicSurfaceLine* const each : {&line, &of_the_link_alone, &of_long_dwells}) {
    EXPECT_TRUE(each->falls_silent());
    each->end();
    EXPECT_EQ(each->machine.violations().count(), 0u) << each->machine.violations().kept()[0].what;
    EXPECT_GT(each->machine.swaps(), 8u) << "more than those of its silences";
  }
}

}  // namespace
}  // namespace palpa::test
