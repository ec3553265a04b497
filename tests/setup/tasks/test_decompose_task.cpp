// The results of `palpa decompose`, called from C++: the same bytes as the command's.
#include "setup/tasks/decompose.hpp"

#include <gtest/gtest.h>

#include <string>

#include "command_json.hpp"
#include "geometry/gltf/write.hpp"
#include "support/files.hpp"
#include "support/shapes.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::test {
namespace {

TEST(DecomposeTask, IsTheCommands) {
  const std::filesystem::path folder = scratch_folder("decompose-task");
  // Convex boxes, which need no V-HACD.
  const std::vector<geometry::SceneMesh> boxes{{"low", box({0, 0, 0}, {0.04, 0.02, 0.04})},
                                               {"high", box({0, 0.05, 0}, {0.04, 0.06, 0.03})}};
  setup::DecomposeTask task;
  task.scene = folder / "boxes.glb";
  task.seed = 5;
  geometry::write_glb(task.scene, boxes);
  const std::string theirs = folder / "theirs.glb", ours = folder / "ours.glb";
  bool read = false;
  const std::vector<setup::Decomposed> solids = setup::decompose(task, [&] { read = true; });
  EXPECT_TRUE(read);
  EXPECT_EQ(untimed(setup::to_json(solids, theirs)),
            command_json({"decompose", "--scene", task.scene, "--out", theirs, "--seed", "5"}));
  geometry::write_glb(ours, setup::part_meshes(solids));
  EXPECT_EQ(read_text(ours), read_text(theirs));
}

TEST(DecomposeTask, RefusesASceneWithoutAMesh) {
  setup::DecomposeTask task;
  task.scene = "no-such.glb";
  EXPECT_REFUSED(setup::decompose(task), "no-such.glb");
}

}  // namespace
}  // namespace palpa::test
