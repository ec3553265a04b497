// The results of `palpa export`, called from C++: links that fail, and refusals.
#include "setup/tasks/export.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <functional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "base/files/outputs.hpp"
#include "support/files.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::test {
namespace {

class ExportOf : public testing::Test {
 protected:
  ExportOf() {
    task.scene = source_file("assets/cube.glb");
    task.source = "synthetic:" + source_file("assets/finger.ply").string();
    task.rig.rig = source_file("assets/rigs/paper.toml");
    task.frames = 6;
    task.common.backend = setup::Backend::cpu;
  }

  std::filesystem::path folder = scratch_folder("export-task");
  std::string csv = folder / "foci.csv";
  std::atomic<bool> stop{false};
  setup::ExportTask task;
};

TEST_F(ExportOf, AStoppedRunWritesNoFile) {
  task.foci = csv;
  const Outputs outputs({{"--foci", csv}});
  setup::ExportRun run(task, {}, stop);
  const setup::ExportResult result = run.run({.planned = [&](const session::FrameReport&) { stop = true; }});
  EXPECT_TRUE(result.stopped);
  EXPECT_EQ(result.stats.frames, 1u);
  EXPECT_FALSE(std::filesystem::exists(csv));
}

/// A link that fails from some slot on, in each of its functions, with an exception of any kind.
class Failing final : public session::Link {
 public:
  void plan(const session::PlayedPlan&) override {}
  void send(std::uint64_t slot, std::span<const array::TransducerDrive>) override {
    if (slot >= 3) throw std::runtime_error("the first fails");
  }
  void finish() override { throw std::runtime_error("the first fails again"); }
};

/// A link that keeps what it gets.
class Hearing final : public session::Link {
 public:
  void plan(const session::PlayedPlan&) override {}
  void send(std::uint64_t slot, std::span<const array::TransducerDrive> drive) override {
    slots.push_back(slot);
    sounds = std::ranges::any_of(drive, [](const array::TransducerDrive& one) { return one.amplitude > 0; });
    sounded = sounded || sounds;
  }
  void finish() override { finished = true; }

  std::vector<std::uint64_t> slots;
  bool sounds = false, sounded = false, finished = false;
};

TEST_F(ExportOf, ALinkThatFailsLeavesTheOthersSilentAndFinished) {
  task.drives = folder / "drives.bin";
  Failing failing;
  Hearing hearing;
  session::Link* const links[]{&failing, &hearing};
  check(task, {});
  const Outputs outputs({{"--drives", task.drives}});
  EXPECT_THROW(setup::ExportRun(task, {}, stop, links).run(), std::runtime_error);
  EXPECT_TRUE(hearing.sounded);
  EXPECT_FALSE(hearing.sounds) << "the last drive is silence";
  EXPECT_TRUE(hearing.finished);
  EXPECT_TRUE(std::ranges::is_sorted(hearing.slots, std::less_equal<>())) << "slots ascend";
  EXPECT_EQ(hearing.slots.size(), 5u) << "slots 0 to 3, and silence";
}

TEST_F(ExportOf, FramesThatStandAloneHaveNoHysteresis) {
  EXPECT_EQ(task.chosen_hysteresis(), touch::Hysteresis::on);
  task.axes = touch::Axes::covariance;
  EXPECT_EQ(task.chosen_hysteresis(), touch::Hysteresis::on);
  task.smoothing = touch::Smoothing::none;
  EXPECT_EQ(task.chosen_hysteresis(), touch::Hysteresis::off);
  task.hysteresis = touch::Hysteresis::on;
  EXPECT_EQ(task.chosen_hysteresis(), touch::Hysteresis::on);
  task.touch.parameters.finger_width_m = 0;
  EXPECT_ERROR(check(task, {}, true), Exit::usage, "--hysteresis goes with");
}

TEST_F(ExportOf, ARunWithoutAnOutputOrAnEndIsRefused) {
  EXPECT_ERROR(check(task, {}), Exit::usage, "nothing to export");
  task.frames = 0;
  EXPECT_ERROR(check(task, {}, true), Exit::usage, "does not end");
}

}  // namespace
}  // namespace palpa::test
