// Depth frames to drives through the whole chain, on the device and through the twins.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <new>

#include "array/board_mesh.hpp"
#include "base/error.hpp"
#include "geometry/gltf.hpp"
#include "geometry/ply.hpp"
#include "sensing/rig.hpp"
#include "sensing/synthetic.hpp"
#include "session/chain.hpp"
#include "support/device.hpp"
#include "support/shared_data.hpp"

namespace {

// Counts what the thread under test allocates while it is watched.
thread_local bool watching = false;
thread_local std::size_t allocations = 0;

}  // namespace

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define PALPA_WATCH_HEAP 1
// Not inlined: a compiler that sees only one half of a pair takes malloc and delete for a mismatch.
[[gnu::noinline]] void* operator new(std::size_t size) {
  if (watching) ++allocations;
  if (void* memory = std::malloc(size ? size : 1)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept {
  std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}
#endif

namespace palpa::session {
namespace {

struct Stage {
  sensing::Rig rig = sensing::load_rig(test::source_file("assets/rigs/paper.toml"));
  array::Layout layout = array::load_layout("paper");
  geometry::Mesh boards = array::board_mesh(layout);
  geometry::Mesh finger;
  std::vector<geometry::Solid> solids;

  explicit Stage(const std::string& object) {
    geometry::Ply ply = geometry::read_ply(test::source_file("assets/finger.ply"));
    finger = {std::move(ply.positions), std::move(ply.triangles)};
    solids = geometry::make_solids(geometry::load_gltf(test::source_file("assets/" + object + ".glb")));
  }
  ChainSetting setting() const { return {.cameras = rig.cameras, .solids = solids, .layout = layout}; }
  sensing::FrameSet frame(double depth_m, std::uint64_t sequence, sensing::Noise noise = sensing::Noise::d415,
                          std::uint64_t seed = 1) const {
    sensing::SyntheticRig synthetic(rig.cameras, boards, noise, seed);
    Transform T(1.0);
    T[3] = Vec4(0, -depth_m, 0, 1);
    const sensing::Posed skin{&finger, T};
    sensing::FrameSet set;
    synthetic.render(std::span(&skin, 1), sequence, set);
    set.sequence = sequence;
    set.time_s = 0.011 * static_cast<double>(sequence);
    return set;
  }
};

FrameReport run_frame(Chain& chain, const sensing::FrameSet& frame, Plan& plan) {
  FrameReport report;
  EXPECT_TRUE(chain.can_start());
  chain.start(frame, 0, 0);
  while (!chain.step(plan, report)) {
  }
  return report;
}

double mean_radius(const Plan& plan) {
  const auto& foci = plan.schedule.voices.at(0).foci;
  Vec3 centre(0);
  for (const Vec3& p : foci)
    centre += p / static_cast<double>(foci.size());
  double sum = 0;
  for (const Vec3& p : foci)
    sum += glm::distance(p, centre) / static_cast<double>(foci.size());
  return sum;
}

TEST(Chain, DeviceAndTwinMakeTheSameDrives) {
  for (const char* object : {"cube", "semi-sphere", "pyramid", "prism"}) {
    const Stage stage(object);
    const auto frame = stage.frame(0.003, 0, sensing::Noise::none);
    const auto on_gpu = make_gpu_chain(test::test_device(), stage.setting());
    const auto on_cpu = make_cpu_chain(stage.setting());
    Plan a, b;
    run_frame(*on_gpu, frame, a);
    run_frame(*on_cpu, frame, b);
    ASSERT_EQ(b.schedule.voice_count, 1u) << object;
    ASSERT_EQ(a.schedule.voice_count, 1u) << object;
    ASSERT_EQ(a.cycle, b.cycle);
    ASSERT_EQ(a.drives.size(), b.drives.size());
    for (std::size_t i = 0; i < a.schedule.voices[0].foci.size(); ++i) {
      EXPECT_LT(glm::distance(a.schedule.voices[0].foci[i], b.schedule.voices[0].foci[i]), 1e-6) << object;
    }
    double worst = 0;
    for (std::size_t i = 0; i < a.drives.size(); ++i) {
      worst = std::max(worst, std::abs(std::remainder(a.drives[i].phase - b.drives[i].phase, 2 * M_PI)));
      ASSERT_NEAR(a.drives[i].amplitude, b.drives[i].amplitude, 1e-4);
    }
    EXPECT_LT(worst, 2e-3) << object;  // a micrometre of focus is 0.7 mrad
  }
}

TEST(Chain, TheSensorsNoiseMovesTheFociLittle) {
  const Stage stage("cube");
  const auto chain = make_gpu_chain(test::test_device(), stage.setting());
  Plan plan;
  run_frame(*chain, stage.frame(0.003, 0, sensing::Noise::none), plan);
  ASSERT_EQ(plan.schedule.voice_count, 1u);
  const double clean = mean_radius(plan);
  double worst = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    run_frame(*chain, stage.frame(0.003, seed, sensing::Noise::d415, seed), plan);
    ASSERT_GE(plan.schedule.voice_count, 1u) << "seed " << seed;
    worst = std::max(worst, std::abs(mean_radius(plan) - clean));
  }
  std::printf("mean radius %.3f mm without noise; at most %.3f mm off with it\n", clean * 1e3, worst * 1e3);
  EXPECT_LT(worst, 0.3e-3);
}

TEST(Chain, FramesInFlightDoNotMix) {
  const Stage stage("cube");
  const auto frames = {stage.frame(0.003, 0), stage.frame(0.0, 1), stage.frame(0.002, 2), stage.frame(0.004, 3)};
  std::vector<Plan> alone;
  const auto one_by_one = make_gpu_chain(test::test_device(), stage.setting());
  for (const auto& frame : frames)
    run_frame(*one_by_one, frame, alone.emplace_back());
  const auto chain = make_gpu_chain(test::test_device(), stage.setting());
  std::vector<Plan> together;
  auto next = frames.begin();
  while (together.size() < frames.size()) {
    while (next != frames.end() && chain->can_start())
      chain->start(*next++, 0, 0);
    FrameReport report;
    Plan plan;
    if (!chain->step(plan, report)) continue;
    EXPECT_EQ(report.sequence, together.size());
    together.push_back(plan);
  }
  for (std::size_t f = 0; f < alone.size(); ++f) {
    ASSERT_EQ(together[f].drives.size(), alone[f].drives.size());
    for (std::size_t i = 0; i < alone[f].drives.size(); ++i) {
      ASSERT_EQ(together[f].drives[i].phase, alone[f].drives[i].phase);
      ASSERT_EQ(together[f].drives[i].amplitude, alone[f].drives[i].amplitude);
    }
  }
}

TEST(Chain, AnEmptyFrameIsSilence) {
  const Stage stage("cube");
  sensing::FrameSet empty;
  for (const auto& camera : stage.rig.cameras) {
    empty.frames.push_back({std::vector<std::uint16_t>(camera.width * camera.height), 0});
  }
  for (const auto& chain : {make_gpu_chain(test::test_device(), stage.setting()), make_cpu_chain(stage.setting())}) {
    Plan plan;
    run_frame(*chain, empty, plan);
    EXPECT_EQ(plan.schedule.voice_count, 0u);
    EXPECT_TRUE(plan.drives.empty());
  }
}

TEST(Chain, NothingIsAllocatedAndNoPipelineMadeAfterTheFirstFrames) {
  const Stage stage("cube");
  gpu::Device& device = test::test_device();
  const auto chain = make_gpu_chain(device, stage.setting());
  std::vector<sensing::FrameSet> frames;
  for (std::uint64_t i = 0; i < 8; ++i)
    frames.push_back(stage.frame(0.003 - 1e-4 * static_cast<double>(i), i));
  Plan plan;
  reserve(plan, stage.layout.transducers.size());
  run_frame(*chain, frames[0], plan);
  const std::uint64_t memory = device.memory_allocations, pipelines = device.pipelines_created;
  allocations = 0;
  watching = true;
  for (const auto& frame : frames)
    run_frame(*chain, frame, plan);
  watching = false;
  EXPECT_EQ(device.memory_allocations, memory);
  EXPECT_EQ(device.pipelines_created, pipelines);
#ifdef PALPA_WATCH_HEAP
  // The validation layer allocates on this thread.
  if (device.validation() == gpu::Validation::off) {
    EXPECT_EQ(allocations, 0u) << "heap allocations in eight frames";
  }
#endif
}

TEST(Chain, MayBeDestroyedWithFramesUnderWay) {
  const Stage stage("cube");
  const auto frame = stage.frame(0.003, 0);
  for (const int steps : {0, 1}) {
    const auto chain = make_gpu_chain(test::test_device(), stage.setting());
    chain->start(frame, 0, 0);
    Plan plan;
    FrameReport report;
    for (int i = 0; i < steps; ++i)
      chain->step(plan, report);
  }
}

TEST(Chain, ALostDeviceIsAnError) {
  const Stage stage("cube");
  const gpu::Device device;
  const auto chain = make_gpu_chain(device, stage.setting());
  Plan plan;
  run_frame(*chain, stage.frame(0.003, 0), plan);
  device.lose();
  EXPECT_THROW(chain->start(stage.frame(0.003, 1), 0, 0), Error);
}

}  // namespace
}  // namespace palpa::session
