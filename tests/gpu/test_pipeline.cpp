// What a pipeline refuses in every build, before it gets to the driver.
#include "gpu/pipeline.hpp"

#include <gtest/gtest.h>

#include <array>
#include <string>

#include "base/error.hpp"
#include "shaders/shared/scan.h"
#include "spirv/scan.comp.hpp"
#include "support/device.hpp"
#include "support/thrown.hpp"

namespace palpa::gpu {
namespace {

std::string refusal(const std::function<void(VkCommandBuffer)>& record) {
  const Recorder recorder(test::test_device(), "refused");
  const VkCommandBuffer commands = recorder.begin();
  std::string line = test::thrown_by([&] { record(commands); }).what();
  recorder.end();
  return line;
}

TEST(ComputePipeline, RefusesPushConstantsOfAnotherSize) {
  Device& device = test::test_device();
  const ComputePipeline scan(device, "scan", spirv::scan_comp, {shader::scan_buffers, sizeof(shader::ScanPush)});
  const Buffer words(device, 64, "words");
  const auto dispatch = [&](const Push& push) {
    return refusal([&](VkCommandBuffer commands) {
      scan.dispatch(commands, {words.ref(), words.ref(), words.ref()}, push, 1);
    });
  };
  EXPECT_EQ(dispatch(shader::ScanPush{}), "");
  EXPECT_EQ(dispatch(std::array<shader::vec4, 2>{}), "");  // as large
  struct Half {
    std::uint32_t a, b;
  };
  EXPECT_EQ(dispatch(Half{}), "pipeline 'scan' was given 8 bytes of push constants: its shader has 32");
  EXPECT_EQ(dispatch(Push::none()), "pipeline 'scan' was given 0 bytes of push constants: its shader has 32");
}

TEST(ComputePipeline, RefusesAnotherNumberOfBuffers) {
  Device& device = test::test_device();
  const ComputePipeline scan(device, "scan", spirv::scan_comp, {shader::scan_buffers, sizeof(shader::ScanPush)});
  const Buffer words(device, 64, "words");
  const auto dispatch = [&](std::initializer_list<BufferRef> buffers) {
    return refusal([&](VkCommandBuffer commands) { scan.dispatch(commands, buffers, shader::ScanPush{}, 1); });
  };
  const BufferRef ref = words.ref();
  EXPECT_EQ(dispatch({ref, ref, ref}), "");
  EXPECT_EQ(dispatch({ref, ref}), "pipeline 'scan' was given 2 buffers: its shader binds 3");
  EXPECT_EQ(dispatch({ref, ref, ref, ref}), "pipeline 'scan' was given 4 buffers: its shader binds 3");
  EXPECT_EQ(dispatch({ref, {}, ref}), "pipeline 'scan' was given no buffer at binding 1");
}

TEST(ComputePipeline, CannotBeDispatchedBeforeItIsMade) {
  const ComputePipeline none;
  EXPECT_FALSE(none);
  EXPECT_NE(refusal([&](VkCommandBuffer commands) { none.dispatch(commands, {}, Push::none(), 1); }), "");
  EXPECT_EQ(refusal([&](VkCommandBuffer commands) { none.dispatch(commands, {}, Push::none(), 0); }), "");
}

}  // namespace
}  // namespace palpa::gpu
