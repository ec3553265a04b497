// A run on a board that plays at full amplitude because nobody chose a ceiling says so. And the files that a run opens.
#include <gtest/gtest.h>

#include <atomic>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "cli/support/tiny_files.hpp"
#include "geometry/gltf/gltf.hpp"
#include "setup/sessions/live_run.hpp"
#include "support/captured.hpp"
#include "support/files.hpp"
#include "support/occurrences.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::setup {
namespace {

class Quiet final : public session::Link {
 public:
  explicit Quiet(const array::Layout* boards) : boards_(boards) {}
  void plan(const session::PlayedPlan&) override {}
  void send(std::uint64_t, std::span<const array::TransducerDrive>) override {}
  const array::Layout* boards() const override { return boards_; }

 private:
  const array::Layout* boards_;
};

session::LinkKind kind(const std::string& name, bool board) {
  return {name, "", [board](const std::string&, const session::LinkSetting& setting) {
            return std::make_unique<Quiet>(board ? &setting.layout : nullptr);
          }};
}

/// Boards' layout, on the processor.
LiveOptions options_to(const std::string& link) {
  LiveOptions options;
  options.common.backend = Backend::cpu;
  options.scene = "cube";
  options.made_solids = std::make_shared<std::vector<geometry::Solid>>(
      geometry::make_solids(geometry::load_gltf(test::source_file("assets/cube.glb"))));
  options.rig.layout = "openmpd";
  options.link = link;
  return options;
}

/// How often a run with these options says so before it begins.
std::size_t told_of(const LiveOptions& options) {
  const std::vector<session::LinkKind> links{kind("board", true), kind("air", false)};
  std::atomic<bool> stop{false};
  return test::occurrences(test::stderr_of([&] { LiveRun run(options, {}, links, stop); }),
                           "--link " + options.link +
                               ": plays at full amplitude, because no --ceiling is given; "
                               "--ceiling 0.3 makes it quieter, to a tenth");
}

TEST(FullAmplitude, ARunOnABoardSaysSoOnce) {
  EXPECT_EQ(told_of(options_to("board")), 1u);
  EXPECT_EQ(told_of(options_to("air")), 0u) << "it is no board";
}

TEST(FullAmplitude, WhoeverChoseHowLoudIsNotTold) {
  LiveOptions given = options_to("board");
  given.ceiling_known = true;
  EXPECT_EQ(told_of(given), 0u) << "--ceiling 1";
  LiveOptions quiet = options_to("board");
  quiet.safety.ceiling = 0.3;
  EXPECT_EQ(told_of(quiet), 0u);
  LiveOptions pressure = options_to("board");
  pressure.drive.pressure_pa = 1000;
  EXPECT_EQ(told_of(pressure), 0u);
}

TEST(FullAmplitude, SolidsThatAllAskForAPressureAreNotAtFullAmplitude) {
  LiveOptions options = options_to("board");
  std::vector<geometry::Solid> solids = *options.made_solids;
  solids.push_back(solids[0]);
  solids[0].haptics.pressure_pa = 1000;
  options.made_solids = std::make_shared<std::vector<geometry::Solid>>(solids);
  EXPECT_EQ(told_of(options), 1u) << "one of them does not";
  solids[1].haptics.pressure_pa = 500;
  options.made_solids = std::make_shared<std::vector<geometry::Solid>>(solids);
  EXPECT_EQ(told_of(options), 0u);
}

/// In one program, as in the viewer, each run opens only what its own options allow.
TEST(OutsideReferences, AreOpenedByRunsThatAllowThem) {
  const std::filesystem::path folder = test::scratch_folder("outside");
  std::filesystem::create_directory(folder / "theirs");
  test::write_text(folder / "short.bin", "Q7");
  test::write_scene(folder / "theirs/model.gltf", "../short.bin");
  LiveOptions options;
  options.scene = folder / "theirs/model.gltf";
  options.common.backend = Backend::cpu;
  std::atomic<bool> stop{false};
  for (const bool allowed : {false, true, false}) {
    options.common.allow_outside = allowed;
    EXPECT_REFUSED(LiveRun(options, {}, {}, stop), allowed ? "has 2 bytes" : "--allow-outside");
  }
}

}  // namespace
}  // namespace palpa::setup
