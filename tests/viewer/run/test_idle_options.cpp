// palpa-viewer never ignores an option silently.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "cli/support/process.hpp"
#include "support/shared_data.hpp"
#include "viewer_here.hpp"

namespace palpa::test {
namespace {

TEST(ViewerOptions, ThatWouldBeIgnoredAreRefused) {
  using Line = std::vector<std::string>;
  const Line layout{"--headless", "--layout", "openmpd"},
      touch{"--headless",
            "--scene",
            source_file("assets/cube.glb").string(),
            "--points",
            source_file("assets/finger.ply").string(),
            "--penetration",
            "3mm"},
      live{"--headless", "--scene", source_file("assets/cube.glb").string(), "--source", "synthetic"},
      participant{"--headless", "--scene", source_file("assets/cube.glb").string(), "--participant"};
  struct Idle {
    Line line, given;
    std::string told;
  };
  for (const Idle& idle : std::vector<Idle>{
           {touch, {"--slice-size", "5cm"}, "--slice-size goes with --slice"},
           {touch, {"--eye", "0,0,1", "--frame", "all"}, "--frame goes with --view"},
           {touch, {"--eye", "0,0,1", "--view", "top"}, "--view and --eye both set"},
           {touch, {"--eyes-apart", "60mm"}, "--eyes-apart goes with --participant"},
           {touch, {"--barrier-gap", "1mm"}, "--barrier-gap goes with --stereo"},
           {touch, {"--no-panels"}, "--no-panels goes with a window"},
           {touch, {"--panels"}, "--panels goes with --source or --interact"},
           {touch, {"--finger-width", "10mm"}, "--finger-width goes with --depth"},
           {touch, {"--amplitude", "uniform"}, "--amplitude goes with --layout or --rig"},
           {touch, {"--frequency", "41kHz"}, "--frequency goes with --layout or --rig"},
           {touch, {"--hold", "1s"}, "--hold goes with --source"},
           {touch, {"--board-files", "/"}, "--board-files goes with --source"},
           {touch, {"--axes", "covariance"}, "--axes goes with --source"},
           {touch, {"--threshold", "0.1"}, "--threshold goes with --reference"},
           {touch, {"--monitor", "1"}, "--monitor goes with --participant"},
           {touch, {"--screen", "x.toml"}, "--screen and --stereo go with --participant"},
           {touch, {"--target", "0,0,0"}, "--target goes with --eye"},
           {layout, {"--delta", "1mm"}, "--delta goes with --points or --depth"},
           {layout, {"--foci", "8"}, "--foci goes with --points or --depth"},
           {layout, {"--gltf-scene", "0"}, "--gltf-scene goes with --scene"},
           {layout, {"--surface", "parts"}, "--surface goes with --scene"},
           {layout, {"--tune-shortest", "1ms", "--tune-longest", "2ms", "--tune"}, "goes with --points or --depth"},
           {live, {"--camera", "x.toml"}, "--camera goes with --depth"},
           {live, {"--tune-shortest", "1ms", "--tune-longest", "2ms"}, "--tune-shortest goes with --tune"},
           {live,
            {"--tune-shortest", "1ms", "--tune-longest", "2ms", "--tune"},
            "while running, --tune chooses strides"},
           {live, {"--spectrum"}, "--spectrum goes with --points or --depth"},
           {participant, {"--ortho"}, "--ortho sets the viewpoint"},
           {participant, {"--stereo", "anaglyph", "--barrier-pitch", "1mm"}, "--barrier-pitch goes with --stereo"},
           {participant, {"--eyes-apart", "60mm"}, "--eyes-apart goes with --stereo"},
           {{"--layout", "openmpd"}, {"--panels"}, "--panels goes with --headless"},
           {{"--layout", "openmpd"}, {"--screenshot", "x.png"}, "--screenshot goes with --headless"},
       }) {
    SCOPED_TRACE(idle.given[0]);
    expect_failure(viewer_here(with(idle.line, idle.given)), 2, idle.told);
  }
  expect_failure(run_program(PALPA_VIEWER_BINARY, with(touch, {"--no-panels"}), {{{"DISPLAY", ""}}}), 2,
                 "--no-panels goes with a window");
}

}  // namespace
}  // namespace palpa::test
