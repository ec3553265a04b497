// RealSense Viewer's recordings: bags as it writes them, and bags that are cut or broken.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "base/text.hpp"
#include "driver/cameras/made_up_bag.hpp"
#include "driver/rosbag/source.hpp"
#include "sensing/grey_png.hpp"
#include "support/captured.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::driver::rosbag {
namespace {

using palpa::test::error_of;
using palpa::test::stderr_of;
using test::Bytes;
using test::MadeUpBag;
using test::put_bytes;
using test::Record;

std::string written(const Bytes& bytes) {
  static const std::filesystem::path folder = palpa::test::scratch_folder("bags");
  const std::filesystem::path file = folder / "take.bag";
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  return file.string();
}

sensing::Camera posed() {
  sensing::Camera camera;
  camera.name = "above";
  camera.width = 16;
  camera.height = 8;
  camera.min_range_m = 0.28;
  camera.T_world_camera[3] = {1, 2, 3, 1};
  camera.roi = {1, 1, 5, 5};
  return camera;
}

/// All its frames, as fast as they are requested.
std::vector<sensing::FrameSet> play(const Bytes& bytes, const sensing::Camera& camera = posed()) {
  const auto source = open_bag(written(bytes), &camera, false);
  std::vector<sensing::FrameSet> sets;
  for (sensing::FrameSet set; source->next(set, 0.1);)
    sets.push_back(set);
  return sets;
}

/// Plays a bag and returns what is printed meanwhile.
std::string said_of(const Bytes& bytes, std::size_t frames) {
  return stderr_of([&] { EXPECT_EQ(play(bytes).size(), frames); });
}

Bytes cut_to(const Bytes& bytes, std::size_t count) {
  return {bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(count)};
}

TEST(Bag, FramesComeWithTheirTimesAndTheCameraOfTheBag) {
  const sensing::Camera camera = posed();
  for (const char* compression : {"lz4", "none"}) {
    for (const std::uint32_t padding : {0u, 6u}) {
      MadeUpBag bag;
      bag.compression = compression;
      bag.padding = padding;
      const auto source = open_bag(written(bag.bytes()), &camera, false);
      ASSERT_EQ(source->cameras().size(), 1u);
      const sensing::Camera& found = source->cameras()[0];
      EXPECT_EQ(found.name, "above");
      EXPECT_EQ(found.width, 16u);
      EXPECT_EQ(found.height, 8u);
      EXPECT_EQ(found.fx, 40);
      EXPECT_EQ(found.fy, 41);
      EXPECT_EQ(found.cx, 8);
      EXPECT_EQ(found.cy, 4);
      EXPECT_EQ(found.depth_unit_m, 0.0001);
      EXPECT_EQ(found.rate_hz, 30);
      EXPECT_EQ(found.min_range_m, 0.28);
      EXPECT_EQ(found.T_world_camera[3].y, 2);
      EXPECT_TRUE(found.roi.has_value());
      sensing::FrameSet set;
      for (std::size_t i = 0; i < bag.times_s.size(); ++i) {
        ASSERT_TRUE(source->next(set, 0));
        ASSERT_EQ(set.frames.size(), 1u);
        EXPECT_EQ(set.sequence, i);
        EXPECT_NEAR(set.time_s, bag.times_s[i], 2e-9);
        for (std::uint32_t p = 0; p < 16 * 8; ++p)
          ASSERT_EQ(set.frames[0].depth[p], MadeUpBag::depth_of(i, p));
      }
      EXPECT_FALSE(source->next(set, 0));
      EXPECT_FALSE(source->next(set, 0));
    }
  }
}

TEST(Bag, ComesInRealTimeAndLeavesLateFramesOut) {
  using Clock = std::chrono::steady_clock;
  const sensing::Camera camera = posed();
  MadeUpBag bag;
  bag.times_s = {5, 5.01, 5.02, 5.03, 1005};
  const auto late = open_bag(written(bag.bytes()), &camera, true);
  sensing::FrameSet set;
  ASSERT_TRUE(late->next(set, 0.1));
  EXPECT_EQ(set.sequence, 0u);
  std::this_thread::sleep_for(std::chrono::milliseconds(60));
  ASSERT_TRUE(late->next(set, 0.1));
  EXPECT_EQ(set.sequence, 3u) << "the newest that is due";
  ASSERT_TRUE(late->next(set, 0.02));
  EXPECT_TRUE(set.frames.empty()) << "not due yet";

  bag.times_s = {5, 5.1};
  const auto waited_for = open_bag(written(bag.bytes()), &camera, true);
  const auto begin = Clock::now();
  ASSERT_TRUE(waited_for->next(set, 0.1));
  do {
    ASSERT_TRUE(waited_for->next(set, 0.02));
  } while (set.frames.empty());
  EXPECT_EQ(set.sequence, 1u);
  EXPECT_GE(std::chrono::duration<double>(Clock::now() - begin).count(), 0.1);
  EXPECT_FALSE(waited_for->next(set, 0.1));
}

TEST(Bag, WithoutAPoseTheCameraStandsAtTheOriginAndThatIsSaid) {
  const std::string said = stderr_of([] {
    const auto source = open_bag(written(MadeUpBag().bytes()), nullptr, false);
    EXPECT_EQ(source->cameras()[0].name, "/device_0/sensor_0");
    EXPECT_EQ(source->cameras()[0].T_world_camera, Transform(1.0));
  });
  EXPECT_CONTAINS(said, "give --rig with one [[camera]]");
  EXPECT_CONTAINS(said, "palpa doctor --write-rig rig.toml --source bag:");
  EXPECT_CONTAINS(said, "palpa calibrate --rig rig.toml --source bag:");
}

TEST(Bag, MissingPartsAreReportedOrRefused) {
  MadeUpBag bag;
  bag.unit = false;
  EXPECT_CONTAINS(said_of(bag.bytes(), 4), "palpa assumes 1 mm");
  bag.lens = false;
  EXPECT_REFUSED(play(bag.bytes()), "before the camera_info");
  bag = {};
  bag.times_s.clear();
  EXPECT_REFUSED(play(bag.bytes()), "has no depth of a RealSense");
}

TEST(Bag, ALensThatCannotBeIsWarnedOf) {
  MadeUpBag bag;
  bag.fx = 1.9;
  EXPECT_CONTAINS(said_of(bag.bytes(), 4), "take.bag: its camera: fx = 1.9 makes the picture 153 degrees wide");
}

TEST(Bag, OfSeveralCamerasTheOneWhoseImageIsFirstIsPlayedWithItsOwnLensUnitAndRate) {
  MadeUpBag other;
  other.width = 24;
  other.height = 12;
  other.unit_m = 0.0005f;
  other.rate_hz = 15;
  other.fx = 60;
  MadeUpBag bag;
  bag.other = &other;
  for (const bool second : {false, true}) {
    bag.other_first = second;
    const std::string said = stderr_of([&] {
      const auto source = open_bag(written(bag.bytes()), nullptr, false);
      const sensing::Camera& found = source->cameras().at(0);
      EXPECT_EQ(found.name, second ? "/device_1/sensor_0" : "/device_0/sensor_0");
      EXPECT_EQ(std::pair(found.width, found.height), second ? std::pair(24u, 12u) : std::pair(16u, 8u));
      EXPECT_EQ(std::pair(found.fx, found.cx), second ? std::pair(60.0, 12.0) : std::pair(40.0, 8.0));
      EXPECT_EQ(found.depth_unit_m, second ? 0.0005 : 0.0001);
      EXPECT_EQ(found.rate_hz, second ? 15 : 30);
      sensing::FrameSet set;
      for (std::size_t i = 0; i < bag.times_s.size(); ++i) {
        ASSERT_TRUE(source->next(set, 0));
        EXPECT_EQ(set.frames[0].depth.at(95), MadeUpBag::depth_of(second ? i + 20 : i, 95));
      }
      EXPECT_FALSE(source->next(set, 0));
    });
    EXPECT_CONTAINS(said, std::string("has several depth cameras; /device_") + (second ? "1" : "0") +
                              "/sensor_0/Depth_0/image/data is played");
  }
}

TEST(Bag, EveryFrameIsPlayedWhenItsClockSteps) {
  const struct {
    std::vector<double> stamps_s, times_s;
    const char* said;
  } cases[] = {
      {{1, 1.1, 1.2, 1, 1.1, 1.2}, {1, 1.1, 1.2, 1.3, 1.4, 1.5}, "steps back by 0.2 s after 3 depth frames"},
      {{9, 1, 1.1, 1.2}, {9, 9.1, 9.2, 9.3}, "steps back by 8 s after 1 depth frame"},
      {{1, 1.1, 0.5, 1.3, 1.4}, {1, 1.1, 1.2, 1.3, 1.4}, "steps back by 0.6 s"},
      {{1, 1.1, 1.1, 1.2}, {1, 1.1, 1.2, 1.3}, "stands still after 2 depth frames"},
      {{1, 1.1, 90'000, 90'000.1, 1.4}, {1, 1.1, 1.2, 1.3, 1.4}, "steps forward by 9e+04 s"},
      {{1, 1.1, 30, 30.1}, {1, 1.1, 30, 30.1}, nullptr},
  };
  for (const auto& one : cases) {
    MadeUpBag bag;
    bag.rate_hz = 10;
    bag.times_s = one.stamps_s;
    std::vector<sensing::FrameSet> sets;
    const std::string said = stderr_of([&] { sets = play(bag.bytes()); });
    if (one.said) {
      EXPECT_CONTAINS(said, std::string("take.bag: its clock ") + one.said);
      EXPECT_CONTAINS(said, "continues their times at 10 Hz from there");
    } else {
      EXPECT_EQ(said, "");
    }
    ASSERT_EQ(sets.size(), one.times_s.size());
    for (std::size_t i = 0; i < sets.size(); ++i) {
      EXPECT_EQ(sets[i].sequence, i);
      EXPECT_NEAR(sets[i].time_s, one.times_s[i], 1e-6) << i;
      EXPECT_EQ(sets[i].frames[0].depth[3], MadeUpBag::depth_of(i, 3));
    }
  }
}

TEST(Bag, TheDepthUnitHasEitherNameAndMayNotChange) {
  const sensing::Camera camera = posed();
  MadeUpBag bag;
  for (const char* name : {"Depth Units", "Depth_Units"}) {
    bag.unit_topic = fmt::format("/device_0/sensor_0/option/{}/value", name);
    EXPECT_EQ(open_bag(written(bag.bytes()), &camera, false)->cameras()[0].depth_unit_m, 0.0001) << name;
  }
  bag.last_unit_m = bag.unit_m;
  EXPECT_EQ(play(bag.bytes()).size(), 4u) << "said again";
  bag.last_unit_m = 0.001f;
  EXPECT_REFUSED(play(bag.bytes()), "changes to 0.001 m after an image with 0.0001 m");
}

TEST(Bag, ARoiOrABackgroundOfOtherImagesIsRefused) {
  MadeUpBag bag;
  bag.width = 20;
  EXPECT_REFUSED(play(bag.bytes()), "the rig's roi, mask and background are for 16x8: leave them out of the rig");
  sensing::Camera camera = posed();
  const std::vector<std::uint16_t> depth(sensing::pixel_count(camera), 5000);
  camera.background = std::make_shared<sensing::Background>(sensing::Background{"empty.png", depth, 0.003});
  camera.depth_unit_m = 1e-4;
  EXPECT_FALSE(play(MadeUpBag().bytes(), camera).empty());
  camera.depth_unit_m = 1e-3;
  EXPECT_REFUSED(play(MadeUpBag().bytes(), camera),
                 "has depths in steps of 0.0001 m, but the rig's background has steps of 0.001 m");
}

TEST(Bag, WhatItCannotReadIsRefused) {
  const std::pair<std::function<void(MadeUpBag&)>, const char*> cases[] = {
      {[](auto& b) { b.compression = "bz2"; }, "compressed with bz2; palpa reads only lz4 and none"},
      {[](auto& b) { b.encoding = "rgb8"; },
       "topic /device_0/sensor_0/Depth_0/image/data: depth has the encoding 'rgb8'"},
      {[](auto& b) { b.width = 5000; }, "an image has 5000x8 pixels"},
      {[](auto& b) { b.fx = -1; }, "focal length is -1"},
      {[](auto& b) { b.fx = std::nan(""); }, "focal length is nan"},
      {[](auto& b) { b.unit_m = 0; }, "the depth unit in metres is 0"},
      {[](auto& b) { b.rate_hz = 5000; }, "5000 frames per second"},
      {[](auto& b) { b.lens_model = "Kannala Brandt4", b.distortion[0] = 0.1; }, "lens model is 'Kannala Brandt4'"},
      {[](auto& b) { b.more_topic = std::string(300, 'x'); }, "a topic has a name of 300 bytes"},
      {[](auto& b) { b.more_topic = std::string(70'000, 'x'); }, "a record's header has 70"},
      {[](auto& b) { b.distortion[0] = -50; }, "cannot be undone"},
      {[](auto& b) { b.missing = 2; }, "a depth image of 16x8 has only 254 bytes"},
  };
  for (const auto& [change, part] : cases) {
    MadeUpBag bag;
    change(bag);
    const std::string line = error_of([&] { play(bag.bytes()); });
    EXPECT_CONTAINS(line, "take.bag: byte ");
    EXPECT_CONTAINS(line, part);
  }
  EXPECT_REFUSED(open_bag("/nonexistent.bag", nullptr, false), "/nonexistent.bag: no such file");
  EXPECT_REFUSED(open_bag("/dev/zero", nullptr, false), "/dev/zero: is not a regular file");
  EXPECT_REFUSED(open_bag("/dev", nullptr, false), "/dev: is a folder, a file is needed");
  EXPECT_REFUSED(play({'#', 'R', 'O', 'S'}),
                 "is neither a database of SQLite nor a bag of format 2.0, which begins with #ROSBAG V2.0");
}

TEST(Bag, ASizeThatItDoesNotHaveCostsNoMemory) {
  for (const std::uint32_t claimed : {0xffffffffu, 0x03ffffffu}) {
    Bytes bytes = MadeUpBag().bytes();
    // The length of the first chunk's packed data; the chunk's header is before it.
    Bytes marker{'s', 'i', 'z', 'e', '='};
    const auto at = std::search(bytes.begin(), bytes.end(), marker.begin(), marker.end()) - bytes.begin() + 5;
    std::memcpy(bytes.data() + at, &claimed, 4);
    EXPECT_REFUSED(play(bytes), claimed > (64u << 20) ? "palpa takes at most" : "lz4 data");
  }
}

TEST(Bag, CutAnywhereItEndsThereOrSaysWhatIsMissing) {
  const Bytes whole = MadeUpBag().bytes();
  std::size_t most = 0;
  stderr_of([&] {
    for (std::size_t length = 0; length < whole.size(); length += 37) {
      const Error error = palpa::test::thrown_by([&] {
        const std::size_t frames = play(cut_to(whole, length)).size();
        EXPECT_GE(frames, most) << "a longer piece shows no fewer";
        most = std::max(most, frames);
      });
      EXPECT_TRUE(error.code() == Exit::ok || error.code() == Exit::bad_input) << error.what();
    }
  });
  EXPECT_EQ(most, 4u);
  const Bytes cut = cut_to(whole, whole.size() - MadeUpBag::index().size() - 200);
  EXPECT_CONTAINS(said_of(cut, 3), "ends in the middle of a record, after 3 depth frames");
  Bytes its_recorder_died = whole;
  put_bytes(its_recorder_died,
            Record().field<std::uint8_t>("op", 5).field<std::uint32_t>("size", 0).text("compression", "lz4").with({}));
  put_bytes(its_recorder_died, Bytes(500, 0x22));
  EXPECT_CONTAINS(said_of(its_recorder_died, 4), "ends in the middle of a record, after 4 depth frames");
}

/// Where each of its records ends.
std::vector<std::size_t> record_ends(const Bytes& bag) {
  std::vector<std::size_t> ends;
  for (std::size_t at = std::strlen("#ROSBAG V2.0\n"); at < bag.size(); ends.push_back(at)) {
    for (int part = 0; part < 2; ++part) {
      std::uint32_t bytes = 0;
      std::memcpy(&bytes, &bag[at], sizeof bytes);
      at += sizeof bytes + bytes;
    }
  }
  return ends;
}

TEST(Bag, CutBetweenTwoRecordsItSaysThatItWasCut) {
  const Bytes whole = MadeUpBag().bytes();
  EXPECT_EQ(said_of(whole, 4), "");
  const std::vector<std::size_t> ends = record_ends(whole);
  ASSERT_EQ(ends.size(), 12u);  // the header, the descriptions, two for each of the four frames, two of the index
  EXPECT_EQ(ends.back(), whole.size());
  for (std::size_t record = 0; record + 2 < ends.size(); ++record) {
    SCOPED_TRACE(record);
    const Bytes cut = cut_to(whole, ends[record]);
    if (record < 2) {
      EXPECT_REFUSED(play(cut), "take.bag: ends before its index, before its first depth");
    } else {
      EXPECT_CONTAINS(said_of(cut, record / 2), "ends before its index, after " + counted(record / 2, "depth frame"));
    }
  }
  // The recorder never came to write an index.
  Bytes open = cut_to(whole, whole.size() - MadeUpBag::index().size());
  std::ranges::copy(MadeUpBag::bag_header(0),
                    open.begin() + static_cast<std::ptrdiff_t>(std::strlen("#ROSBAG V2.0\n")));
  EXPECT_CONTAINS(said_of(open, 4), "ends before its index, after 4 depth frames");
}

TEST(Bag, CutBeforeItsFirstImageItSaysThatItWasCut) {
  for (const char* compression : {"lz4", "none"}) {
    MadeUpBag bag;
    bag.compression = compression;
    bag.times_s.clear();
    const std::size_t begin = bag.bytes().size() - MadeUpBag::index().size();
    bag.times_s = {0.1};
    for (const std::size_t length : {begin - 20, begin + 60})  // in the first chunk, in the image's
      EXPECT_REFUSED(play(cut_to(bag.bytes(), length)),
                     "take.bag: ends in the middle of a record, before its first depth image");
  }
}

TEST(Bag, BrokenAnywhereItIsRefusedOrPlayed) {
  std::mt19937 random(11);
  std::size_t refused = 0, played = 0;
  for (const char* compression : {"lz4", "none"}) {
    MadeUpBag bag;
    bag.compression = compression;
    const Bytes whole = bag.bytes();
    stderr_of([&] {
      for (int i = 0; i < 250; ++i) {
        Bytes broken = whole;
        for (std::uint32_t n = 1 + random() % 3; n > 0; --n) {
          std::uint8_t& byte = broken[13 + random() % (broken.size() - 13)];
          byte = random() % 2 == 0 ? static_cast<std::uint8_t>(random())
                                   : static_cast<std::uint8_t>(byte ^ 1u << random() % 8);
        }
        const Error error = palpa::test::thrown_by([&] {
          for (const sensing::FrameSet& set : play(broken))
            EXPECT_EQ(set.frames[0].depth.size() % 8, 0u);
        });
        EXPECT_TRUE(error.code() == Exit::ok || error.code() == Exit::bad_input) << error.what();
        ++(error.code() == Exit::ok ? played : refused);
      }
    });
  }
  EXPECT_GT(refused, 50u);
  EXPECT_GT(played, 50u);
}

TEST(Bag, ARecordingOfARealCameraIsRead) {
  PALPA_SHARED_OR_SKIP(file, "depth-d435-bag-librealsense/single_depth_color_640x480.bag");
  sensing::Camera camera = posed();
  camera.roi.reset();  // it is that of another image size
  const auto source = open_bag(file.string(), &camera, false);
  const sensing::Camera& found = source->cameras()[0];
  EXPECT_EQ(found.width, 640u);
  EXPECT_NEAR(found.fx, 390.4315, 1e-3);
  EXPECT_NEAR(found.cx, 331.3879, 1e-3);
  EXPECT_NEAR(found.cy, 242.1873, 1e-3);
  EXPECT_EQ(found.depth_unit_m, 0.001);
  EXPECT_EQ(found.rate_hz, 6);
  sensing::FrameSet set;
  for (int i = 0; i < 2; ++i) {
    ASSERT_TRUE(source->next(set, 0));
    std::vector<std::uint16_t> extracted;  // from another reader
    sensing::read_png16(file.parent_path() / ("depth_" + std::to_string(i) + ".png"), 640, 480, extracted);
    EXPECT_EQ(set.frames[0].depth, extracted);
  }
  EXPECT_FALSE(source->next(set, 0));
}

}  // namespace
}  // namespace palpa::driver::rosbag
