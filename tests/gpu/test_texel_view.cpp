#include <gtest/gtest.h>

#include <string>

#include "gpu/texel_view.hpp"
#include "support/device.hpp"
#include "support/thrown.hpp"

namespace palpa {
namespace {

TEST(TexelView, KeepsTheBufferThatItIsOf) {
  gpu::Device& device = test::test_device();
  const gpu::Buffer buffer(device, 64, "texels");
  const gpu::TexelView view(device, buffer.ref(), VK_FORMAT_R32G32B32A32_UINT, "texels");
  EXPECT_EQ(view.ref().buffer, buffer.ref().buffer);
  EXPECT_EQ(view.ref().size, 64U);
  EXPECT_NE(view.ref().texels, VkBufferView{});
  EXPECT_EQ(buffer.ref().texels, VkBufferView{});
}

TEST(TexelView, OfMoreTexelsThanTheDeviceAddressesIsRefused) {
  gpu::Device& device = test::test_device();
  const gpu::Buffer buffer(device, 64, "texels");
  gpu::BufferRef vast = buffer.ref();
  vast.size = (VkDeviceSize{device.limits().maxTexelBufferElements} + 1) * 8;
  const std::string line =
      test::thrown_by([&] { gpu::TexelView(device, vast, VK_FORMAT_R32G32_UINT, "surface cells"); }).what();
  EXPECT_TRUE(line.starts_with("surface cells: ")) << line;
  EXPECT_CONTAINS(line, std::to_string(device.limits().maxTexelBufferElements));
}

}  // namespace
}  // namespace palpa
