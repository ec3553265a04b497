// palpa run --transfer finger: foci on the fingers that touch.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "cli/support/here.hpp"
#include "cli/support/process.hpp"
#include "geometry/files/ply.hpp"
#include "geometry/mesh/icosphere.hpp"
#include "support/files.hpp"
#include "support/json.hpp"
#include "support/shared_data.hpp"

namespace palpa::test {
namespace {

using nlohmann::json;

/// A blunt finger in a PLY: 24 mm long, its tip `raised` above the origin.
std::string finger_file(double raised, int divisions) {
  geometry::Mesh mesh = geometry::icosphere(8e-3, divisions);
  for (Vec3& p : mesh.positions)
    p.y = 1.5 * p.y + 12e-3 + raised;
  const auto file = scratch_folder("finger") / "finger.ply";
  geometry::write_ply(file, mesh.positions, mesh.triangles);
  return file.string();
}

// docs/solvers.md, "On fingers that move".
TEST(CliFingerRun, ComputesFociOnTheFingersThatTouch) {
  const std::string cube = source_file("assets/cube.glb").string();
  const Result result = palpa_here({"run", "--scene", cube, "--layout", "openmpd", "--backend", "cpu", "--frames",
                                    "270", "--transfer", "finger", "--stats", "json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json transfer = json::parse(result.out)["transfer"];
  EXPECT_GE(transfer["touching"], 1);
  EXPECT_LE(transfer["frames"], transfer["touching"]);
  EXPECT_EQ(transfer["took_ms"]["count"], transfer["answers"].get<int>() + transfer["not_found"].get<int>());
  // On a busy machine, no answer may come in these seconds.
  if (transfer["answers"] > 0) {
    EXPECT_GE(transfer["gain"]["least"], 0.95);
    EXPECT_LE(transfer["gain"]["median"], 3.0);
  }
  const auto refused = [&](const std::vector<std::string>& more, int code, const char* says) {
    expect_failure(palpa_here(with({"run", "--scene", cube, "--frames", "1", "--transfer", "finger"}, more)), code,
                   says);
  };
  refused({"--predict", "auto"}, 2, "they are not predicted");
  refused({"--predict-latency", "20ms"}, 2, "they are not predicted");
  refused({"--every-frame"}, 2, "--every-frame cannot have it");
  refused({"--finger", finger_file(5e-3, 14)}, 4, "a finger's tip must be at the origin");
  refused({"--finger", finger_file(0, 19)}, 4, "take too long to follow a finger with");
  refused({"--finger", "none.ply"}, 4, "none.ply");
}

}  // namespace
}  // namespace palpa::test
