#include <gtest/gtest.h>

#include <numeric>
#include <random>
#include <utility>
#include <vector>

#include "gpu/barrier.hpp"
#include "gpu/scan_pass.hpp"
#include "spirv/scan.comp.hpp"
#include "support/device.hpp"
#include "support/spirv.hpp"

namespace palpa {
namespace {

using test::GuardedBuffer;

std::vector<std::uint32_t> random_counts(std::size_t size) {
  std::mt19937 random(static_cast<unsigned>(size));
  std::vector<std::uint32_t> counts(size);
  for (auto& count : counts)
    count = random() % 257;
  return counts;
}

struct Scanned {
  std::vector<std::uint32_t> offsets;
  shader::ScanTotal total;
  bool intact;
};

/// `most_total` and `cut` as of ScanPass::Sizes.
Scanned scan_on_device(const std::vector<std::uint32_t>& counts, std::uint32_t most_total = 0xffffffffU,
                       const shader::ScanGroups& cut = gpu::groups_of_64) {
  gpu::Device& device = test::test_device();
  const gpu::ScanPass pass(device);
  auto given = GuardedBuffer::of<std::uint32_t>(device, counts);
  GuardedBuffer offsets(device, counts.size() * sizeof(std::uint32_t));
  GuardedBuffer total(device, sizeof(shader::ScanTotal));
  test::run_on_device([&](VkCommandBuffer commands) {
    pass.record(commands, {given.ref(), offsets.ref(), total.ref()},
                {static_cast<std::uint32_t>(counts.size()), most_total, cut});
    gpu::compute_to_compute(commands);
  });
  return {offsets.read<std::uint32_t>(), total.read<shader::ScanTotal>()[0],
          given.intact() && offsets.intact() && total.intact()};
}

TEST(Scan, AgreesWithStdExclusiveScan) {
  for (const std::size_t size : {1u, 2u, 255u, 256u, 257u, 1000u, 4783u, 65536u}) {
    const auto counts = random_counts(size);
    const std::uint32_t sum = std::accumulate(counts.begin(), counts.end(), 0u);
    std::vector<std::uint32_t> expected(size);
    std::exclusive_scan(counts.begin(), counts.end(), expected.begin(), 0u);

    const Scanned scanned = scan_on_device(counts);
    EXPECT_EQ(scanned.offsets, expected) << size;
    EXPECT_EQ(scanned.total.total, sum);
    EXPECT_EQ(scanned.total.groups_x, (sum + 63) / 64);
    EXPECT_EQ(scanned.total.groups_y, 1u);
    EXPECT_EQ(scanned.total.groups_z, 1u);
    EXPECT_TRUE(scanned.intact) << size;
  }
}

TEST(Scan, ClampsTheTotal) {
  const Scanned scanned = scan_on_device({5, 6, 7}, 10);
  EXPECT_EQ(scanned.total.total, 10u);
  EXPECT_EQ(scanned.offsets, (std::vector<std::uint32_t>{0, 5, 11}));
}

TEST(Scan, CutsTheTotalUpAsAsked) {
  const shader::ScanGroups cut{100, 8, 20, 4};
  const std::vector<std::pair<std::uint32_t, std::uint32_t>> groups_of{{0, 8},     {1, 8},     {800, 8},     {801, 12},
                                                                       {1200, 12}, {1201, 16}, {100'000, 20}};
  for (const auto& [items, groups] : groups_of)
    EXPECT_EQ(scan_on_device({items}, 0xffffffffU, cut).total.groups_x, groups) << items;
}

// The pass itself never gets this many. Drivers differ in this from version to version, so each is tested here, and
// DeviceDescription must agree.
TEST(Scan, ADeviceEndsLoopsAfterSoManyTurnsOnlyWhereItsDescriptionSaysSo) {
  const auto total = [](std::uint32_t turns) {
    return scan_on_device(std::vector<std::uint32_t>(turns * shader::scan_group, 1)).total.total;
  };
  EXPECT_EQ(total(65'000), 65'000 * shader::scan_group);
  const bool ends = total(66'000) < 66'000 * shader::scan_group;
  EXPECT_EQ(ends, test::test_device().description().ends_long_loops);
}

TEST(Scan, LayoutIsWhatTheShaderHas) {
  const test::SpirvModule module = test::read_spirv(spirv::scan_comp);
  EXPECT_EQ(module.local_size[0], shader::scan_group);
  EXPECT_EQ(module.structs.at("ScanTotal").offsets.at("groups_x"), offsetof(shader::ScanTotal, groups_x));
  EXPECT_EQ(module.structs.at("ScanPush").offsets.at("groups"), offsetof(shader::ScanPush, groups));
  EXPECT_EQ(module.structs.at("ScanGroups").offsets.at("step"), offsetof(shader::ScanGroups, step));
}

}  // namespace
}  // namespace palpa
