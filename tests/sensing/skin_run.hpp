// Scenes of random images, and one run of SkinPass over them.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <random>
#include <vector>

#include "gpu/barrier.hpp"
#include "random_rig.hpp"
#include "sensing/rays.hpp"
#include "sensing/skin_pass.hpp"
#include "sensing/skin_twin.hpp"
#include "sensing/surroundings.hpp"
#include "support/device.hpp"

namespace palpa::sensing::test_skin {

struct Scene {
  std::vector<Camera> cameras;
  std::vector<DepthFrame> frames;
};

inline Scene random_scene(std::mt19937_64& random, std::uint32_t cameras) {
  Scene scene;
  for (std::uint32_t i = 0; i < cameras; ++i) {
    scene.cameras.push_back(test::random_camera(random));
    scene.frames.push_back(test::random_frame(random, scene.cameras.back()));
  }
  return scene;
}

struct DeviceResult {
  std::vector<SkinPoint> points;
  shader::ScanTotal total{};
  Dropped dropped;
};

/// How a run differs from one of all pixels with enough room and without surroundings.
struct RunSetting {
  std::uint64_t room = ~0ull;
  std::uint32_t stride = 1;
  Surroundings surroundings{};
};

/// What a run looks at.
struct Plan {
  RayTables tables;
  std::vector<Crop> crops;
  std::vector<shader::SkinVolume> drops;

  Plan(const Scene& scene, const Box& box, const RunSetting& setting) : tables(make_rays(scene.cameras)) {
    plan_crops(scene.cameras, tables, box, crops);
    for (Crop& crop : crops)
      crop.stride = setting.stride;
    plan_drops(setting.surroundings, box, drops);
  }
};

/// One run of the twin, with what it left out.
inline SkinOfFrame run_twin(const Scene& scene, const Box& box, const RunSetting& setting = {}) {
  const Plan plan(scene, box, setting);
  SkinOfFrame found;
  found.wants_leavings = true;
  find_skin(plan.tables, scene.frames, box, plan.crops, plan.drops, found);
  return found;
}

/// One run of the pass; every buffer lies between guard words.
inline DeviceResult run_pass(const Scene& scene, const Box& box, const RunSetting& setting = {}) {
  using test::GuardedBuffer;
  gpu::Device& device = test::test_device();
  Plan plan(scene, box, setting);
  const RayTables& tables = plan.tables;
  std::vector<shader::SkinVolume>& drops = plan.drops;
  const std::size_t used = drops.size();
  // The kernel must keep to the ones that are used: this one would drop everything.
  shader::SkinVolume nowhere{};
  nowhere.x = nowhere.y = {1e30F, 1e30F, 1e30F, 0};
  nowhere.kind = shader::skin_room;
  drops.push_back(nowhere);

  std::vector<std::uint16_t> packed(tables.padded_pixels);
  pack_depth(tables, scene.frames, packed);
  auto depth = GuardedBuffer::of<std::uint16_t>(device, packed);
  auto rays = GuardedBuffer::of<glm::vec2>(device, tables.rays);
  auto volumes = GuardedBuffer::of<shader::SkinVolume>(device, drops);
  const std::vector<std::uint16_t> none(block_pixels);
  auto limits = GuardedBuffer::of<std::uint16_t>(device, tables.limits.empty() ? none : tables.limits);
  GuardedBuffer points(device, std::min(setting.room, tables.pixels) * sizeof(SkinPoint));
  GuardedBuffer total(device, sizeof(shader::ScanTotal));
  GuardedBuffer dropped(device, 4 * sizeof(std::uint32_t));

  const test::GuardedScratch scratch(device, SkinPass::scratch(tables));
  static SkinPass pass(device);
  pass.prepare(tables, used > 0);
  test::run_on_device([&](VkCommandBuffer commands) {
    pass.record(commands,
                {depth.ref(), rays.ref(), points.ref(), total.ref(), volumes.ref(), limits.ref(), dropped.ref()},
                scratch, tables, box, plan.crops, gpu::groups_of_64, nullptr, used);
    gpu::writes_to_transfer(commands);
  });
  for (GuardedBuffer* buffer : {&depth, &rays, &points, &total, &volumes, &limits, &dropped})
    EXPECT_TRUE(buffer->intact());
  EXPECT_TRUE(scratch.intact());

  DeviceResult result;
  result.total = total.read<shader::ScanTotal>()[0];
  result.points = points.read<SkinPoint>();
  std::ranges::copy(dropped.read<std::uint32_t>(), result.dropped.counts.begin());
  EXPECT_LE(result.total.total, result.points.size());
  result.points.resize(std::min<std::size_t>(result.total.total, result.points.size()));
  return result;
}

inline bool same_bytes(const std::vector<SkinPoint>& a, const std::vector<SkinPoint>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(SkinPoint)) == 0);
}

}  // namespace palpa::sensing::test_skin
