// RealSense's extension unit on an emulated camera that answers as librealsense expects, and doctor's report on nodes.
#include <gtest/gtest.h>
#include <linux/usb/video.h>
#include <linux/videodev2.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "driver/cameras/made_up_cameras.hpp"
#include "driver/v4l2/doctor.hpp"
#include "driver/v4l2/rig.hpp"
#include "driver/v4l2/source.hpp"
#include "support/captured.hpp"
#include "support/thrown.hpp"

namespace palpa::driver::v4l2 {
namespace {

using palpa::test::error_of;
using palpa::test::stderr_of;
using test::Machine;
using test::MadeUpCamera;

/// The state of a D400 behind its extension unit.
struct MadeUpD400 {
  std::uint32_t unit_um = 1000;
  float fx = 390.5f;  ///< at 640x480
  bool keeps_unit = false, wrong_checksum = false;
  int busy = 0;  ///< this many requests are refused before one is accepted
  std::uint8_t automatic = 1, preset = 0;
  std::uint32_t exposure_us = 0;
  std::vector<std::uint8_t> request;  ///< to the hardware monitor

  static std::uint32_t word(const std::uint8_t* data) {
    std::uint32_t value = 0;
    for (int i = 3; i >= 0; --i)
      value = value << 8 | data[i];
    return value;
  }
  static void put(std::vector<std::uint8_t>& out, std::uint32_t value) {
    for (int i = 0; i < 4; ++i)
      out.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
  }

  /// 512 bytes. The entry for 640x480, the third one, differs from the others.
  std::vector<std::uint8_t> calibration() const {
    std::vector<std::uint8_t> table(512, 0);
    for (int size = 0; size < 12; ++size) {
      const float lens[4] = {size == 2 ? fx : 1.5f, size == 2 ? 391.5f : 1.5f, 319.25f, 241.75f};
      std::memcpy(table.data() + 256 + 16 * size, lens, 16);
    }
    std::uint32_t crc = 0xffffffff;
    for (std::size_t i = 16; i < table.size(); ++i) {
      for (int bit = 0; bit < 8; ++bit) {
        const bool low = ((crc ^ (table[i] >> bit)) & 1) != 0;
        crc = (crc >> 1) ^ (low ? 0xedb88320u : 0u);
      }
    }
    crc = ~crc ^ (wrong_checksum ? 1u : 0u);
    std::memcpy(table.data() + 12, &crc, 4);
    return table;
  }

  std::vector<std::uint8_t> answer() {
    const std::uint32_t opcode = word(request.data() + 4), parameter = word(request.data() + 8);
    std::vector<std::uint8_t> out;
    put(out, opcode);
    const bool table = parameter == 9;
    if (opcode == 0x15 && parameter == 25) {
      const auto bytes = calibration();
      out.insert(out.end(), bytes.begin(), bytes.end());
    } else if (opcode == 0x2c && table) {
      for (const std::uint32_t value : {unit_um, 7u, 65535u, 0u, 5u})
        put(out, value);
    } else if (opcode == 0x2b && table) {
      EXPECT_EQ(word(request.data() + 24 + 4), 7u) << "what is not asked for stays";
      EXPECT_EQ(word(request.data() + 24 + 16), 5u);
      if (!keeps_unit) unit_um = word(request.data() + 24);
    } else {
      out.assign(4, 0xff);
    }
    const std::size_t length = out.size() - 4;
    out.resize(1024, 0);
    for (int i = 0; i < 4; ++i)
      out[1020 + i] = static_cast<std::uint8_t>(length >> (8 * i));
    return out;
  }

  int control(std::uint8_t unit, std::uint8_t selector, std::uint8_t query, std::uint8_t* data, std::uint16_t size) {
    if (unit != 3) return -ENOENT;
    if (busy > 0) return --busy, -EIO;
    if (selector == 1 && size == 1024 && query == UVC_SET_CUR) {
      request.assign(data, data + size);
      EXPECT_EQ(data[2], 0xab);
      EXPECT_EQ(data[3], 0xcd);
      const std::size_t extra = word(data + 4) == 0x2b ? 20 : 0;
      EXPECT_EQ(data[0] + 256 * data[1], 20 + static_cast<int>(extra)) << "bytes after the first four";
    } else if (selector == 1 && size == 1024 && query == UVC_GET_CUR) {
      const auto bytes = answer();
      std::copy(bytes.begin(), bytes.end(), data);
    } else if (selector == 0xb && size == 1 && query == UVC_SET_CUR) {
      automatic = *data;
    } else if (selector == 3 && size == 4 && query == UVC_SET_CUR) {
      EXPECT_EQ(automatic, 0) << "the automatic goes first";
      exposure_us = word(data);
    } else if (selector == 6 && size == 1 && query == UVC_SET_CUR) {
      preset = *data;
    } else {
      return -EINVAL;
    }
    return 0;
  }
};

void make_d400(MadeUpCamera& camera, MadeUpD400& held) {
  camera.node.vendor = 0x8086;
  camera.offers = {{V4L2_PIX_FMT_Z16, 640, 480, 90}, {V4L2_PIX_FMT_Z16, 64, 48, 90}};
  camera.extension = [&held](auto unit, auto selector, auto query, auto* data, auto size) {
    return held.control(unit, selector, query, data, size);
  };
}

sensing::Camera described() {
  sensing::Camera camera;
  camera.name = "left";
  camera.width = 640;
  camera.height = 480;
  camera.fx = camera.fy = 400;
  camera.depth_unit_m = 0.0001;
  camera.rate_hz = 90;
  return camera;
}

struct D400 : ::testing::Test {
  Machine machine;
  std::shared_ptr<MadeUpCamera> camera = machine.plug("/dev/video0", "A");
  MadeUpD400 held;
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
  EXPECT_EQ(stderr_of([&] {
              const auto source = open(described());
              EXPECT_EQ(held.unit_um, 100u);
              EXPECT_EQ(source->cameras()[0].depth_unit_m, 0.0001);
              EXPECT_EQ(source->cameras()[0].fx, 400) << "the rig's, unless it says otherwise";
            }),
            "");
  const auto source = open(described());
  stderr_of([&] {
    sensing::FrameSet set;
    machine.unplug("/dev/video0");
    source->next(set, 0.1);
    held.unit_um = 1000;
    const auto again = machine.plug("/dev/video0", "A");
    make_d400(*again, held);
    for (int i = 0; i < 10; ++i)
      source->next(set, 0.1);
    EXPECT_FALSE(set.frames.empty());
  });
  EXPECT_EQ(held.unit_um, 100u);
}

TEST_F(D400, AUnitThatItKeepsIsRefused) {
  held.keeps_unit = true;
  EXPECT_CONTAINS(refusal(described()), "keeps its depth unit of 1 mm; set depth_unit_m = 0.001 in rig.toml");
}

TEST_F(D400, WhereItDoesNotAnswerTheRigIsTrustedAndThatIsSaid) {
  camera->extension = nullptr;
  EXPECT_CONTAINS(stderr_of([&] { open(described()); }), "palpa assumes a depth unit of 0.1 mm, as rig.toml says");
}

TEST_F(D400, WhoAnsweredOnceIsNotTrustedAfterwards) {
  const auto source = open(described());
  stderr_of([&] {
    sensing::FrameSet set;
    machine.unplug("/dev/video0");
    source->next(set, 0.1);
    held.unit_um = 1000;
    const auto again = machine.plug("/dev/video0", "A");
    make_d400(*again, held);
    again->extension = nullptr;
    for (int i = 0; i < 10; ++i)
      source->next(set, 0.1);
    EXPECT_TRUE(set.frames.empty()) << "its steps may be ten times as long now";
    make_d400(*again, held);
    for (int i = 0; i < 10; ++i)
      source->next(set, 0.1);
    EXPECT_FALSE(set.frames.empty());
  });
  EXPECT_EQ(held.unit_um, 100u);
}

TEST_F(D400, ItIsAskedAgainWhileItIsBusy) {
  held.busy = 3;
  open(described());
  EXPECT_EQ(held.unit_um, 100u);
}

TEST_F(D400, ItsOwnCalibrationTakesThePlaceOfTheFiles) {
  sensing::Camera wanted = described();
  wanted.device.own_lens = true;
  wanted.distortion = {0.1, 0, 0, 0, 0};
  {
    const auto source = open(wanted);
    const sensing::Camera& found = source->cameras()[0];
    EXPECT_EQ(found.fx, 390.5);
    EXPECT_EQ(found.fy, 391.5);
    EXPECT_EQ(found.cx, 319.25);
    EXPECT_EQ(found.cy, 241.75);
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
  sensing::Camera wanted = described();
  for (const auto& [unit_m, told] : {std::pair(62.5e-6, "is 62.5 micrometres; set depth_unit_m = 6.3e-05"),
                                     {100.4e-6, "is 100.4 micrometres; set depth_unit_m = 0.0001"},
                                     {0.3e-6, "is 0.3 micrometres; set depth_unit_m = 1e-06"}}) {
    wanted.depth_unit_m = unit_m;
    EXPECT_CONTAINS(refusal(wanted), told);
    EXPECT_EQ(held.unit_um, 1000u) << "nothing is written";
  }
  wanted.depth_unit_m = 63e-6;
  open(wanted);
  EXPECT_EQ(held.unit_um, 63u);
}

TEST_F(D400, AnotherLensUnderTheSameNameIsAnotherCamera) {
  sensing::Camera wanted = described();
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
  machine.unplug("/dev/video0");
  held.fx = 401;
  const std::string said = stderr_of([&] {
    comes(0.5);
    machine.plug("/dev/video0", camera);
    EXPECT_FALSE(comes(4));
  });
  EXPECT_CONTAINS(said,
                  "camera 'left' cannot be opened again: /dev/video0: its lens has changed: this is not the camera");
  EXPECT_EQ(said.find("not the camera"), said.rfind("not the camera"));
  held.fx = 390.5f;
  EXPECT_CONTAINS(stderr_of([&] { EXPECT_TRUE(comes(2)); }), "is back");
}

TEST_F(D400, ExposureAndPresetAreSetWhereTheRigSaysSo) {
  open(described());
  EXPECT_EQ(held.automatic, 1);
  EXPECT_EQ(held.preset, 0);
  sensing::Camera wanted = described();
  wanted.device.exposure_s = 0.004;
  wanted.device.preset = 3;
  open(wanted);
  EXPECT_EQ(held.automatic, 0);
  EXPECT_EQ(held.exposure_us, 4000u);
  EXPECT_EQ(held.preset, 3);
  wanted.device.exposure_s = 0;
  open(wanted);
  EXPECT_EQ(held.automatic, 1);
  camera->node.vendor = 0x1234;
  EXPECT_CONTAINS(refusal(wanted), "is not a RealSense on USB: calibration");
}

TEST(CameraDoctor, SaysWhatALabFindsOutTooLate) {
  Machine machine;
  MadeUpD400 coarse, fine;
  fine.unit_um = 100;
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
  MadeUpD400 first, second;
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
  EXPECT_EQ(told.width, 640u);
  EXPECT_EQ(told.rate_hz, 90);
  EXPECT_EQ(told.fx, 390.5);
  EXPECT_EQ(told.cy, 241.75);
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
