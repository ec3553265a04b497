// From depth frames to drives through a planner, on the device and with the twins.
#include <gtest/gtest.h>
#include <sched.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>

#include "array/layouts/board_mesh.hpp"
#include "base/error.hpp"
#include "sensing/synthetic.hpp"
#include "session/plan/planner.hpp"
#include "support/thrown.hpp"
#include "support/watched_heap.hpp"
#include "touched_scene.hpp"

namespace palpa::session {
namespace {

/// A live setting, and frames for it.
struct Scene {
  SessionSetting setting;

  explicit Scene(const std::string& object) {
    setting.scene = object;
    setting.solids = test::asset_solids(object);
    setting.cameras = test::paper_cameras();
    setting.layout = array::load_layout("paper");
    setting.events.reset();
  }
  /// The rig and its static background, which all scenes have in common, are prepared once per noise.
  sensing::SyntheticRig& rig(sensing::Noise noise) const {
    static std::map<sensing::Noise, sensing::SyntheticRig> rigs;
    return rigs.try_emplace(noise, setting.cameras, array::board_mesh(setting.layout), noise, 1).first->second;
  }
  /// The noise differs for each sequence number.
  sensing::FrameSet frame(double depth_m, std::uint64_t sequence, sensing::Noise noise = sensing::Noise::d415) const {
    Transform T(1.0);
    T[3] = Vec4(0, -depth_m, 0, 1);
    const sensing::Posed skin{&test::finger_skin().mesh, T};
    sensing::FrameSet set;
    rig(noise).render(std::span(&skin, 1), sequence, set);
    set.sequence = sequence;
    set.time_s = 0.011 * static_cast<double>(sequence);
    return set;
  }
};

/// A planner, and the objects with which it schedules.
struct Planning {
  Scheduler scheduler;
  std::unique_ptr<Planner> planner;

  Planning(const Scene& scene, const gpu::Device* device = &test::test_device())
      : scheduler(scene.setting.scene, scene.setting.solids, scene.setting.touch, scene.setting.schedule),
        planner(make_planner(device, scene.setting, scheduler)) {}
  Planner* operator->() const { return planner.get(); }
};

SkinFrame seen(const sensing::FrameSet& frame) {
  return {.images = frame.frames, .sequence = frame.sequence, .time_s = frame.time_s};
}

FrameReport run_frame(const Planning& planning, const sensing::FrameSet& frame, Plan& plan) {
  FrameReport report;
  EXPECT_TRUE(planning->can_start());
  planning->start(seen(frame));
  while (!planning->step(plan, report)) {
  }
  return report;
}

TEST(Planner, DeviceAndTwinMakeTheSameDrives) {
  // The objects with the most faces and with slanted ones.
  for (const char* object : {"semi-sphere", "pyramid"}) {
    const Scene scene(object);
    const auto frame = scene.frame(0.003, 0, sensing::Noise::none);
    const Planning on_gpu(scene);
    const Planning on_cpu(scene, nullptr);
    Plan a, b;
    run_frame(on_gpu, frame, a);
    run_frame(on_cpu, frame, b);
    ASSERT_EQ(b.schedule.voice_count, 1u) << object;
    ASSERT_EQ(a.schedule.voice_count, 1u) << object;
    ASSERT_EQ(a.cycle.length, b.cycle.length);
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

TEST(Planner, FramesInFlightDoNotMix) {
  const Scene scene("cube");
  const auto frames = {scene.frame(0.003, 0), scene.frame(0.0, 1), scene.frame(0.002, 2), scene.frame(0.004, 3)};
  std::vector<Plan> alone;
  const Planning one_by_one(scene);
  for (const auto& frame : frames)
    run_frame(one_by_one, frame, alone.emplace_back());
  const Planning planning(scene);
  std::vector<Plan> together;
  auto next = frames.begin();
  while (together.size() < frames.size()) {
    while (next != frames.end() && planning->can_start())
      planning->start(seen(*next++));
    FrameReport report;
    Plan plan;
    if (!planning->step(plan, report)) continue;
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

/// Keeps the calling thread on one processor. Slow work then starts no threads to help, which would take memory.
class OnOneProcessor {
 public:
  OnOneProcessor() {
    sched_getaffinity(0, sizeof(before_), &before_);
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(sched_getcpu(), &one);
    sched_setaffinity(0, sizeof(one), &one);
  }
  ~OnOneProcessor() { sched_setaffinity(0, sizeof(before_), &before_); }
  OnOneProcessor(const OnOneProcessor&) = delete;
  OnOneProcessor& operator=(const OnOneProcessor&) = delete;

 private:
  cpu_set_t before_{};
};

/// Heap allocations in eight frames after the first one.
std::size_t allocations_after_the_first_frame(const Scene& scene, const Planning& planning) {
  std::vector<sensing::FrameSet> frames;
  for (std::uint64_t i = 0; i < 8; ++i)
    frames.push_back(scene.frame(0.003 - 1e-4 * static_cast<double>(i), i));
  Plan plan;
  reserve(plan, scene.setting.layout.transducers.size());
  run_frame(planning, frames[0], plan);
  EXPECT_GT(plan.drives.size(), 0u);
  return test::allocations_of([&] {
    for (const auto& frame : frames)
      run_frame(planning, frame, plan);
  });
}

TEST(Planner, NothingIsAllocatedAndNoPipelineMadeAfterTheFirstFrames) {
  const Scene scene("cube");
  const gpu::Device device;
  const Planning planning(scene, &device);
  const auto frame = scene.frame(0.003, 0);
  Plan plan;
  reserve(plan, scene.setting.layout.transducers.size());
  run_frame(planning, frame, plan);
  const std::uint64_t memory = device.memory_allocations, pipelines = device.pipelines_created;
  const std::size_t allocations = allocations_after_the_first_frame(scene, planning);
  EXPECT_EQ(device.memory_allocations, memory);
  EXPECT_EQ(device.pipelines_created, pipelines);
  // The validation layer allocates on this thread.
  if (device.validation() == gpu::Validation::off) {
    EXPECT_EQ(allocations, 0u);
  }
}

TEST(Planner, NothingIsAllocatedOnTheHostEither) {
  const Scene scene("cube");
  const OnOneProcessor alone;
  const Planning planning(scene, nullptr);
  EXPECT_EQ(allocations_after_the_first_frame(scene, planning), 0u);
}

TEST(Planner, MayBeDestroyedWithFramesUnderWay) {
  const Scene scene("cube");
  const auto frame = scene.frame(0.003, 0);
  for (const int steps : {0, 1}) {
    const Planning planning(scene);
    planning->start(seen(frame));
    Plan plan;
    FrameReport report;
    for (int i = 0; i < steps; ++i)
      planning->step(plan, report);
  }
}

TEST(Planner, ALostDeviceIsAnError) {
  const Scene scene("cube");
  const gpu::Device device;
  const Planning planning(scene, &device);
  Plan plan;
  run_frame(planning, scene.frame(0.003, 0), plan);
  device.lose();
  EXPECT_ERROR(planning->start(seen(scene.frame(0.003, 1))), Exit::failed, "VK_ERROR_DEVICE_LOST");
}

}  // namespace
}  // namespace palpa::session
