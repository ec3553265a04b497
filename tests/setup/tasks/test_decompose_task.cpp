// `palpa decompose`, called from C++.
#include "setup/tasks/decompose.hpp"

#include <gtest/gtest.h>

#include "support/thrown.hpp"

namespace palpa::test {
namespace {

TEST(DecomposeTask, RefusesASceneWithoutAMesh) {
  setup::DecomposeTask task;
  task.scene = "no-such.glb";
  EXPECT_REFUSED(setup::decompose(task), "no-such.glb");
}

}  // namespace
}  // namespace palpa::test
