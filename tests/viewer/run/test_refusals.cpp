// What palpa-viewer refuses without a window, in which words and with which exit code. It never ignores an option
// silently.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "cli/support/process.hpp"
#include "sensing/rig.hpp"
#include "support/files.hpp"
#include "support/shared_data.hpp"
#include "viewer/render/drawing_test.hpp"
#include "viewer_here.hpp"

namespace palpa::test {
namespace {

using Line = std::vector<std::string>;

class ViewerRefusals : public DrawingTest {
 protected:
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  struct Refusal {
    Line line, more;
    std::string told;
    int code = 2;
  };
  static void expect_refused(const std::vector<Refusal>& refusals) {
    for (const Refusal& one : refusals) {
      SCOPED_TRACE(one.more.empty() ? one.told : one.more[0]);
      expect_failure(viewer_here(with(one.line, one.more)), one.code, one.told);
    }
  }

  const std::filesystem::path folder_ = scratch_folder("viewer-refusals");
  const std::string cube_ = source_file("assets/cube.glb").string();
  const Line scene_{"--headless", "--scene", cube_}, layout_{"--headless", "--layout", "openmpd"},
      touch_ = cube_touch({"--headless"}), host_ = host_touch({}), live_ = with(scene_, {"--source", "synthetic"}),
      participant_ = with(scene_, {"--participant"});
};

TEST_F(ViewerRefusals, OptionsThatWouldBeIgnored) {
  expect_refused({
      {touch_, {"--slice-size", "5cm"}, "--slice-size goes with --slice"},
      {touch_, {"--eye", "0,0,1", "--frame", "all"}, "--frame goes with --view"},
      {touch_, {"--eye", "0,0,1", "--view", "top"}, "--view and --eye exclude each other"},
      {touch_, {"--eyes-apart", "60mm"}, "--eyes-apart goes with --participant"},
      {touch_, {"--barrier-gap", "1mm"}, "--barrier-gap goes with --stereo"},
      {touch_, {"--no-panels"}, "--no-panels and --headless exclude each other"},
      {touch_, {"--panels"}, "--panels goes with --source or --interact"},
      {touch_, {"--finger-width", "10mm"}, "--finger-width goes with --depth"},
      {touch_, {"--amplitude", "uniform"}, "--amplitude goes with --layout or --rig"},
      {touch_, {"--frequency", "41kHz"}, "--frequency goes with --layout or --rig"},
      {touch_, {"--hold", "1s"}, "--hold goes with --source"},
      {touch_, {"--board-files", "/"}, "--board-files goes with --source"},
      {touch_, {"--axes", "covariance"}, "--axes goes with --source"},
      {touch_, {"--at-touch"}, "--at-touch goes with --source"},
      {live_, {"--at-touch", "--interact", "x"}, "exclude each other"},
      {touch_, {"--threshold", "0.1"}, "--threshold goes with --reference"},
      {touch_, {"--monitor", "1"}, "--monitor goes with --participant"},
      {touch_, {"--screen", "x.toml"}, "--screen goes with --participant"},
      {touch_, {"--target", "0,0,0"}, "--target goes with --eye"},
      {touch_, {"--view", "camera"}, "--view camera goes with --depth"},
      {host_, {"--slice", "xz"}, "--slice goes with --layout or --rig"},
      {host_, {"--show", "heat"}, "--show heat goes with --layout or --rig"},
      {host_, {"--heat", "RA"}, "--heat goes with --layout or --rig"},
      {host_, {"--slice-at", "0,0,0"}, "--slice-at goes with --layout or --rig"},
      {host_, {"--layout", "autd3", "--show", "heat"}, "--skin"},
      {scene_, {"--spectrum"}, "--spectrum"},
      {scene_, {"--spot", "4mm"}, "--spot goes with --spectrum or --tune"},
      {scene_, {"--link", "null"}, "--source"},
      {layout_, {"--delta", "1mm"}, "--delta goes with --points or --depth"},
      {layout_, {"--foci", "8"}, "--foci goes with --points or --depth"},
      {layout_, {"--penetration", "3mm"}, "--penetration"},
      {layout_, {"--slice", "xz"}, "it needs a touch"},
      {layout_, {"--gltf-scene", "0"}, "--gltf-scene goes with --scene"},
      {layout_, {"--surface", "parts"}, "--surface goes with --scene"},
      {layout_, {"--tune-shortest", "1ms", "--tune-longest", "2ms", "--tune"}, "goes with --points or --depth"},
      {live_, {"--camera", "x.toml"}, "--camera goes with --depth"},
      {live_, {"--points", "x.ply"}, "--source"},
      {live_, {"--tune-shortest", "1ms", "--tune-longest", "2ms"}, "--tune-shortest goes with --tune"},
      {live_, {"--tune-shortest", "1ms", "--tune-longest", "2ms", "--tune"}, "while running, --tune chooses strides"},
      {live_, {"--spectrum"}, "--spectrum and --source exclude each other"},
      {scene_, {"--sensation", "circle"}, "--scene and --sensation exclude each other"},
      {live_, {"--sensation", "circle"}, "--sensation"},
      {layout_, {"--param", "radius=5"}, "--param goes with --sensation"},
      {layout_, {"--sensation", "circle", "--heat", "RA"}, "--heat goes with --points or --depth"},
      {participant_, {"--ortho"}, "--ortho sets the viewpoint"},
      {participant_, {"--stereo", "anaglyph", "--barrier-pitch", "1mm"}, "--barrier-pitch goes with --stereo"},
      {participant_, {"--eyes-apart", "60mm"}, "--eyes-apart goes with --stereo"},
      {{"--layout", "openmpd"}, {"--panels"}, "--panels goes with --headless"},
      {{"--layout", "openmpd"}, {"--screenshot", "x.png"}, "--screenshot goes with --headless"},
  });
}

TEST_F(ViewerRefusals, ValuesThatAreWrong) {
  expect_refused({
      {{"--headless"}, {}, "--scene"},
      {{"--no-panels"}, {}, "--scene"},
      {cube_touch({"--headless"}, "12x"), {}, "--size"},
      {cube_touch({"--headless"}, "1x1"), {}, "--size"},
      {touch_, {"--view", "below"}, "--view"},
      {touch_, {"--stride", "5"}, "--stride"},
      {touch_, {"--eye", "0,0,0"}, "--eye"},
      {touch_, {"--eye", "1e300,0,0"}, "--eye"},
      {touch_, {"--frames", "0"}, "--frames"},
      {touch_, {"--nonsense"}, "--nonsense"},
      {host_, {"--hide", "grid,nonsense"}, "'nonsense' is not a layer; give solids"},
      {host_, {"--show", "grid,"}, "--show"},
      {host_, {"--opacity", "solids"}, "--opacity"},
      {host_, {"--opacity", "solids=2"}, "solids=2"},
      {host_, {"--explode", "2"}, "--explode"},
      {participant_, {"--stereo", "columns", "--barrier-gap", "0"}, "--barrier-gap"},
      {participant_, {"--stereo", "nonsense"}, "--stereo"},
      {layout_, {"--sensation", "circle", "--param", "width=5"}, "has no parameter 'width'; it has radius"},
      {participant_, {"--eye", "0,0,-1"}, "not in front of the screen"},
  });
}

TEST_F(ViewerRefusals, FilesThatCannotBeReadOrWritten) {
  write_text(folder_ / "cloud.ply",
             "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
             "property float z\nend_header\n0 0 0\n");
  write_text(folder_ / "text.glb", "no model");
  write_text(folder_ / "bare.toml", sensing::to_toml(sensing::Rig{}));
  write_text(folder_ / "script", "draw\njump\n");
  expect_refused({
      {{"--headless", "--scene", path("absent.glb")}, {}, "absent.glb", 4},
      {{"--headless", "--scene", "/nowhere.glb"}, {"--source", "synthetic"}, "/nowhere.glb", 4},
      {host_, {"--skin", path("cloud.ply")}, "cloud.ply", 4},
      {host_, {"--layout", "nonsense"}, "nonsense", 4},
      {host_, {"--reference", path("text.glb")}, "text.glb", 4},
      {host_, {"--video", "/no/such/folder"}, "/no/such/folder", 1},
      {live_, {"--interact", path("script")}, ":2: ", 4},
      {participant_, {"--screen", path("bare.toml")}, "bare.toml", 4},
  });
}

/// The same from the program itself, once for each exit code.
TEST_F(ViewerRefusals, AreTheProgramsExitCodes) {
  expect_failure(viewer(cube_touch({"--headless", "--screenshot", "/no/such/folder/p.png"})), 1,
                 "/no/such/folder/p.png");
  expect_failure(viewer(with(touch_, {"--no-panels"})), 2, "--no-panels and --headless exclude each other");
  expect_failure(viewer(with(touch_, {"--gpu", "no such device"})), 3, "no such device");
  for (const Line& line : {cube_touch({}), Line{}})
    expect_failure(viewer(line), 3, "--headless");  // there is no display
  write_text(folder_ / "text.glb", "no model");
  expect_failure(viewer({"--scene", path("text.glb"), "--headless"}), 4, "text.glb");
}

}  // namespace
}  // namespace palpa::test
