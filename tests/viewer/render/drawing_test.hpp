// What tests that draw have in common.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "gpu/device.hpp"

namespace palpa::test {

/// Skips where the renderer refuses the driver, see Renderer: llvmpipe of Mesa 22 with vectors of 512 bits.
class DrawingTest : public testing::Test {
 protected:
  void SetUp() override {
    static const std::vector<gpu::DeviceDescription> devices = gpu::list_devices();
    const bool refused = std::any_of(devices.begin(), devices.end(), [](const gpu::DeviceDescription& device) {
      return device.name.find("512 bits") != std::string::npos && device.driver.find("Mesa 22.") != std::string::npos;
    });
    if (refused) GTEST_SKIP() << "skipped: llvmpipe of Mesa 22 cannot draw with 512-bit vectors";
  }
};

}  // namespace palpa::test
