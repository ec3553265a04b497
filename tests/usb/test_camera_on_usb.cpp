// palpa with depth cameras on the kernel's own UVC driver and V4L2, with emulated cameras at the ports; and the whole
// chain from there to an emulated board.
#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "cli/support/process.hpp"
#include "sensing/recording.hpp"
#include "support/json.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"
#include "usb/loop.hpp"
#include "usb/plugged_board.hpp"
#include "usb/plugged_camera.hpp"

namespace palpa::test {
namespace {

using nlohmann::json;

const std::vector<std::string> none;

std::vector<std::string> run_with(const std::string& nodes, const std::string& rig) {
  return with({"--scene", source_file("assets/cube.glb").string(), "--layout", "openmpd", "--rig", rig},
              {"--source", "v4l2:" + nodes, "--backend", "cpu"});
}

TEST(CameraOnUsb, IsFoundByDoctor) {
  const PluggedCamera camera("C1");
  const Result result = palpa({"doctor", "--backend", "cpu", "--json", "-"});
  const json cameras = json::parse(result.out)["cameras"];
  ASSERT_FALSE(cameras.empty()) << result.out << result.err;
  EXPECT_EQ(cameras[0]["id"], "8086:0b07") << cameras;
  EXPECT_EQ(cameras[0]["serial"], "C1") << cameras;
  EXPECT_CONTAINS(cameras.dump(), camera.node());
}

TEST(CameraOnUsb, GivesItsFramesBitForBit) {
  PluggedCamera camera("C1");
  const sensing::Rig rig = rig_of(1, 90);
  Z16Camera::Picture picture(848 * 480);
  for (std::size_t i = 0; i < picture.size(); ++i)
    picture[i] = static_cast<std::uint16_t>(20000 + 7919 * i % 40000);
  camera.show(picture);
  const auto folder = scratch_folder("take") / "take";
  const Result result = palpa(with(with({"run"}, run_with(camera.node(), written(rig))),
                                   {"--frames", "5", "--record", folder.string(), "--json", "-"}));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(camera.gadget.period_ns, 11111100u);
  const auto take = sensing::make_replay(sensing::load_recording(folder), {.paced = false});
  sensing::FrameSet set;
  std::size_t frames = 0;
  for (; take->next(set, 1); ++frames)
    ASSERT_EQ(set.frames.at(0).depth, picture);
  EXPECT_GE(frames, 1u);
  EXPECT_FALSE(camera.gadget.streams) << "it is told to stop";
}

TEST(CameraOnUsb, IsSetToWhatTheRigAsksFor) {
  PluggedCamera camera("C1");
  D400Unit& unit = camera.gadget.unit;
  {
    const auto held = camera.port.hold();
    unit.lens = {601, 602, 420, 238};
  }
  std::string rig = to_toml(rig_of(1, 90));
  const std::string begin = "[[camera]]\n";
  rig.insert(rig.find(begin) + begin.size(), "calibration = \"device\"\nexposure_s = 0.004\nhardware_preset = 4\n");
  const auto folder = scratch_folder("set");
  write_text(folder / "rig.toml", rig);
  const Result doctor = palpa({"doctor", "--backend", "cpu"});
  EXPECT_CONTAINS(doctor.out, "its depth unit is 1 mm");
  const Result result = palpa(with(with({"run"}, run_with(camera.node(), (folder / "rig.toml").string())),
                                   {"--frames", "2", "--record", (folder / "take").string()}));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto held = camera.port.hold();
  EXPECT_EQ(unit.depth_table[0], 100u);
  EXPECT_EQ(unit.exposure_us(), 4000u);
  EXPECT_FALSE(unit.automatic());
  EXPECT_EQ(unit.preset(), 4u);
  const sensing::Camera seen = sensing::load_recording(folder / "take").cameras.at(0);
  EXPECT_EQ((std::vector{seen.fx, seen.fy, seen.cx, seen.cy}), (std::vector<double>{601, 602, 420, 238}));
}

/// A camera, a board, and a loop between them with a finger that touches.
struct Chain {
  Chain() {
    camera.show(touching(rig).at(0));
    loop = std::make_unique<Loop>(
        "run", with(run_with(camera.node(), written(rig)), {"--link", "openmpd:EMU1", "--hold", "500ms"}));
  }
  bool sounds() {
    return eventually(10, [&] { return board.sounds(); });
  }
  bool falls_silent() {
    return eventually(5, [&] { return !board.sounds(); }) && !eventually(0.2, [&] { return board.sounds(); });
  }

  PluggedBoard board{"EMU1"};
  PluggedCamera camera{"C1"};
  sensing::Rig rig = rig_of(1, 30);
  std::unique_ptr<Loop> loop;
};

TEST(CameraOnUsb, ATouchIsHeardByTheBoardUntilTheFingerIsGone) {
  Chain chain;
  ASSERT_TRUE(chain.sounds()) << chain.loop->said();
  chain.camera.show({});
  EXPECT_TRUE(chain.falls_silent());
  EXPECT_EQ(chain.loop->end(), 0);
  EXPECT_EQ(chain.loop->said(), "");
  EXPECT_EQ(chain.board.faults_at_the_end(), none);
}

TEST(CameraOnUsb, UnpluggedAndPluggedInAgain) {
  Chain chain;
  ASSERT_TRUE(chain.sounds()) << chain.loop->said();
  chain.camera.port.unplug();
  EXPECT_TRUE(chain.falls_silent()) << chain.loop->said();
  chain.camera.plug();
  EXPECT_TRUE(chain.sounds()) << chain.loop->said();
  EXPECT_EQ(chain.loop->end(), 0);
  EXPECT_EQ(times_said(chain.loop->said(), "\n"), 2u) << "that it is gone and that it is back: " << chain.loop->said();
  EXPECT_EQ(chain.board.faults_at_the_end(), none);
}

TEST(CameraOnUsb, FramesThatStopAreCutOrAreBrokenAreSilence) {
  Chain chain;
  for (const Z16Camera::Fault fault :
       {Z16Camera::Fault::frozen, Z16Camera::Fault::short_frame, Z16Camera::Fault::broken_frame}) {
    ASSERT_TRUE(chain.sounds()) << chain.loop->said();
    chain.camera.gadget.fault = fault;
    EXPECT_TRUE(chain.falls_silent()) << chain.loop->said();
    chain.camera.gadget.fault = Z16Camera::Fault::none;
  }
  EXPECT_TRUE(chain.sounds()) << chain.loop->said();
  EXPECT_EQ(chain.loop->end(), 0);
  EXPECT_EQ(chain.board.faults_at_the_end(), none);
}

TEST(CameraOnUsb, TwoAreOneSkin) {
  PluggedCamera left("C1"), right("C2");
  const sensing::Rig rig = rig_of(2, 30);
  const auto pictures = touching(rig);
  left.show(pictures[0]);
  right.show(pictures[1]);
  const Result result = palpa(
      with(with({"run"}, run_with(left.node() + "," + right.node(), written(rig))), {"--frames", "5", "--json", "-"}));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(json::parse(result.out)["frames"]["touching"], 5);
  EXPECT_EQ(result.err_without_lateness(), "");
}

}  // namespace
}  // namespace palpa::test
