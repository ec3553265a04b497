// What palpa-viewer refuses without a window. One line of each kind is the program's; the others run in this process.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "cli/support/process.hpp"
#include "geometry/gltf/gltf.hpp"
#include "geometry/gltf/write.hpp"
#include "support/shared_data.hpp"
#include "viewer/render/drawing_test.hpp"
#include "viewer_here.hpp"

namespace palpa {
namespace {

using ViewerRefusals = test::DrawingTest;

using test::cube_touch;
using test::host_touch;
using test::source_file;
using test::viewer;
using test::viewer_here;

TEST_F(ViewerRefusals, WithoutADisplayItSaysSoAndSuggestsHeadless) {
  test::expect_failure(viewer(cube_touch({})), 3, "--headless");
}

TEST_F(ViewerRefusals, BadUsage) {
  test::expect_failure(viewer({}), 3, "--headless");  // an empty window, but there is no display
  test::expect_failure(viewer_here({"--headless"}), 2, "--scene");
  test::expect_failure(viewer_here({"--no-panels"}), 2, "--scene");
  test::expect_failure(viewer_here({"--headless", "--participant", "--scene", source_file("assets/cube.glb").string(),
                                    "--stereo", "columns", "--barrier-gap", "0"}),
                       2, "--barrier-gap");
  test::expect_failure(viewer(cube_touch({"--screenshot", "p.png"})), 2, "--headless");
  test::expect_failure(viewer_here(cube_touch({"--headless"}, "12x")), 2, "--size");
  test::expect_failure(viewer_here(cube_touch({"--headless"}, "1x1")), 2, "--size");
  test::expect_failure(viewer_here(cube_touch({"--headless", "--view", "below"})), 2, "--view");
  test::expect_failure(viewer_here(cube_touch({"--headless", "--stride", "5"})), 2, "--stride");
  test::expect_failure(viewer_here(cube_touch({"--headless", "--eye", "0,0,0"})), 2, "--eye");
  test::expect_failure(viewer_here(cube_touch({"--headless", "--threshold", "0.1"})), 2, "--reference");
  test::expect_failure(viewer_here(cube_touch({"--headless", "--frames", "0"})), 2, "--frames");
  test::expect_failure(viewer_here(cube_touch({"--headless", "--nonsense"})), 2, "--nonsense");
  test::expect_failure(viewer_here({"--headless", "--layout", "paper", "--penetration", "3mm"}), 2, "--penetration");
}

TEST_F(ViewerRefusals, NoSuchDevice) {
  test::expect_failure(viewer(cube_touch({"--headless", "--gpu", "no such device"})), 3, "no such device");
}

TEST_F(ViewerRefusals, BadInput) {
  const auto folder = test::scratch_folder("viewer-bad");
  const std::string cloud = (folder / "cloud.ply").string(), text = (folder / "text.glb").string();
  std::ofstream(cloud)
      << "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
         "end_header\n0 0 0\n";
  std::ofstream(text) << "no model";
  test::expect_failure(viewer({"--scene", text, "--headless"}), 4, "text.glb");
  test::expect_failure(viewer_here({"--scene", (folder / "absent.glb").string(), "--headless"}), 4, "absent.glb");
  test::expect_failure(viewer_here(host_touch({"--skin", cloud})), 4, "cloud.ply");
  test::expect_failure(viewer_here(host_touch({"--layout", "nonsense"})), 4, "nonsense");
  test::expect_failure(viewer_here(host_touch({"--reference", text})), 4, "text.glb");
}

TEST_F(ViewerRefusals, AStrideThatLeavesFociOutIsTheScenesFault) {
  const auto folder = test::scratch_folder("viewer-stride");
  auto meshes = geometry::load_gltf(source_file("assets/cube.glb")).meshes;
  meshes.at(0).haptics.foci = 9;
  geometry::write_glb(folder / "nine.glb", meshes);
  const std::vector<std::string> line{"--scene",    (folder / "nine.glb").string(),
                                      "--points",   source_file("assets/finger.ply").string(),
                                      "--headless", "--backend",
                                      "cpu",        "--stride",
                                      "3"};
  const auto refused = viewer(line);
  test::expect_failure(refused, 4, "nine.glb");
  test::expect_failure(refused, 4, "node 'cube': stride 3 and 9 foci share the divisor 3");
}

TEST_F(ViewerRefusals, ACamerasViewGoesWithACamera) {
  test::expect_failure(viewer(cube_touch({"--headless", "--view", "camera"})), 2, "--view camera goes with --depth");
}

TEST_F(ViewerRefusals, AnUnwritableScreenshotIsAFailure) {
  test::expect_failure(viewer(cube_touch({"--headless", "--screenshot", "/no/such/folder/p.png"})), 1,
                       "/no/such/folder/p.png");
}

}  // namespace
}  // namespace palpa
