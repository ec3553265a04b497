// Errors that a pipeline reports in every build, before it calls the driver.
#include "gpu/pipeline.hpp"

#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "gpu/barrier.hpp"
#include "gpu/scan_pass.hpp"
#include "shaders/shared/scan.h"
#include "spirv/scan.comp.hpp"
#include "support/barriers.hpp"
#include "support/device.hpp"
#include "support/spirv.hpp"
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
  const ComputePipeline scan(device, "scan", spirv::scan_comp, sizeof(shader::ScanPush));
  const Buffer words(device, 64, "words");
  const auto dispatch = [&](const Push& push) {
    return refusal([&](VkCommandBuffer commands) {
      scan.dispatch(commands, spirv::scan_buffers(ScanBindings{words.ref(), words.ref(), words.ref()}), push, 1);
    });
  };
  EXPECT_EQ(dispatch(shader::ScanPush{}), "");
  EXPECT_EQ(dispatch(std::array<std::uint32_t, 6>{}), "");  // of the same size
  struct Half {
    std::uint32_t a, b;
  };
  EXPECT_EQ(dispatch(Half{}), "pipeline 'scan' was given 8 bytes of push constants: its shader has 24");
  EXPECT_EQ(dispatch(Push::none()), "pipeline 'scan' was given 0 bytes of push constants: its shader has 24");
}

TEST(ComputePipeline, RefusesTheBuffersOfAnotherKernelAndMissingOnes) {
  Device& device = test::test_device();
  const ComputePipeline scan(device, "scan", spirv::scan_comp, sizeof(shader::ScanPush));
  const Buffer words(device, 64, "words");
  const auto dispatch = [&](const KernelBuffers& buffers) {
    return refusal([&](VkCommandBuffer commands) { scan.dispatch(commands, buffers, shader::ScanPush{}, 1); });
  };
  const BufferRef ref = words.ref();
  KernelBuffers buffers = spirv::scan_buffers(ScanBindings{ref, ref, ref});
  EXPECT_EQ(dispatch(buffers), "");
  EXPECT_EQ(dispatch(spirv::scan_buffers(ScanBindings{ref, {}, ref})),
            "pipeline 'scan' was given no buffer as 'offsets'");
  const Kernel other{"other", spirv::scan_comp.words, spirv::scan_comp.bindings};
  buffers.kernel = &other;
  EXPECT_EQ(dispatch(buffers), "pipeline 'scan' was given the buffers of kernel 'other': its own is 'scan'");
  EXPECT_EQ(dispatch({}), "pipeline 'scan' was given the buffers of kernel '': its own is 'scan'");
}

TEST(ComputePipeline, IsMadeOnceOnADeviceThatKeepsPipelines) {
  const Device device({.keep_pipelines = true});
  const auto make = [&](std::vector<std::uint32_t> constants) {
    EXPECT_TRUE(ComputePipeline(device, "scan", spirv::scan_comp, sizeof(shader::ScanPush), constants));
    return device.pipelines_created.load();
  };
  EXPECT_EQ(make({}), 1u);
  EXPECT_EQ(make({}), 1u);
  EXPECT_EQ(make({7}), 2u) << "other constants";
  EXPECT_EQ(make({7}), 2u);
  const Device other;
  for (int i = 0; i < 2; ++i)
    ComputePipeline(other, "scan", spirv::scan_comp, sizeof(shader::ScanPush));
  EXPECT_EQ(other.pipelines_created, 2u);
}

// In any order in a pass's struct: each buffer gets the number of the shader's binding with that name.
TEST(Kernel, BindsBuffersByTheNamesThatTheShaderGivesThem) {
  const struct { BufferRef total, counts, more, offsets; } from{{.size = 1}, {.size = 2}, {.size = 3}, {.size = 4}};
  const KernelBuffers buffers = spirv::scan_buffers(from);
  EXPECT_EQ(buffers.kernel, &spirv::scan_comp);
  const test::SpirvModule module = test::read_spirv(spirv::scan_comp.words);
  ASSERT_EQ(module.bindings.size(), 3u);
  for (const auto& [number, name, texels] : module.bindings) {
    const VkDeviceSize expected = name == "Total" ? 1 : name == "Counts" ? 2 : 4;
    EXPECT_EQ(buffers.refs[number].size, expected) << name;
  }
}

// The layout tests of all kernels rely on this.
TEST(Kernel, ATableThatIsNotTheModulesIsNoticed) {
  const auto read = [](const std::vector<KernelBinding>& bindings) {
    test::read_spirv(Kernel{"scan", spirv::scan_comp.words, bindings});
  };
  EXPECT_NO_THROW(read({{"counts"}, {"offsets"}, {"total"}}));
  EXPECT_THROW(read({{"offsets"}, {"counts"}, {"total"}}), std::runtime_error);
  EXPECT_THROW(read({{"counts"}, {"offsets"}, {"total", true}}), std::runtime_error);
  EXPECT_THROW(read({{"counts"}, {"offsets"}}), std::runtime_error);
  EXPECT_THROW(read({{"counts"}, {"offsets"}, {"total"}, {"more"}}), std::runtime_error);
}

TEST(MissingBarriers, WhatAKernelReadsAndWritesComesFromItsSpirv) {
  const std::vector<test::Access> expected{{.reads = true}, {.writes = true}, {.writes = true}};
  EXPECT_EQ(test::accesses_of(spirv::scan_comp), expected) << "counts, offsets, total";
}

TEST(MissingBarriers, AreRefusedWithTheNamesOfBothKernels) {
  Device& device = test::test_device();
  const ComputePipeline scan(device, "scan", spirv::scan_comp, sizeof(shader::ScanPush));
  const Buffer a(device, 64, "a"), b(device, 64, "b"), total(device, 64, "total");
  const auto twice = [&](const BufferRef& counts, void (*between)(VkCommandBuffer)) {
    return refusal([&](VkCommandBuffer commands) {
      scan.dispatch(commands, spirv::scan_buffers(ScanBindings{a.ref(), b.ref(), total.ref()}), shader::ScanPush{}, 1);
      if (between) between(commands);
      scan.dispatch(commands, spirv::scan_buffers(ScanBindings{counts, b.ref(), total.ref()}), shader::ScanPush{}, 1);
    });
  };
  EXPECT_EQ(twice(a.ref(), nullptr), "") << "reads what the other reads, and writes as it does";
  EXPECT_EQ(twice(b.ref(), nullptr),
            "scan reads 'counts', which scan wrote as 'offsets', without a barrier between them");
  EXPECT_EQ(twice(b.ref(), compute_to_compute), "");
  EXPECT_NE(twice(b.ref(), writes_to_transfer), "") << "the dispatch does not wait";
  EXPECT_NE(twice(b.ref(), writes_to_host), "");
  const BufferRef rest{a.ref().buffer, 32, 32};
  const BufferRef half{b.ref().buffer, 0, 32};
  EXPECT_NE(twice(half, nullptr), "") << "a part of the same buffer";
  EXPECT_EQ(twice(rest, nullptr), "");
}

TEST(ComputePipeline, CannotBeDispatchedBeforeItIsMade) {
  const ComputePipeline none;
  EXPECT_FALSE(none);
  EXPECT_NE(refusal([&](VkCommandBuffer commands) { none.dispatch(commands, {}, Push::none(), 1); }), "");
  EXPECT_EQ(refusal([&](VkCommandBuffer commands) { none.dispatch(commands, {}, Push::none(), 0); }), "");
}

}  // namespace
}  // namespace palpa::gpu
