// The pass itself: it stays inside its buffers, gives the same bytes every time, and keeps its promise about sines.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "array/drive.hpp"
#include "array/field/farthest.hpp"
#include "backends.hpp"
#include "base/error.hpp"
#include "gpu/barrier.hpp"
#include "pass_inputs.hpp"
#include "spirv/drive_sum_checked.comp.hpp"
#include "support/device.hpp"
#include "support/digest.hpp"
#include "support/thrown.hpp"
#include "support/watched_heap.hpp"

namespace palpa::array {
namespace {

DriveBatch batch_of(const PassInputs& inputs) {
  DriveBatch batch;
  batch.transducers = static_cast<std::uint32_t>(inputs.transducers.size());
  batch.slots = static_cast<std::uint32_t>(inputs.slots.size());
  batch.several = inputs.several;
  return batch;
}

/// Runs `record` on guarded buffers and returns the drives of all slots; fails if a guard word changed.
template <typename Record>
std::vector<shader::DriveOut> run_guarded(const PassInputs& inputs, const Record& record) {
  GuardedInputs guarded(inputs);
  test::run_on_device([&](VkCommandBuffer commands) {
    record(commands, guarded.bindings());
    gpu::compute_to_compute(commands);
  });
  EXPECT_TRUE(guarded.intact());
  return guarded.drives.read<shader::DriveOut>();
}

std::vector<shader::DriveOut> run_guarded(const PassInputs& inputs, const DriveBatch& batch) {
  const DrivePass pass(test::test_device());
  return run_guarded(
      inputs, [&](VkCommandBuffer commands, const DriveBindings& bindings) { pass.record(commands, bindings, batch); });
}

TEST(DrivePass, StaysInsideItsBuffersAtEverySize) {
  // Around the group sizes: 32 threads, 4 or 8 transducers each, 64 slots per group.
  for (const std::size_t transducers : {1u, 31u, 32u, 33u, 127u, 129u, 255u, 256u, 257u}) {
    for (const std::size_t slots : {1u, 2u, 63u, 64u, 65u, 129u}) {
      const Layout layout = rows_of(transducers);
      const auto batch = random_slots(slots, 3, static_cast<unsigned>(transducers * 1000 + slots));
      const PassInputs inputs(layout, batch);
      const auto drives = run_guarded(inputs, batch_of(inputs));
      for (std::size_t s = 0; s < slots; ++s) {
        const Drive twin = drive_for(layout, batch[s]);
        for (std::size_t t = 0; t < transducers; ++t) {
          const shader::DriveOut& out = drives[s * transducers + t];
          ASSERT_NEAR(out.amplitude, twin[t].amplitude, 1e-4) << transducers << " " << slots << " " << s << " " << t;
          ASSERT_LE(angle_between(out.phase, twin[t].phase) * twin[t].amplitude, 1e-4);
        }
      }
    }
  }
}

TEST(DrivePass, NoSineOutsideOfAQuarterTurn) {
  // drive_sum_checked is drive_sum, except that its sines return NaN outside their polynomial's range.
  auto batch = random_slots(40, 6, 11);
  // Places where wrapping is critical: a transducer at whole and half wavelengths, at the focus and far away.
  const double wavelength = 1 / Medium{}.turns_per_metre();
  const Layout layout = load_layout("openmpd");
  for (const double waves : {0.0, 0.25, 0.5, 0.75, 1.0, 10.5, 100.5, 1000.5}) {
    const Vec3 there = layout.transducers[3].position + Vec3(0, 0, waves * wavelength);
    batch.push_back({{there}, {there + Vec3(0, 0, 1e-9)}, {{0, 0, 0.1}}});
  }
  const PassInputs inputs(layout, batch);
  DriveBatch sums = batch_of(inputs);
  sums.single = false;
  const auto plain = run_guarded(inputs, sums);
  const gpu::ComputePipeline checked(test::test_device(), "drive_sum_checked", spirv::drive_sum_checked_comp,
                                     sizeof(shader::DrivePush));
  const shader::DrivePush push{sums.transducers, sums.slots, shader::drive_by_distance, shader::drive_normalise};
  const auto watched = run_guarded(inputs, [&](VkCommandBuffer commands, const DriveBindings& bindings) {
    checked.dispatch(commands, spirv::drive_sum_checked_buffers(bindings), push, sums.slots);
  });
  std::size_t summed = 0;
  for (std::size_t s = 0; s < batch.size(); ++s) {
    if (batch[s].size() < 2) continue;
    ++summed;
    const std::size_t begin = s * inputs.transducers.size();
    for (std::size_t i = begin; i < begin + inputs.transducers.size(); ++i) {
      ASSERT_EQ(plain[i].amplitude, watched[i].amplitude);
      ASSERT_EQ(plain[i].phase, watched[i].phase);
    }
  }
  EXPECT_GT(summed, 30u);
}

TEST(DrivePass, TheSameBytesOnEveryRun) {
  const Layout layout = load_layout("paper");
  const PassInputs inputs(layout, random_slots(70, 4, 5));
  const auto first = run_guarded(inputs, batch_of(inputs));
  for (int run = 0; run < 3; ++run) {
    const auto again = run_guarded(inputs, batch_of(inputs));
    ASSERT_EQ(std::memcmp(first.data(), again.data(), first.size() * sizeof(first[0])), 0);
  }
  test::Digest digest;
  for (const shader::DriveOut& out : first) {
    digest.add(out.amplitude);
    digest.add(out.phase);
  }
  test::tell_digest("drives", digest.value());
}

TEST(DriveMemory, AreReusedBatchAfterBatchWithoutAllocating) {
  gpu::Device& device = test::test_device();
  const Layout layout = load_layout("autd3");
  const DrivePasses passes(device, Solver::naive);
  DriveMemory buffers(device, layout, {}, 10, 20);
  std::uint64_t allocations = 0;
  for (unsigned frame = 0; frame < 4; ++frame) {
    const auto batch = random_slots(frame == 2 ? 3 : 10, 2, frame);
    buffers.clear();
    for (const auto& slot : batch)
      ASSERT_TRUE(buffers.add_slot(slot));
    test::run_on_device([&](VkCommandBuffer commands) { buffers.record(commands, passes); });
    buffers.solve_on_host();
    ASSERT_EQ(buffers.slots(), batch.size());
    for (std::uint32_t s = 0; s < buffers.slots(); ++s) {
      const Drive twin = drive_for(layout, batch[s]);
      for (std::size_t t = 0; t < twin.size(); ++t)
        ASSERT_NEAR(buffers.drive(s)[t].amplitude, twin[t].amplitude, 1e-4);
    }
    if (frame == 0) allocations = device.memory_allocations;
    EXPECT_EQ(device.memory_allocations, allocations);
  }
}

TEST(DriveMemory, ABatchDoesNotDependOnTheOneBefore) {
  gpu::Device& device = test::test_device();
  const Layout layout = load_layout("openmpd");
  const DriveOptions options = with(Solver::gs_pat);
  const DrivePasses passes(device, options.solver);
  const auto slots = random_slots(12, 4, 7);
  enum Kind { one_focus, solved, by_factors };
  const auto fill = [&](DriveMemory& memory, Kind kind) {
    memory.clear();
    for (const std::vector<SlotFocus>& slot : slots) {
      if (kind == by_factors) {
        const std::vector<std::complex<double>> factors(slot.size(), std::polar(0.2, 0.5));
        ASSERT_TRUE(memory.add_slot(slot, factors));
      } else {
        ASSERT_TRUE(memory.add_slot(kind == solved ? std::span(slot)
                                                   : std::span(slot).first(std::min<std::size_t>(1, slot.size()))));
      }
    }
    test::run_on_device([&](VkCommandBuffer commands) { memory.record(commands, passes); });
    memory.solve_on_host();
  };
  DriveMemory used(device, layout, options, 12, 48);
  for (const Kind kind : {by_factors, solved, one_focus, by_factors, one_focus, solved, by_factors}) {
    fill(used, kind);
    DriveMemory fresh(device, layout, options, 12, 48);
    fill(fresh, kind);
    for (std::uint32_t s = 0; s < used.slots(); ++s)
      ASSERT_TRUE(same(used.drive(s), fresh.drive(s))) << kind << ", slot " << s;
  }
}

TEST(DriveMemory, AFullBatchRefusesAndStaysAsItIs) {
  DriveMemory buffers(test::test_device(), load_layout("openmpd"), {}, 2, 3);
  const std::vector<SlotFocus> two(2), one(1);
  EXPECT_TRUE(buffers.add_slot(two));
  EXPECT_FALSE(buffers.add_slot(two));
  EXPECT_EQ(buffers.slots(), 1u);
  EXPECT_TRUE(buffers.add_slot(one));
  EXPECT_FALSE(buffers.add_slot({}));
  EXPECT_EQ(buffers.slots(), 2u);
  buffers.clear();
  EXPECT_TRUE(buffers.add_slot(two));
}

TEST(DriveMemory, MoreFociThanADevicesLoopsReachAreDrivenInFull) {
  gpu::Device& device = test::test_device();
  const Layout layout = load_layout("autd3");
  const DrivePasses passes(device, Solver::naive);
  std::vector<SlotFocus> crowd(33'000);  // two turns for each focus
  for (std::size_t j = 0; j < crowd.size(); ++j) {
    const double turn = static_cast<double>(j);
    crowd[j].position = {0.05 * std::cos(turn), 0.05 * std::sin(turn), 0.1 + 1e-6 * turn};
  }
  ASSERT_LT(most_pass_foci(249), crowd.size());
  EXPECT_EQ(most_pass_foci(3984), 2026u);
  EXPECT_EQ(most_pass_foci(65'000), 122u);
  const bool on_host = device.description().ends_long_loops;
  const std::vector<SlotFocus> few(crowd.begin(), crowd.begin() + 3);
  DriveMemory memory(device, layout, {}, 3, static_cast<std::uint32_t>(crowd.size()) + 6);
  for (int batch = 0; batch < 2; ++batch) {
    bool added = false;
    EXPECT_EQ(test::allocations_of([&] {
                memory.clear();
                added = memory.add_slot(few) && (batch > 0 || memory.add_slot(crowd)) && memory.add_slot(few);
              }),
              0u);
    ASSERT_TRUE(added);
    test::run_on_device([&](VkCommandBuffer commands) { memory.record(commands, passes); });
    memory.solve_on_host();
    const auto first = memory.drive(0);
    EXPECT_TRUE(same(first, memory.drive(memory.slots() - 1)));
    EXPECT_EQ(faults(Drive(first.begin(), first.end())), 0u);
    if (batch == 0 && on_host) {
      EXPECT_TRUE(same(memory.drive(1), drive_for(layout, crowd)));
    }
  }
}

TEST(DriveMemory, RefuseWhatTheDeviceCannotBind) {
  gpu::Device& device = test::test_device();
  const Layout layout = load_layout("paper");
  const std::uint32_t fitting = DriveMemory::fitting_slots(device, layout.transducers.size());
  EXPECT_GE(fitting, 4000u);
  EXPECT_LE(std::uint64_t{fitting} * layout.transducers.size() * sizeof(TransducerDrive),
            device.limits().maxStorageBufferRange);
  EXPECT_ERROR(DriveMemory(device, layout, {}, fitting + 1, 1), Exit::usage,
               std::to_string(fitting + 1) + " slots of " + std::to_string(layout.transducers.size()));
  EXPECT_EQ(DriveMemory::fitting_slots(device, 0), 65535u);
}

TEST(DriveMemory, AnEmptyBatchIsFine) {
  gpu::Device& device = test::test_device();
  const DrivePasses passes(device, Solver::naive);
  DriveMemory buffers(device, load_layout("openmpd"), {}, 0, 0);
  test::run_on_device([&](VkCommandBuffer commands) { buffers.record(commands, passes); });
  buffers.solve_on_host();
  EXPECT_EQ(buffers.slots(), 0u);
}

}  // namespace
}  // namespace palpa::array
