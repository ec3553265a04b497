// What tests that draw have in common.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

namespace palpa::test {

/// Skips where the driver is told to use vectors that its rasterizer cannot compile for.
class DrawingTest : public testing::Test {
 protected:
  void SetUp() override {
    const char* width = std::getenv("LP_NATIVE_VECTOR_WIDTH");
    if (width && std::string(width) == "512") GTEST_SKIP() << "skipped: llvmpipe cannot draw with 512-bit vectors";
  }
};

}  // namespace palpa::test
