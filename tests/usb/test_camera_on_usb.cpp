// palpa with depth cameras on the kernel's own UVC driver and V4L2, with emulated cameras at the ports; and the whole
// chain from there to an emulated board.
#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "cli/support/process.hpp"
#include "geometry/gltf/gltf.hpp"
#include "sensing/recording.hpp"
#include "sensing/rig.hpp"
#include "sensing/synthetic.hpp"
#include "support/begins.hpp"
#include "support/files.hpp"
#include "support/json.hpp"
#include "support/occurrences.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"
#include "usb/loop.hpp"
#include "usb/plugged_board.hpp"
#include "usb/vhci_port.hpp"
#include "usb/z16_camera.hpp"

namespace palpa::test {
namespace {

using nlohmann::json;

const std::vector<std::string> none;

/// An emulated depth camera on the kernel's USB, and the pictures that it gives.
class PluggedCamera {
 public:
  explicit PluggedCamera(const std::string& serial) : gadget(serial), port(gadget) { plug(); }

  /// Returns when the kernel has created its nodes.
  void plug() {
    port.plug();
    EXPECT_TRUE(begins([&] { return !node().empty(); }));
  }
  /// "/dev/videoN", the node of its frames; empty if there is none.
  std::string node() const {
    std::error_code ignored;
    const auto nodes = std::filesystem::path("/sys/bus/usb/devices") / (port.place() + ":1.0") / "video4linux";
    for (const auto& entry : std::filesystem::directory_iterator(nodes, ignored)) {
      const std::string name = "/dev/" + entry.path().filename().string();
      if (read_text(entry.path() / "index") == "0\n" && std::filesystem::exists(name)) return name;
    }
    return {};
  }
  void show(Z16Camera::Picture picture) {
    const auto held = port.hold();
    gadget.show(std::move(picture));
  }

  Z16Camera gadget;
  VhciPort port;
};

/// The first cameras of the paper's rig, at that rate, without an array.
sensing::Rig rig_of(std::size_t cameras, double rate_hz) {
  sensing::Rig rig = sensing::load_rig(source_file("assets/rigs/paper.toml"));
  rig.cameras.resize(cameras);
  for (sensing::Camera& camera : rig.cameras)
    camera.rate_hz = rate_hz;
  rig.array.reset();
  return rig;
}

/// Its file.
std::string written(const sensing::Rig& rig) {
  const auto file = scratch_folder("rig") / "rig.toml";
  write_text(file, to_toml(rig));
  return file.string();
}

/// For each of its cameras, the picture of a fingertip 2 mm inside an object with its top at y = 0.
std::vector<Z16Camera::Picture> touching(const sensing::Rig& rig) {
  geometry::Mesh finger;
  for (const geometry::SceneMesh& part : geometry::load_gltf(source_file("assets/finger.glb")).meshes)
    geometry::append(finger, part.mesh);
  Transform pose(1.0);
  pose[3][1] = -2e-3;
  sensing::SyntheticRig synthetic(rig.cameras, {}, sensing::Noise::none, 1);
  sensing::FrameSet set;
  const sensing::Posed skin[] = {{&finger, pose}};
  synthetic.render(skin, 0, set);
  std::vector<Z16Camera::Picture> pictures;
  for (const sensing::DepthFrame& frame : set.frames)
    pictures.push_back(frame.depth);
  return pictures;
}

std::vector<std::string> run_with(const std::string& nodes, const std::string& rig) {
  return with({"--scene", source_file("assets/cube.glb").string(), "--layout", "openmpd", "--rig", rig},
              {"--source", "v4l2:" + nodes, "--backend", "cpu"});
}

TEST(CameraOnUsb, GivesItsFramesBitForBit) {
  PluggedCamera camera("C1");
  const sensing::Rig rig = rig_of(1, 90);
  Z16Camera::Picture picture(848 * 480);
  for (std::size_t i = 0; i < picture.size(); ++i)
    picture[i] = static_cast<std::uint16_t>(20000 + 7919 * i % 40000);
  camera.show(picture);
  const auto folder = scratch_folder("take") / "take";
  succeeded(palpa(with(with({"run"}, run_with(camera.node(), written(rig))),
                       {"--frames", "5", "--record", folder.string(), "--json", "-"})));
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
  EXPECT_CONTAINS(doctor.out, camera.node());
  EXPECT_CONTAINS(doctor.out, "its depth unit is 1 mm");
  succeeded(palpa(with(with({"run"}, run_with(camera.node(), (folder / "rig.toml").string())),
                       {"--frames", "2", "--record", (folder / "take").string()})));
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
    return begins([&] { return board.sounds(); });
  }
  bool falls_silent() {
    return begins([&] { return !board.sounds(); }) && !eventually(0.2, [&] { return board.sounds(); });
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
  EXPECT_EQ(occurrences(chain.loop->said(), "\n"), 2u) << "that it is gone and that it is back: " << chain.loop->said();
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

TEST(CameraOnUsb, TwoCamerasGiveOneSkin) {
  PluggedCamera left("C1"), right("C2");
  const sensing::Rig rig = rig_of(2, 30);
  const auto pictures = touching(rig);
  left.show(pictures[0]);
  right.show(pictures[1]);
  const Result result = succeeded(palpa(
      with(with({"run"}, run_with(left.node() + "," + right.node(), written(rig))), {"--frames", "5", "--json", "-"})));
  EXPECT_EQ(json::parse(result.out)["frames"]["touching"], 5);
  EXPECT_EQ(result.err_without_lateness(), "");
}

}  // namespace
}  // namespace palpa::test
