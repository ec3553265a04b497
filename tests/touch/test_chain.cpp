// The whole of touching: both backends against each other and against what must be true of any touch.
#include <gtest/gtest.h>

#include "support/device.hpp"
#include "touch/harness.hpp"

namespace palpa::touch::test {
namespace {

TEST(TouchChain, TheGpuAgreesWithTheTwin) {
  const auto points = fingertip(10'000, 3e-3);
  for (const geometry::Solid& solid : {cube(), half_ball({0, -0.02, 0}, 0.02, 1000)}) {
    const Touch cpu = touch_on(Backend::cpu, points, {solid});
    const Touch gpu = touch_on(Backend::gpu, points, {solid});
    EXPECT_GT(cpu.contacts.size(), 100u) << solid.name;
    EXPECT_EQ(cpu.finger_count, 1u);
    expect_identical(cpu, gpu);
  }
}

}  // namespace
}  // namespace palpa::touch::test
