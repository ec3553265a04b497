// A barrier that is missing after any of the touch's kernels is seen.
#include <gtest/gtest.h>

#include <string>

#include "support/barriers.hpp"
#include "support/thrown.hpp"
#include "touch/harness.hpp"

namespace palpa::touch::test {
namespace {

TEST(MissingBarriers, AreSeenAfterEachKernelOfTheTouch) {
  const auto points = random_points(500, Vec3(-0.02, -0.03, -0.02), Vec3(0.02, 0.01, 0.02));
  FingerOptions inside;
  inside.cluster = Cluster::inside;
  const auto touch = [&] { touch_on(Backend::gpu, points, {cube()}, inside, 1); };
  EXPECT_EQ(palpa::test::error_of(touch, Exit::failed), "") << "with all barriers";
  for (const char* kernel : {"contacts_find", "contacts_pack", "clusters_gather", "clusters_prepare", "clusters_insert",
                             "clusters_collect", "clusters_place", "clusters_blocks", "clusters_link",
                             "clusters_crowded", "clusters_undecided", "clusters_label"}) {
    const palpa::test::NoBarrierAfter none(kernel);
    EXPECT_CONTAINS(palpa::test::error_of(touch, Exit::failed), std::string("which ") + kernel + " ");
  }
}

// The host reads what several kernels wrote, or a copy does on devices with memory of their own; the line names one.
TEST(MissingBarriers, AreSeenBetweenTheTouchAndTheHost) {
  const auto points = random_points(500, Vec3(-0.02, -0.03, -0.02), Vec3(0.02, 0.01, 0.02));
  const palpa::test::NoBarrierAfter none("clusters_select");
  const std::string told =
      palpa::test::error_of([&] { touch_on(Backend::gpu, points, {cube()}, {}, 1); }, Exit::failed);
  EXPECT_TRUE(told.starts_with("the host reads 'a buffer', which ") ||
              told.starts_with("a copy reads 'a buffer', which "))
      << told;
}

}  // namespace
}  // namespace palpa::touch::test
