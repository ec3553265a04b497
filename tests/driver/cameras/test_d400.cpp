// RealSense's extension unit on an emulated camera that answers as librealsense expects, and doctor's report on nodes.
#include <gtest/gtest.h>
#include <linux/videodev2.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <memory>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "driver/cameras/made_up_cameras.hpp"
#include "driver/cameras/made_up_frames.hpp"
#include "driver/v4l2/doctor.hpp"
#include "driver/v4l2/rig.hpp"
#include "driver/v4l2/source.hpp"
#include "support/captured.hpp"
#include "support/thrown.hpp"
#include "usb/d400_unit.hpp"
#include "usb/gadget.hpp"

namespace palpa::driver::v4l2 {
namespace {

using palpa::test::D400Unit;
using palpa::test::error_of;
using palpa::test::stderr_of;
using test::Machine;
using test::MadeUpCamera;

void make_d400(MadeUpCamera& camera, D400Unit& held) {
  camera.node.vendor = 0x8086;
  camera.offers = {{V4L2_PIX_FMT_Z16, 848, 480, 90}, {V4L2_PIX_FMT_Z16, 64, 48, 90}, {V4L2_PIX_FMT_Z16, 64, 48, 60}};
  camera.extension = [&held](auto unit, auto selector, auto query, auto* data, auto size) {
    if (unit != D400Unit::number) return -ENOENT;
    std::vector<std::uint8_t> bytes(data, data + size);
    const palpa::test::ControlRequest request{
        .request = query, .value = static_cast<std::uint16_t>(selector << 8), .length = size};
    if (held.control(request, bytes) != palpa::test::Answer::done) return -EIO;
    std::copy(bytes.begin(), bytes.end(), data);
    return 0;
  };
}

const sensing::Camera d400 = cameras::test::described("left", 848, 480, 400);

struct D400 : ::testing::Test {
  Machine machine;
  std::shared_ptr<MadeUpCamera> camera = machine.plug("/dev/video0", "A");
  D400Unit held;
  D400() { make_d400(*camera, held); }
  std::unique_ptr<sensing::DepthSource> open(const sensing::Camera& wanted) {
    return open_cameras(machine.kernel(), {wanted}, {"/dev/video0"}, "rig.toml");
  }
  std::string refusal(const sensing::Camera& wanted) {
    const std::string line = error_of([&] { open(wanted); });
    EXPECT_TRUE(line.starts_with("/dev/video0: ")) << line;
    return line;
  }
};

TEST_F(D400, TakesTheRigsDepthUnitAgainAfterItLostPower) {
  std::unique_ptr<sensing::DepthSource> source;
  EXPECT_EQ(stderr_of([&] { source = open(d400); }), "");
  EXPECT_EQ(held.depth_table, (std::array<std::uint32_t, 5>{100, 7, 65535, 0, 5})) << "what is not asked for stays";
  EXPECT_EQ(source->cameras()[0].depth_unit_m, 0.0001);
  EXPECT_EQ(source->cameras()[0].fx, 400) << "the rig's, unless it says otherwise";
  stderr_of([&] {
    sensing::FrameSet set;
    machine.unplug("/dev/video0");
    source->next(set, 0.1);
    held.depth_table[0] = 1000;
    const auto again = machine.plug("/dev/video0", "A");
    make_d400(*again, held);
    again->extension = nullptr;
    for (int i = 0; i < 10; ++i)
      source->next(set, 0.1);
    EXPECT_TRUE(set.frames.empty()) << "it does not answer, and its steps may be ten times as long now";
    make_d400(*again, held);
    for (int i = 0; i < 10; ++i)
      source->next(set, 0.1);
    EXPECT_FALSE(set.frames.empty());
  });
  EXPECT_EQ(held.depth_table[0], 100u);
}

/// Each of two unlike cameras gets what its own table says, in both orders, and again when it has lost its power.
TEST(D400Several, EachIsSetUpAsItsOwnTableSaysAndAgainWhenItIsBack) {
  sensing::Camera left = d400, right = cameras::test::described("right", 64, 48, 50);
  left.depth_unit_m = 0.0002;
  left.device = {.exposure_s = 0.004, .preset = 3};
  right.rate_hz = 60;
  right.device = {.own_lens = false, .exposure_s = 0, .preset = 5};
  for (const bool swapped : {false, true}) {
    Machine machine;
    const D400Unit plain;
    std::array<D400Unit, 2> held;
    std::vector<sensing::Camera> wanted{left, right};
    if (swapped) std::swap(wanted[0], wanted[1]);
    const std::vector<std::string> nodes{"/dev/video0", "/dev/video2"};
    for (std::size_t i = 0; i < 2; ++i)
      make_d400(*machine.plug(nodes[i], std::string(1, static_cast<char>('A' + i))), held[i]);
    std::unique_ptr<sensing::DepthSource> source;
    stderr_of([&] { source = open_cameras(machine.kernel(), wanted, nodes, "rig.toml"); });
    for (std::size_t i = 0; i < 2; ++i)
      EXPECT_EQ(source->cameras()[i].rate_hz, wanted[i].rate_hz) << i;
    const auto state = [](const D400Unit& unit) {
      return std::tuple(unit.depth_table, unit.automatic(), unit.exposure_us(), unit.preset());
    };
    const std::array before{state(held[0]), state(held[1])};
    EXPECT_NE(before[0], before[1]);
    EXPECT_EQ(held[swapped ? 1 : 0].depth_table[0], 200u);
    EXPECT_EQ(held[swapped ? 0 : 1].depth_table[0], 100u);
    EXPECT_EQ(held[swapped ? 1 : 0].preset(), 3u);
    EXPECT_EQ(held[swapped ? 0 : 1].preset(), 5u);
    sensing::FrameSet set;
    stderr_of([&] {
      for (std::size_t i = 0; i < 2; ++i) {
        const auto camera = machine.plugged.at(nodes[i]);
        machine.unplug(nodes[i]);
        source->next(set, 0.1);
        held[i] = plain;
        make_d400(*machine.plug(nodes[i], camera->node.serial), held[i]);
        for (int n = 0; n < 40; ++n)
          source->next(set, 0.1);
        EXPECT_EQ(state(held[i]), before[i]) << i;
        const auto& again = *machine.plugged.at(nodes[i]);
        EXPECT_EQ(std::pair(again.width, again.height), std::pair(wanted[i].width, wanted[i].height));
      }
    });
  }
}

TEST_F(D400, AUnitThatItKeepsIsRefused) {
  held.keeps_unit = true;
  EXPECT_CONTAINS(refusal(d400), "keeps its depth unit of 1 mm; set depth_unit_m = 0.001 in rig.toml");
}

TEST_F(D400, ACameraThatDoesNotAnswerHasTheRigsUnitWithAWarning) {
  camera->extension = nullptr;
  std::unique_ptr<sensing::DepthSource> source;
  EXPECT_CONTAINS(stderr_of([&] { source = open(d400); }), "palpa assumes a depth unit of 0.1 mm, as rig.toml says");
  const std::string said = stderr_of([&] {
    sensing::FrameSet set;
    machine.unplug("/dev/video0");
    source->next(set, 0.1);
    const auto again = machine.plug("/dev/video0", "A");
    make_d400(*again, held);
    again->extension = nullptr;
    for (int i = 0; i < 20; ++i)
      source->next(set, 0.1);
    EXPECT_FALSE(set.frames.empty());
  });
  EXPECT_CONTAINS(said, "is back");
  EXPECT_EQ(said.find("assumes"), std::string::npos) << "told once: " << said;
}

TEST_F(D400, ItIsAskedAgainWhileItIsBusy) {
  held.busy = 3;
  open(d400);
  EXPECT_EQ(held.depth_table[0], 100u);
}

TEST_F(D400, ItsOwnCalibrationTakesThePlaceOfTheFiles) {
  sensing::Camera wanted = d400;
  wanted.device.own_lens = true;
  wanted.distortion = {0.1, 0, 0, 0, 0};
  held.lens = {390.5, 391.5, 419.25, 241.75};
  {
    const auto source = open(wanted);
    const sensing::Camera& found = source->cameras()[0];
    EXPECT_EQ((std::vector{found.fx, found.fy, found.cx, found.cy}), (std::vector{390.5, 391.5, 419.25, 241.75}));
    EXPECT_EQ(found.distortion, (std::array<double, 5>{}));
    EXPECT_FALSE(found.device.own_lens);
  }
  held.wrong_checksum = true;
  EXPECT_CONTAINS(refusal(wanted), "checksum of the camera's calibration is wrong");
  held.wrong_checksum = false;
  wanted.width = 64;
  wanted.height = 48;
  EXPECT_CONTAINS(refusal(wanted), "calibration has no 64x48; give fx, fy, cx and cy");
}

TEST_F(D400, OnlyWholeMicrometresAreADepthUnit) {
  sensing::Camera wanted = d400;
  for (const auto& [unit_m, told] : {std::pair(62.5e-6, "is 62.5 micrometres; set depth_unit_m = 6.3e-05"),
                                     {100.4e-6, "is 100.4 micrometres; set depth_unit_m = 0.0001"},
                                     {0.3e-6, "is 0.3 micrometres; set depth_unit_m = 1e-06"}}) {
    wanted.depth_unit_m = unit_m;
    EXPECT_CONTAINS(refusal(wanted), told);
    EXPECT_EQ(held.depth_table[0], 1000u) << "nothing is written";
  }
  wanted.depth_unit_m = 63e-6;
  open(wanted);
  EXPECT_EQ(held.depth_table[0], 63u);
}

TEST_F(D400, AnotherLensUnderTheSameNameIsAnotherCamera) {
  sensing::Camera wanted = d400;
  wanted.device.own_lens = true;
  const auto source = open(wanted);
  sensing::FrameSet set;
  const auto comes = [&](double seconds) {
    bool any = false;
    for (const double begin_s = machine.now_s; machine.now_s < begin_s + seconds;)
      any = (source->next(set, 0.1) && !set.frames.empty()) || any;
    return any;
  };
  EXPECT_TRUE(comes(0.1));
  for (const char* time : {"first", "second"}) {
    SCOPED_TRACE(time);
    machine.unplug("/dev/video0");
    held.lens[0] = 641;
    const std::string said = stderr_of([&] {
      comes(0.5);
      machine.plug("/dev/video0", camera);
      EXPECT_FALSE(comes(4));
    });
    EXPECT_CONTAINS(said,
                    "camera 'left' cannot be opened again: /dev/video0: its lens has changed: this is not the camera");
    EXPECT_EQ(said.find("not the camera"), said.rfind("not the camera"));
    held.lens[0] = 640;
    EXPECT_CONTAINS(stderr_of([&] { EXPECT_TRUE(comes(2)); }), "is back");
  }
}

TEST_F(D400, ExposureAndPresetAreSetWhereTheRigSaysSo) {
  open(d400);
  EXPECT_TRUE(held.automatic());
  EXPECT_EQ(held.preset(), 0u);
  sensing::Camera wanted = d400;
  wanted.device.exposure_s = 0.004;
  wanted.device.preset = 3;
  open(wanted);
  EXPECT_FALSE(held.automatic());
  EXPECT_EQ(held.exposure_us(), 4000u);
  EXPECT_EQ(held.preset(), 3u);
  wanted.device.exposure_s = 0;
  open(wanted);
  EXPECT_TRUE(held.automatic());
  camera->node.vendor = 0x1234;
  for (const sensing::DeviceSetting& each :
       {wanted.device, {.own_lens = true}, sensing::DeviceSetting{.exposure_s = 0}, {.preset = 0}}) {
    wanted.device = each;
    EXPECT_CONTAINS(refusal(wanted), "is not a RealSense on USB: calibration");
  }
  wanted.device = {};
  open(wanted);
}

TEST(CameraDoctor, TellsOfCoarseUnitsSharedControllersSlowPortsAndMissingRights) {
  Machine machine;
  D400Unit coarse, fine;
  fine.depth_table[0] = 100;
  make_d400(*machine.plug("/dev/video0", "A"), coarse);
  machine.plug("/dev/video1", "A")->metadata = true;
  machine.plugged["/dev/video1"]->offers.clear();
  make_d400(*machine.plug("/dev/video2", "B"), fine);
  const auto elsewhere = machine.plug("/dev/video4", "C");
  make_d400(*elsewhere, fine);
  elsewhere->node.controller = "0000:05:00.0";
  elsewhere->node.mbit_s = 480;
  machine.plug("/dev/video6", "D")->refuses_to_open = EACCES;
  const auto kernel = machine.kernel();
  const std::vector<cli::DoctorItem> items = describe_nodes(*kernel);
  ASSERT_EQ(items.size(), 5u);
  EXPECT_CONTAINS(items[0].advice, "depth: --source v4l2:/dev/video0");
  EXPECT_CONTAINS(items[0].advice, "its depth unit is 1 mm, which is coarse for a shell of 1.5 mm");
  EXPECT_CONTAINS(items[0].advice, "shares the USB controller 0000:00:14.0 with /dev/video2, 73 MB/s each");
  EXPECT_EQ(items[1].advice, "");
  EXPECT_EQ(items[2].advice.find("depth unit"), std::string::npos);
  EXPECT_CONTAINS(items[2].advice, "with /dev/video0, 73 MB/s each");
  EXPECT_EQ(items[3].advice.find("shares"), std::string::npos);
  EXPECT_CONTAINS(items[3].advice, "runs at 480 Mbit/s, too slow for 848x480 at 90 Hz");
  EXPECT_FALSE(items[4].ok);
  EXPECT_CONTAINS(items[4].advice, "add yourself to the group video");
  EXPECT_EQ(machine.open_descriptors, 0);
}

TEST(CameraDoctor, DescribesTheCamerasThatAreThereForARig) {
  Machine machine;
  D400Unit first, second;
  make_d400(*machine.plug("/dev/video0", "A"), first);
  machine.plug("/dev/video1", "A")->metadata = true;
  machine.plugged["/dev/video1"]->offers.clear();
  const auto both = machine.plug("/dev/video2", "B");
  make_d400(*both, second);
  both->offers = {
      {V4L2_PIX_FMT_Z16, 1280, 720, 30}, {V4L2_PIX_FMT_Z16, 848, 480, 60}, {V4L2_PIX_FMT_Z16, 848, 480, 90}};
  second.wrong_checksum = true;
  const auto other = machine.plug("/dev/video4", "");
  other->offers = {{V4L2_PIX_FMT_Z16, 320, 240, 30}, {V4L2_PIX_FMT_Z16, 640, 480, 15}};
  machine.plug("/dev/video6", "D")->refuses_to_open = EACCES;
  const auto kernel = machine.kernel();
  const cli::CamerasThere there = cameras_there(*kernel);
  EXPECT_EQ(there.source, "v4l2:/dev/video0,/dev/video2,/dev/video4");
  EXPECT_CONTAINS(there.problem, "/dev/video6: Permission denied");
  ASSERT_EQ(there.cameras.size(), 3u);
  const sensing::Camera& told = there.cameras[0].camera;
  EXPECT_EQ(told.name, "A");
  EXPECT_EQ(told.width, 848u);
  EXPECT_EQ(told.rate_hz, 90);
  EXPECT_EQ(told.fx, 640);
  EXPECT_EQ(told.cy, 239.5);
  EXPECT_TRUE(told.device.own_lens);
  EXPECT_EQ(told.depth_unit_m, 1e-4);
  EXPECT_EQ(told.T_world_camera, Transform(1.0));
  EXPECT_CONTAINS(there.cameras[0].note, "the camera's own calibration");
  const sensing::Camera& guessed = there.cameras[1].camera;
  EXPECT_EQ(guessed.width, 848u);
  EXPECT_EQ(guessed.height, 480u);
  EXPECT_EQ(guessed.rate_hz, 90);
  EXPECT_NEAR(guessed.fx, 666, 1);
  EXPECT_FALSE(guessed.device.own_lens);
  EXPECT_CONTAINS(there.cameras[1].note, "are a guess (the checksum");
  EXPECT_EQ(there.cameras[2].camera.name, "camera 3");
  EXPECT_EQ(there.cameras[2].camera.width, 640u);
  EXPECT_EQ(there.cameras[2].camera.depth_unit_m, 1e-3);
  EXPECT_CONTAINS(there.cameras[2].note, "depth_unit_m is a guess, too");
  EXPECT_EQ(machine.open_descriptors, 0);
}

}  // namespace
}  // namespace palpa::driver::v4l2
