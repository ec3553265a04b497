// BridgePass by itself, between guard words; and the structs that its shaders share with C++.
#include <gtest/gtest.h>

#include "shaders/touch/contacts/contacts.h"
#include "shaders/touch/fingers/fingers.h"
#include "spirv/bridge_join.comp.hpp"
#include "spirv/bridge_pairs.comp.hpp"
#include "spirv/bridge_relabel.comp.hpp"
#include "spirv/bridge_sample.comp.hpp"
#include "support/device.hpp"
#include "support/spirv.hpp"
#include "touch/bridge/bridge_cameras.hpp"
#include "touch/bridge/bridge_pass.hpp"
#include "touch/fingers/guarded_fingers.hpp"
#include "touch/fingertips.hpp"
#include "touch/harness.hpp"

namespace palpa::touch::test {
namespace {

TEST(BridgePassByItself, StaysInsideItsBuffers) {
  gpu::Device& device = palpa::test::test_device();
  const BridgePass pass(device);
  const std::vector<geometry::Solid> plate{box({-0.1, -0.05, -0.1}, {0.1, 0, 0.1}, "plate")};
  for (const int fingers : {1, 2, 9}) {
    const auto cameras = ring_of_cameras(2, 20, 20);
    std::vector<Press> presses;
    for (int i = 0; i < fingers; ++i)
      presses.push_back({.press_m = 4e-3, .x = 30e-3 * (i % 3 - 1), .z = 30e-3 * (i / 3)});
    const auto images = images_of(cameras, presses, 3);
    const auto tables = sensing::make_rays(cameras);
    Touch twin;
    HostStage(plate, cameras, {.parameters = {.finger_width_m = 0}}).touch(images, twin);
    ASSERT_GE(twin.finger_count, static_cast<std::uint32_t>(fingers));
    GuardedFingers guarded(device, cameras, tables, images, twin, BridgePass::scratch());
    const auto count = static_cast<std::uint32_t>(twin.contacts.size());
    const Room room{.points = count, .contacts = count};
    palpa::test::run_on_device([&](VkCommandBuffer commands) {
      pass.record(commands, guarded.bindings<BridgeBindings>(), guarded.scratch, room, Parameters{}, {});
    });
    EXPECT_TRUE(guarded.intact());

    const auto records = bridge_cameras(cameras, tables);
    bridge_fingers({records, tables, images}, {}, {}, twin);
    const auto header = guarded.header.read<shader::TouchHeader>()[0];
    ASSERT_EQ(header.fingers, twin.finger_count);
    EXPECT_EQ(header.clusters, twin.cluster_count);
    const auto list = guarded.fingers.read<shader::FingerRecord>();
    const auto roots = guarded.parents.read<std::uint32_t>();
    for (std::uint32_t f = 0; f < twin.finger_count; ++f) {
      EXPECT_EQ(list[f].first, twin.fingers[f].contacts.front());
      EXPECT_EQ(list[f].contacts, twin.fingers[f].contacts.size());
      for (const std::uint32_t i : twin.fingers[f].contacts)
        EXPECT_EQ(roots[i], roots[list[f].first]);
    }
  }
}

void expect_struct(const palpa::test::SpirvModule& module, const std::string& name, std::uint32_t size,
                   const std::map<std::string, std::uint32_t>& offsets) {
  const auto found = module.structs.find(name);
  ASSERT_NE(found, module.structs.end()) << name;
  for (const auto& [member, offset] : offsets) {
    ASSERT_TRUE(found->second.offsets.count(member)) << name << "." << member;
    EXPECT_EQ(found->second.offsets.at(member), offset) << name << "." << member;
  }
  if (size != 0) {
    EXPECT_EQ(module.array_strides.at(name), size) << name;
  }
}

#define MEMBER(type, member) \
  { #member, static_cast < std::uint32_t>(offsetof(shader::type, member)) }

TEST(BridgeShaders, LayOutTheirStructsAsCppDoes) {
  const auto sample = palpa::test::read_spirv(spirv::bridge_sample_comp);
  expect_struct(sample, "BridgeCamera", sizeof(shader::BridgeCamera),
                {MEMBER(BridgeCamera, pose_x), MEMBER(BridgeCamera, view_x), MEMBER(BridgeCamera, lens),
                 MEMBER(BridgeCamera, distortion), MEMBER(BridgeCamera, k3), MEMBER(BridgeCamera, reach),
                 MEMBER(BridgeCamera, depth_unit), MEMBER(BridgeCamera, first_depth), MEMBER(BridgeCamera, width),
                 MEMBER(BridgeCamera, height), MEMBER(BridgeCamera, pitch), MEMBER(BridgeCamera, first_pixel),
                 MEMBER(BridgeCamera, first_index)});
  expect_struct(sample, "BridgeSample", sizeof(shader::BridgeSample),
                {MEMBER(BridgeSample, x), MEMBER(BridgeSample, normal_x), MEMBER(BridgeSample, normal_z)});
  expect_struct(
      sample, "BridgePatch", sizeof(shader::BridgePatch),
      {MEMBER(BridgePatch, low), MEMBER(BridgePatch, high), MEMBER(BridgePatch, mean), MEMBER(BridgePatch, samples)});
  expect_struct(sample, "BridgePush", 0,
                {MEMBER(BridgePush, most_contacts), MEMBER(BridgePush, cameras), MEMBER(BridgePush, finger_width)});
  const auto join = palpa::test::read_spirv(spirv::bridge_join_comp);
  expect_struct(join, "BridgePair", sizeof(shader::BridgePair), {MEMBER(BridgePair, kind), MEMBER(BridgePair, facing)});
}

TEST(BridgeShaders, HaveTheWorkgroupsThatTheirHeadersName) {
  for (const gpu::Kernel* kernel : {&spirv::bridge_sample_comp, &spirv::bridge_pairs_comp, &spirv::bridge_join_comp}) {
    EXPECT_EQ(palpa::test::read_spirv(*kernel).local_size[0], shader::bridge_group) << kernel->name;
  }
  EXPECT_EQ(palpa::test::read_spirv(spirv::bridge_relabel_comp).local_size[0], shader::contact_group);
}

}  // namespace
}  // namespace palpa::touch::test
