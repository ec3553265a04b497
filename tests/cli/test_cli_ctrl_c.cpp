// Ctrl-C while a command prepares a large model or computes for long.
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "base/version.hpp"
#include "cli/support/boxes.hpp"
#include "cli/support/process.hpp"
#include "cli/support/terminal.hpp"
#include "geometry/files/ply.hpp"
#include "geometry/gltf/write.hpp"
#include "geometry/mesh/icosphere.hpp"
#include "support/pseudo_terminal.hpp"
#include "support/shapes.hpp"
#include "support/shared_data.hpp"
#include "support/time_limits.hpp"

namespace palpa::test {
namespace {

std::string scene_of(const std::filesystem::path& file, const geometry::Mesh& mesh) {
  const geometry::SceneMesh scene{file.stem(), mesh};
  geometry::write_glb(file, std::span(&scene, 1));
  return file;
}

/// Many bumps, which are many voxels.
geometry::Mesh bumps() {
  geometry::Mesh mesh;
  for (int i = 0; i < 40; ++i) {
    const double x = 0.02 * (i % 8), z = 0.02 * (i / 8);
    geometry::append(mesh, box({x, -0.04, z}, {x + 0.012, 0.003 * i, z + 0.012}));
  }
  return mesh;
}

TEST(LongWork, SaysWhatItDoesAndEndsAtOnceOnCtrlCWithoutAFile) {
  PALPA_TERMINAL_OR_SKIP();
  const std::filesystem::path folder = scratch_folder("ctrl-c"), out = folder / "out";
  std::filesystem::create_directories(out);
  // A large finger, its tip at the origin.
  geometry::Mesh mesh = geometry::icosphere(15e-3, 22);
  const Vec3 lowest = *std::ranges::min_element(mesh.positions, {}, &Vec3::y);
  for (Vec3& p : mesh.positions)
    p -= lowest;
  geometry::write_ply(folder / "finger.ply", mesh.positions, mesh.triangles);
  scene_of(folder / "ball.glb", bumpy_ball(450));  // prepared within seconds, not within a moment
  scene_of(folder / "bumps.glb", bumps());
  const Names names{
      {"CUBE", source_file("assets/cube.glb")}, {"TIP", source_file("assets/finger.ply")}, {"IN/", folder / ""}};
  const std::string tables = " --csv IN/out/a.csv --json IN/out/a.json",
                    drawn = " --vtu IN/out/a.vtu --png IN/out/a.png",
                    field = "field --layout paper --focus 0,0,0 --plane xy --size 60mm,60mm --pixels 1500,1500" + drawn;
  const std::vector<std::string> sum{"summing the sound of transducers"}, matrix{"filling the matrix of the surface"},
      preparing{"checking mesh \"ball\" of 404100 triangles", "preparing mesh \"ball\": ", " %"};
  const struct {
    std::string line;
    std::vector<std::string> told;
  } lines[]{{field + tables + " --backend gpu", sum},
            {field + tables + " --backend cpu", sum},
            {"scatter --mesh IN/finger.ply --plane-wave 0,0,1" + tables, matrix},
            {"simulate --scene CUBE --finger IN/finger.ply --backend cpu" + drawn + tables, matrix},
            {"touch --scene IN/ball.glb --points TIP --backend cpu --json IN/out/a.json", preparing},
            {"run --scene IN/ball.glb --backend cpu --link record:IN/out/a.bin", preparing},
            {"decompose --scene IN/bumps.glb --resolution 4M --out IN/out/a.glb",
             {"mesh \"bumps\": cutting it into convex parts"}}};
  for (const auto& [line, told] : lines) {
    if (line.starts_with("decompose") && !built_with("V-HACD")) continue;
    SCOPED_TRACE(line);
    Terminal terminal(words_of(line, names));
    for (const std::string& part : told)
      EXPECT_TRUE(terminal.shows(part)) << terminal.text();
    terminal.type("\x03");
    EXPECT_EQ(terminal.ended_by_signal(), SIGINT) << terminal.text();
    EXPECT_LT(terminal.processor_s_to_end(), slowest);
    EXPECT_TRUE(std::filesystem::is_empty(out));
  }
}

}  // namespace
}  // namespace palpa::test
