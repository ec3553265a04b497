// Depth cameras through librealsense2, as far as this can be tested without one: an emulated SDK on an emulated clock.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "driver/cameras/made_up_sdk.hpp"
#include "driver/cameras/match.hpp"
#include "driver/realsense/source.hpp"
#include "driver/realsense/stream.hpp"
#include "support/captured.hpp"
#include "support/thrown.hpp"

namespace palpa::driver::realsense {
namespace {

using palpa::test::error_of;
using palpa::test::stderr_of;
using test::Bench;
using test::MadeUpCamera;
using test::pixel_of;

constexpr double period_s = 1.0 / 90;

sensing::Camera described(const std::string& name) {
  sensing::Camera camera;
  camera.name = name;
  camera.width = 64;
  camera.height = 48;
  camera.fx = camera.fy = 40;
  camera.depth_unit_m = 0.0001;
  camera.rate_hz = 90;
  return camera;
}

std::unique_ptr<sensing::DepthSource> open(Bench& bench, const std::string& serials,
                                           std::vector<sensing::Camera> cameras = {described("one")}) {
  return open_cameras(std::make_unique<test::MadeUpHost>(bench), std::make_shared<test::MadeUpSdk>(bench),
                      std::move(cameras), serials, "rig.toml");
}

/// Gets the next set whose first image is a whole frame; returns its number.
std::uint64_t next_frame(sensing::DepthSource& source, sensing::FrameSet& set) {
  EXPECT_TRUE(source.next(set, 0.1));
  if (set.frames.empty()) return 0;
  const std::uint64_t frame = set.frames[0].depth[0] - 1u;
  for (std::uint32_t i = 0; i < set.frames[0].depth.size(); ++i) {
    EXPECT_EQ(set.frames[0].depth[i], pixel_of(frame, i));
    if (set.frames[0].depth[i] != pixel_of(frame, i)) break;
  }
  return frame;
}

TEST(RealSense, FramesComeWholeInOrderWithTheTimeOfTheirCapture) {
  for (const std::uint32_t padding : {0u, 32u}) {
    Bench bench;
    MadeUpCamera& camera = bench.plug("A");
    camera.padding = padding;
    {
      const auto source = open(bench, "A");
      EXPECT_DOUBLE_EQ(source->cameras()[0].rate_hz, 90);
      sensing::FrameSet set;
      std::uint64_t before = 0;
      for (int i = 0; i < 40; ++i) {
        const std::uint64_t frame = next_frame(*source, set);
        if (i > 0) {
          EXPECT_EQ(frame, before + 1);
        }
        before = frame;
        EXPECT_NEAR(set.time_s, static_cast<double>(frame) * period_s, 1e-6) << "not when it arrived, 4 ms later";
      }
      EXPECT_LE(camera.given, 3) << "the SDK has few frames";
    }
    EXPECT_EQ(camera.given, 0);
    EXPECT_FALSE(camera.taker);
  }
}

TEST(RealSense, StampsOfTheCamerasOwnClockOrOfAClockThatWasSetAreNone) {
  for (const double ahead_s : {0.0, 3600.0, -3600.0}) {
    Bench bench;
    MadeUpCamera& camera = bench.plug("A");
    if (ahead_s == 0) camera.options.erase(Option::global_time);
    camera.clock_ahead_s = ahead_s;
    const auto source = open(bench, "A");
    sensing::FrameSet set;
    for (int i = 0; i < 20; ++i) {
      const std::uint64_t frame = next_frame(*source, set);
      const double captured_s = static_cast<double>(frame) * period_s;
      EXPECT_GE(set.time_s, captured_s + camera.delay_s - 1e-9);
      EXPECT_LT(set.time_s, captured_s + camera.delay_s + 2e-3);
    }
  }
}

TEST(RealSense, IsSetUpAsTheRigSays) {
  Bench bench;
  MadeUpCamera& camera = bench.plug("A");
  camera.lens.distortion = {0.1, -0.2, 0.001, 0.002, 0.03};
  sensing::Camera wanted = described("one");
  wanted.device = {.own_lens = true, .exposure_s = 0.004, .preset = 3};
  const auto source = open(bench, "any", {wanted});
  const std::vector<std::pair<Option, double>> expected{{Option::hardware_preset, 3},
                                                        {Option::automatic_exposure, 0},
                                                        {Option::exposure_s, 0.004},
                                                        {Option::global_time, 1},
                                                        {Option::depth_unit_m, 0.0001}};
  EXPECT_EQ(camera.set, expected);
  const sensing::Camera& found = source->cameras()[0];
  EXPECT_EQ(found.fx, 50);
  EXPECT_EQ(found.fy, 50.5);
  EXPECT_EQ(found.cx, 31.5);
  EXPECT_EQ(found.cy, 23.5);
  EXPECT_EQ(found.distortion, camera.lens.distortion);
  EXPECT_EQ(camera.streamed.rate_hz, 90);
}

TEST(RealSense, WithoutARateTheQuickestAndWithoutAWordAsItIs) {
  Bench bench;
  MadeUpCamera& camera = bench.plug("A");
  sensing::Camera wanted = described("one");
  wanted.rate_hz = 0;
  wanted.depth_unit_m = 0.001;
  stderr_of([&] { open(bench, "A", {wanted}); });
  EXPECT_EQ(camera.streamed.rate_hz, 90);
  EXPECT_EQ(camera.set, (std::vector<std::pair<Option, double>>{{Option::global_time, 1}}));
}

TEST(RealSense, RefusesWithOneLineThatSaysWhatWouldBeRight) {
  Bench bench;
  MadeUpCamera& camera = bench.plug("A");
  sensing::Camera wanted = described("one");
  const auto refuses = [&](const char* part, const std::string& serials = "A", Exit code = Exit::bad_input) {
    EXPECT_ERROR(open(bench, serials, {wanted}), code, part);
    wanted = described("one");
  };
  wanted.width = 640;
  refuses(
      "realsense:A: does not offer Z16 of 640x48; it has 64x48, 128x72: set width and height of rig.toml to one of "
      "these");
  wanted.rate_hz = 60;
  refuses("realsense:A: does not offer Z16 64x48 at 60 Hz; it has 90, 30 Hz: set rate_hz of rig.toml to one of these");
  refuses("realsense:B: is not plugged in; librealsense2 finds A", "B");
  refuses("source realsense names A twice", "A,A", Exit::usage);
  refuses("source realsense names 2 cameras, but rig.toml describes 1", "A,B", Exit::usage);
  refuses("source realsense needs cameras: realsense:SERIAL or realsense:any", "", Exit::usage);
  camera.keeps_unit = true;
  refuses("realsense:A: keeps its depth unit of 1 mm (librealsense2: read-only); set depth_unit_m = 0.001 in rig.toml");
  camera.keeps_unit = false;
  camera.options.erase(Option::hardware_preset);
  wanted.device.preset = 3;
  refuses("realsense:A: has no hardware preset, which hardware_preset of rig.toml would set");
  const auto other = open(bench, "A");
  refuses("realsense:A: the camera does not start to stream: librealsense2: failed to set");
  bench.plug("B");
  refuses("source realsense: 2 cameras are plugged in; name the rig's cameras, in the rig's order: realsense:A,B",
          "any", Exit::usage);
  bench.unplug("A");
  bench.unplug("B");
  refuses("realsense:any: librealsense2 finds no camera", "any");
}

TEST(RealSense, UnpluggedItIsFoundAgainByItsSerialNumberUnlessItsLensHasChanged) {
  Bench bench;
  MadeUpCamera& camera = bench.plug("A");
  bench.plug("B");
  sensing::Camera wanted = described("a");
  wanted.device.own_lens = true;
  const auto source = open(bench, "B,A", {described("b"), wanted});
  sensing::FrameSet set;
  ASSERT_GT(next_frame(*source, set), 0u);
  const double begin_s = bench.now_s;
  bench.later = {{begin_s + 1, [&] { bench.unplug("A"); }},
                 {begin_s + 2, [&] { camera.plugged = true, camera.lens.fx += 1; }},
                 {begin_s + 6, [&] { camera.lens.fx -= 1; }}};
  std::uint64_t alone = 0;
  const std::string said = stderr_of([&] {
    while (bench.now_s < begin_s + 8) {
      ASSERT_GT(next_frame(*source, set), 0u);
      alone += set.frames[1].depth[0] == 0;
    }
  });
  EXPECT_GT(alone, 430u);
  EXPECT_LT(alone, 480u);
  EXPECT_GT(set.frames[1].depth[0], 0) << "it is back";
  EXPECT_EQ(camera.starts, 2u);
  EXPECT_CONTAINS(said, "camera 'a' (realsense:A): unplugged; palpa continues without it");
  EXPECT_CONTAINS(said,
                  "camera 'a' cannot be opened again: realsense:A: its lens has changed: the camera was recalibrated");
  EXPECT_CONTAINS(said, "camera 'a' (realsense:A): is back");
  EXPECT_LE(camera.given, 3);
}

TEST(RealSense, ShortFramesAreLeftOutAndTheirMemoryIsGivenBack) {
  Bench bench;
  MadeUpCamera& camera = bench.plug("A");
  const auto source = open(bench, "A");
  sensing::FrameSet set;
  const std::uint64_t first = next_frame(*source, set);
  for (std::uint64_t frame = first + 1; frame < first + 80; frame += 2)
    camera.cut.insert(frame);
  stderr_of([&] {
    for (std::uint64_t frame = first + 2; frame < first + 80; frame += 2)
      EXPECT_EQ(next_frame(*source, set), frame);
  });
  EXPECT_LE(camera.given, 3);
}

TEST(RealSense, OfFramesThatNobodyTookTheNewestStay) {
  Bench bench;
  MadeUpCamera& camera = bench.plug("A");
  const auto source = open(bench, "A");
  sensing::FrameSet set;
  ASSERT_GT(next_frame(*source, set), 0u);
  for (int i = 0; i < 1000; ++i)
    bench.step();
  EXPECT_LE(camera.given, 8) << "the SDK has no more than sixteen to give";
  const std::uint64_t newest = camera.next - 1;
  EXPECT_EQ(next_frame(*source, set), newest);
}

TEST(RealSense, WithoutTheSdkTheLineSaysWhatToDo) {
#ifdef PALPA_WITH_REALSENSE
  GTEST_SKIP() << "skipped: this palpa is built with librealsense2";
#else
  const std::vector<sensing::Camera> cameras{described("one")};
  const geometry::Mesh none;
  EXPECT_CONTAINS(
      error_of([&] { source_kind().open("any", {.cameras = cameras, .occluders = none, .default_skin = {}}); },
               Exit::usage),
      "built without librealsense2; use v4l2:/dev/videoN, which needs no SDK, or install librealsense2");
#endif
}

}  // namespace
}  // namespace palpa::driver::realsense
