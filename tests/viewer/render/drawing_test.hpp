// The common part of tests that draw.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "gpu/device.hpp"

namespace palpa::test {

/// Skips the test if the renderer refuses the driver, see gpu::DeviceDescription::cannot_draw.
class DrawingTest : public testing::Test {
 protected:
  void SetUp() override {
    static const std::vector<gpu::DeviceDescription> devices = gpu::list_devices();
    const bool refused = std::any_of(devices.begin(), devices.end(),
                                     [](const gpu::DeviceDescription& device) { return device.cannot_draw; });
    if (refused) GTEST_SKIP() << "skipped: llvmpipe of Mesa 22 cannot draw with 512-bit vectors";
  }
};

}  // namespace palpa::test
