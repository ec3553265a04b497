// One depth camera through V4L2: emulated cameras on an emulated clock skip, repeat and break frames, and are rejected.
#include <gtest/gtest.h>
#include <linux/videodev2.h>

#include <cerrno>
#include <cmath>
#include <fstream>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "driver/cameras/made_up_rig.hpp"
#include "driver/v4l2/nodes.hpp"
#include "driver/v4l2/source.hpp"
#include "support/captured.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"
#include "support/watched_heap.hpp"

namespace palpa::driver::v4l2 {
namespace {

using palpa::test::allocations_of;
using palpa::test::error_of;
using palpa::test::stderr_of;
using test::described;
using test::frame_of;
using test::Machine;
using test::MadeUpCamera;
using test::open;
using test::period_s;
using test::Rig;

TEST(V4l2, FramesComeWholeInOrderWithTheirTimes) {
  for (const std::uint32_t padding : {0u, 32u}) {
    Rig rig;
    rig.cameras[0]->padding = padding;
    rig.begin();
    EXPECT_DOUBLE_EQ(rig.source->cameras()[0].rate_hz, 90);
    const std::uint64_t first = frame_of(rig.set.frames[0]);
    for (std::uint64_t i = 0; i < 30; ++i) {
      const std::uint64_t frame = frame_of(rig.set.frames[0]);
      EXPECT_EQ(frame, first + i);
      EXPECT_EQ(rig.set.sequence, i);
      EXPECT_NEAR(rig.set.time_s, static_cast<double>(frame) * period_s, 2e-6);
      EXPECT_EQ(rig.set.frames[0].time_s, rig.set.time_s);
      ASSERT_TRUE(rig.next());
    }
    // Who comes late gets the newest frame.
    rig.machine.pass(rig.machine.now_s + 5 * period_s);
    ASSERT_TRUE(rig.next());
    EXPECT_LT(rig.machine.now_s - rig.set.time_s, period_s + 1e-6);
    EXPECT_EQ(rig.set.sequence, 30u + 5);
  }
}

TEST(V4l2, StampsOfAnotherClockAreReplacedByTheArrival) {
  Rig rig;
  rig.cameras[0]->monotonic = false;
  rig.begin();
  EXPECT_EQ(rig.set.time_s, rig.machine.now_s);
}

TEST(V4l2, AllocatesNothingPerFrame) {
  Rig rig(2);
  rig.cameras[1]->phase_s = 0.003;
  rig.begin();
  rig.machine.pass(rig.machine.now_s + 1e-4);
  for (int i = 0; i < 50; ++i) {
    rig.machine.pass(rig.machine.now_s + period_s);
    EXPECT_EQ(allocations_of([&] { rig.source->next(rig.set, 0); }), 0u);
    ASSERT_EQ(rig.set.frames.size(), 2u);
    // The same if no set came in time.
    EXPECT_EQ(allocations_of([&] { rig.source->next(rig.set, 0); }), 0u);
    ASSERT_TRUE(rig.set.frames.empty());
  }
}

TEST(V4l2, FramesThatWereSkippedAreGaps) {
  Rig rig(2);
  rig.begin();
  const std::uint64_t next = rig.cameras[0]->next;
  rig.cameras[0]->skipped = {next + 3, next + 4};
  rig.cameras[1]->skipped = {rig.cameras[1]->next + 7};
  std::vector<std::uint64_t> sequences;
  const std::string said = stderr_of([&] {
    for (int i = 0; i < 12; ++i) {
      ASSERT_TRUE(rig.next());
      sequences.push_back(rig.set.sequence);
      EXPECT_EQ(frame_of(rig.set.frames[0]), frame_of(rig.set.frames[1])) << "both run at once";
    }
  });
  EXPECT_EQ(sequences, (std::vector<std::uint64_t>{1, 2, 3, 6, 7, 9, 10, 11, 12, 13, 14, 15}));
  EXPECT_EQ(said, "");
}

TEST(V4l2, BrokenFramesAreLeftOutAndSaidOnce) {
  Rig rig;
  MadeUpCamera& camera = *rig.cameras[0];
  rig.begin();
  const std::uint64_t from = camera.next;
  camera.cut = {from + 1, from + 5, from + 9};
  camera.damaged = {from + 2, from + 6, from + 10};
  camera.repeated = {from + 4, from + 8, from + 12};
  const std::string said = stderr_of([&] {
    double last_s = rig.set.time_s;
    for (int i = 0; i < 30; ++i) {
      ASSERT_TRUE(rig.next());
      const std::uint64_t frame = frame_of(rig.set.frames[0]);
      EXPECT_FALSE(camera.cut.contains(frame) || camera.damaged.contains(frame) || camera.repeated.contains(frame));
      EXPECT_GT(rig.set.time_s, last_s);
      last_s = rig.set.time_s;
    }
  });
  EXPECT_CONTAINS(said, "camera 'camera 1' (/dev/video0): 5 frames arrived incomplete, damaged or twice");
  EXPECT_EQ(said.find("frames arrived"), said.rfind("frames arrived"));
}

TEST(V4l2, ACameraThatStopsOrFailsKeepsNobodyLongerThanAskedAndNoProcessorBusy) {
  for (const bool fails : {false, true}) {
    Rig rig;
    rig.begin();
    rig.cameras[0]->frozen = !fails;
    rig.cameras[0]->failing = fails;
    const std::uint64_t before = rig.machine.calls;
    stderr_of([&] {
      for (int buffers = 0; buffers < 10 && rig.next(); ++buffers) {  // the buffers that it has are still filled
      }
      for (int i = 0; i < 100; ++i) {
        const double begin_s = rig.machine.now_s;
        EXPECT_FALSE(rig.next());
        EXPECT_LT(rig.machine.now_s - begin_s, 0.11);
      }
    });
    EXPECT_LT(rig.machine.calls - before, 150000u) << "in ten seconds";
  }
}

TEST(V4l2, NothingStaysOpenOrMapped) {
  Machine machine;
  machine.plug("/dev/video0", "A");
  {
    const auto source = open(machine, {"/dev/video0"});
    EXPECT_EQ(machine.open_descriptors, 1);
    EXPECT_GE(machine.mapped, 3);
  }
  EXPECT_EQ(machine.open_descriptors, 0);
  EXPECT_EQ(machine.mapped, 0);
  machine.plugged["/dev/video0"]->refuses_to_start = EIO;
  EXPECT_REFUSED(open(machine, {"/dev/video0"}), "/dev/video0: the camera does not start");
  EXPECT_EQ(machine.open_descriptors, 0);
  EXPECT_EQ(machine.mapped, 0);
}

TEST(V4l2, WorkBesideRunsOnAnotherThread) {
  const auto kernel = make_kernel();
  std::thread::id other;
  kernel->beside([&] { other = std::this_thread::get_id(); }).get();
  EXPECT_NE(other, std::thread::id());
  EXPECT_NE(other, std::this_thread::get_id());
}

TEST(V4l2, RefusalsNameTheDeviceTheFormatAndWhatWouldBeRight) {
  Machine machine;
  const auto camera = machine.plug("/dev/video0", "A");
  sensing::Camera wanted = described("left");
  const auto refuses = [&](const std::string& part) {
    const std::string line = error_of([&] { open(machine, {"/dev/video0"}, {wanted}); });
    EXPECT_TRUE(line.starts_with("/dev/video0: ")) << line;
    EXPECT_CONTAINS(line, part);
    EXPECT_EQ(machine.open_descriptors, 0);
  };
  const std::string sizes = "does not offer Z16 of 65x48; it has 64x48, 128x72";
  wanted.width = 65;
  refuses(sizes + ": set width and height of rig.toml to one of these");
  camera->refuses_format = EINVAL;
  refuses(sizes);
  camera->refuses_format = 0;
  wanted = described("left");
  wanted.rate_hz = 75;
  refuses("does not offer Z16 64x48 at 75 Hz; it has 90, 60, 30, 6 Hz: set rate_hz of rig.toml to one of these");
  wanted = described("left");
  const std::string permission = "no permission: add yourself to the group video";
  const std::string missing = "there is no such camera", used = "another program uses this camera";
  const std::string other = "the camera accepts no format: Input/output error";
  const std::pair<int, std::string> faults[] = {
      {EBUSY, used}, {EACCES, permission}, {EPERM, permission}, {ENODEV, missing}, {EIO, other}};
  for (const auto& [fault, told] : faults) {
    camera->refuses_format = fault;
    refuses(told);
  }
  camera->refuses_format = 0;
  camera->metadata = true;
  refuses("metadata, not its images");
  camera->metadata = false;
  camera->offers = {{V4L2_PIX_FMT_YUYV, 64, 48, 30}, {V4L2_PIX_FMT_GREY, 64, 48, 30}};
  refuses("does not give depth, which is the format Z16, but YUYV, GREY");
  camera->refuses_to_open = EACCES;
  refuses(permission);
  camera->refuses_to_open = EBUSY;
  refuses(used);
  machine.unplug("/dev/video0");
  refuses(missing + "; palpa doctor lists what is plugged in");
}

TEST(V4l2, TheArgumentNamesOneNodePerCamera) {
  EXPECT_EQ(parse_nodes("/dev/video0,/dev/video2"), (std::vector<std::string>{"/dev/video0", "/dev/video2"}));
  for (const char* bad : {"", ",", "/dev/video0,", "/dev/video0,,/dev/video1"})
    EXPECT_ERROR(parse_nodes(bad), Exit::usage, "v4l2:/dev/video0");
  EXPECT_ERROR(parse_nodes("/dev/video0,/dev/video0"), Exit::usage, "twice");
  Machine machine;
  machine.plug("/dev/video0", "A");
  const auto two = [&] { open(machine, {"/dev/video0"}, {described("left"), described("right")}); };
  EXPECT_CONTAINS(error_of(two, Exit::usage), "names 1 camera, but rig.toml describes 2");
  EXPECT_CONTAINS(error_of(two, Exit::usage), "palpa doctor --write-rig FILE writes a rig for the cameras");
  machine.links["/dev/v4l/by-id/usb-A"] = "/dev/video0";
  const std::vector<std::string> one_twice{"/dev/v4l/by-id/usb-A", "/dev/video0"};
  EXPECT_ERROR(open(machine, one_twice), Exit::usage,
               "names one camera twice: /dev/v4l/by-id/usb-A and /dev/video0 are both /dev/video0");
  EXPECT_EQ(machine.open_descriptors, 0);
}

TEST(V4l2, ACoarseDepthUnitIsWarnedOf) {
  Machine machine;
  machine.plug("/dev/video0", "A");
  sensing::Camera coarse = described("left");
  coarse.depth_unit_m = 0.001;
  const std::string said = stderr_of([&] { open(machine, {"/dev/video0"}, {coarse}); });
  EXPECT_CONTAINS(said, "rig.toml: camera 'left' has a depth unit of 1 mm");
  EXPECT_EQ(stderr_of([&] { open(machine, {"/dev/video0"}); }), "");
}

TEST(V4l2Nodes, AreReadFromSysfs) {
  namespace fs = std::filesystem;
  const fs::path sys = palpa::test::scratch_folder("v4l2-sys");
  const fs::path device = sys / "devices/pci0000:00/0000:00:14.0/usb2/2-1/2-1.4";
  const fs::path classes = sys / "class/video4linux";
  fs::create_directories(classes);
  const auto write = [](const fs::path& file, const std::string& text) { std::ofstream(file) << text << '\n'; };
  for (const auto& [name, index] : {std::pair("video10", "0"), {"video2", "1"}}) {
    fs::create_directories(device / "2-1.4:1.0/video4linux" / name);
    fs::create_symlink(device / "2-1.4:1.0/video4linux" / name, classes / name);
    fs::create_symlink(device / "2-1.4:1.0", classes / name / "device");
    write(classes / name / "name", "Intel RealSense D415");
    write(classes / name / "index", index);
  }
  fs::create_directories(classes / "v4l-subdev0");
  fs::create_directories(classes / "video3");  // such as a loopback: it has no device
  write(device / "idVendor", "8086");
  write(device / "idProduct", "0ad3");
  write(device / "serial", "728612070259");
  write(device / "speed", "5000");
  const std::vector<Node> nodes = find_nodes(sys);
  ASSERT_EQ(nodes.size(), 3u);
  EXPECT_EQ(nodes[0].path, "/dev/video2");
  EXPECT_EQ(nodes[1].path, "/dev/video3");
  EXPECT_EQ(nodes[1].place, "");
  const Node& node = nodes[2];
  EXPECT_EQ(node.path, "/dev/video10");
  EXPECT_EQ(node.name, "Intel RealSense D415");
  EXPECT_EQ(node.index, 0u);
  EXPECT_EQ(node.interface, "2-1.4:1.0");
  EXPECT_EQ(node.place, "2-1.4");
  EXPECT_EQ(node.bus, "usb2");
  EXPECT_EQ(node.controller, "0000:00:14.0");
  EXPECT_EQ(node.serial, "728612070259");
  EXPECT_EQ(node.vendor, 0x8086);
  EXPECT_EQ(node.product, 0x0ad3);
  EXPECT_EQ(node.mbit_s, 5000);
}

TEST(V4l2Nodes, ACameraIsKnownBySerialNumberElseByPort) {
  const auto node = [](const char* path, const char* place, const char* serial, unsigned index = 0) {
    return Node{
        .path = path, .index = index, .interface = std::string(place) + ":1.0", .place = place, .serial = serial};
  };
  const Identity known{"/dev/video0", node("/dev/video0", "2-1", "A")};
  const std::vector<Node> moved{node("/dev/video0", "2-1", "B"), node("/dev/video1", "2-3", "A", 1),
                                node("/dev/video4", "2-3", "A")};
  EXPECT_EQ(find_again(known, moved), "/dev/video4");
  EXPECT_EQ(find_again(known, std::span(moved).first(2)), "");
  // Two with the same serial number: the one on the right port.
  const std::vector<Node> twins{node("/dev/video2", "2-2", "A"), node("/dev/video6", "2-1", "A")};
  EXPECT_EQ(find_again(known, twins), "/dev/video6");
  // Without serial numbers, only the port identifies it.
  const Identity nameless{"/dev/video0", node("/dev/video0", "2-1", "")};
  EXPECT_EQ(find_again(nameless, std::vector{node("/dev/video2", "2-2", "")}), "");
  EXPECT_EQ(find_again(nameless, std::vector{node("/dev/video3", "2-1", "")}), "/dev/video3");
  EXPECT_EQ(find_again({"/dev/depth", {}}, moved), "/dev/depth");
}

}  // namespace
}  // namespace palpa::driver::v4l2
