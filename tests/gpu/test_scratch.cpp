#include "gpu/scratch.hpp"

#include <gtest/gtest.h>

#include "gpu/barrier.hpp"
#include "support/device.hpp"
#include "support/thrown.hpp"

namespace palpa::gpu {
namespace {

TEST(Scratch, GivesEachPieceItsBytesAndNoOthers) {
  Device& device = test::test_device();
  const VkDeviceSize step = device.limits().minStorageBufferOffsetAlignment;
  for (const VkDeviceSize margin : {0, 100}) {
    const Scratch scratch(device, {{"a", 1}, {"b", 0}, {"c", 1000}, {"d", 17}}, "pieces", margin);
    const std::vector<VkDeviceSize> sizes{4, 4, 1000, 20};
    VkDeviceSize end = 0;
    for (std::size_t piece = 0; piece < sizes.size(); ++piece) {
      const BufferRef ref = scratch[piece];
      EXPECT_EQ(ref.size, sizes[piece]);
      EXPECT_EQ(scratch.pieces()[piece].bytes, sizes[piece]);
      EXPECT_EQ(ref.buffer, scratch.whole().buffer);
      EXPECT_EQ(ref.offset % step, 0U);
      EXPECT_GE(ref.offset, end + margin);
      end = ref.offset + ref.size;
    }
    EXPECT_GE(scratch.whole().size, end + margin);
  }
}

TEST(Scratch, RefusesAPieceThatNoBindingTakes) {
  Device& device = test::test_device();
  const VkDeviceSize most = device.limits().maxStorageBufferRange;
  if (most > VkDeviceSize{1} << 31) GTEST_SKIP() << "skipped: the device binds " << most << " bytes at once";
  EXPECT_CONTAINS(test::thrown_by([&] {
                    Scratch(device, {{"a", 4}, {"vast", most + 4}}, "pieces");
                  }).what(),
                  "of vast exceed the " + std::to_string(most));
}

TEST(GuardedScratch, SeesAByteBeyondAPiece) {
  Device& device = test::test_device();
  const test::GuardedScratch guarded(device, {{"a", 20}, {"b", 8}});
  const Scratch& scratch = guarded;
  const auto write = [&](VkDeviceSize at, VkDeviceSize bytes) {
    test::run_on_device([&](VkCommandBuffer commands) {
      vkCmdFillBuffer(commands, scratch.whole().buffer, at, bytes, 0x12345678);
      transfer_to_use(commands);
    });
  };
  write(scratch[0].offset, 20);
  write(scratch[1].offset, 8);
  EXPECT_TRUE(guarded.intact());
  write(scratch[0].offset + 20, 4);
  EXPECT_FALSE(guarded.intact());
}

}  // namespace
}  // namespace palpa::gpu
