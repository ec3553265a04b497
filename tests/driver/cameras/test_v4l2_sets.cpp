// Several depth cameras through V4L2: which of their frames form a set. A camera that stops, is unplugged, is slow or
// comes back holds up none of the others.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "driver/cameras/made_up_rig.hpp"
#include "driver/cameras/match.hpp"
#include "support/captured.hpp"
#include "support/thrown.hpp"

namespace palpa::driver::v4l2 {
namespace {

using palpa::test::stderr_of;
using test::frame_of;
using test::Machine;
using test::next_set;
using test::open;
using test::period_s;

TEST(V4l2Sets, FramesOfSeveralCamerasAreWithinHalfAFrame) {
  Machine machine;
  machine.plug("/dev/video0", "A");
  machine.plug("/dev/video2", "B")->phase_s = 0.7 * period_s;
  const auto drifting = machine.plug("/dev/video4", "C");
  drifting->rate_hz = 90.2;  // its clock is fast: it passes through every phase
  drifting->phase_s = 0.4 * period_s;
  const auto source = open(machine, {"/dev/video0", "/dev/video2", "/dev/video4"});
  sensing::FrameSet set;
  std::uint64_t sets = 0;
  const double begin_s = machine.now_s;
  double last_s = 0;
  while (machine.now_s < begin_s + 10) {
    ASSERT_TRUE(next_set(*source, set));
    ++sets;
    double oldest_s = set.frames[0].time_s;
    for (const sensing::DepthFrame& frame : set.frames) {
      EXPECT_LE(std::abs(frame.time_s - set.frames[0].time_s), period_s / 2 + cameras::stamp_jitter_s);
      EXPECT_GT(frame_of(frame), 0u);
      oldest_s = std::min(oldest_s, frame.time_s);
    }
    EXPECT_EQ(set.time_s, oldest_s);
    EXPECT_GT(set.time_s, last_s);
    last_s = set.time_s;
    EXPECT_LT(machine.now_s - set.time_s, 1.5 * period_s);
  }
  EXPECT_GT(sets, 890u) << "of 900 frames";
}

TEST(V4l2Sets, ACameraThatStopsIsLeftOutAndStartedAgain) {
  Machine machine;
  machine.plug("/dev/video0", "A");
  const auto camera = machine.plug("/dev/video2", "B");
  const auto source = open(machine, {"/dev/video0", "/dev/video2"});
  sensing::FrameSet set;
  ASSERT_TRUE(next_set(*source, set));
  camera->frozen = true;
  const double begin_s = machine.now_s;
  double last_s = begin_s, longest_s = 0;
  const std::string said = stderr_of([&] {
    while (machine.now_s < begin_s + 5) {
      ASSERT_TRUE(next_set(*source, set));
      longest_s = std::max(longest_s, machine.now_s - last_s);
      last_s = machine.now_s;
      EXPECT_GT(frame_of(set.frames[0]), 0u);
    }
    EXPECT_EQ(frame_of(set.frames[1]), 0u) << "what it saw last is not where the hand is now";
    camera->frozen = false;
    while (machine.now_s < begin_s + 8)
      ASSERT_TRUE(next_set(*source, set));
  });
  EXPECT_LT(longest_s, 0.09) << "the loop's hold is 0.1 s";
  EXPECT_GT(frame_of(set.frames[1]), 0u);
  EXPECT_GE(camera->starts, 2u);
  EXPECT_CONTAINS(said, "camera 'camera 2' (/dev/video2): gives no frames");
  EXPECT_EQ(said.find("gives no frames"), said.rfind("gives no frames"));
  EXPECT_CONTAINS(said, "camera 'camera 2' (/dev/video2): is back");
}

TEST(V4l2Sets, BackUnderAnotherNumberAfterItWasUnplugged) {
  for (const bool einval : {false, true}) {
    Machine machine;
    machine.plug("/dev/video0", "A");
    const auto camera = machine.plug("/dev/video2", "B");
    camera->eager_einval = einval;
    const auto source = open(machine, {"/dev/video0", "/dev/video2"});
    sensing::FrameSet set;
    ASSERT_TRUE(next_set(*source, set));
    const double begin_s = machine.now_s;
    machine.at(begin_s + 1, [&] { machine.unplug("/dev/video2"); });
    machine.at(begin_s + 2, [&] {
      // Meanwhile, another camera of the same kind takes its name, and the first one returns on another port.
      machine.plug("/dev/video2", "C");
      const auto again = machine.plug("/dev/video7", "B");
      again->phase_s = 0.002;
    });
    std::uint64_t alone = 0, empty = 0;
    const std::string said = stderr_of([&] {
      while (machine.now_s < begin_s + 4) {
        if (!next_set(*source, set)) {
          ++empty;
          continue;
        }
        EXPECT_GT(frame_of(set.frames[0]), 0u);
        alone += frame_of(set.frames[1]) == 0;
      }
    });
    EXPECT_EQ(empty, 0u);
    EXPECT_GT(alone, 85u);
    EXPECT_LT(alone, 125u);
    EXPECT_GT(frame_of(set.frames[1]), 0u);
    EXPECT_CONTAINS(said, "camera 'camera 2' (/dev/video2): unplugged; palpa continues without it");
    EXPECT_CONTAINS(said, "camera 'camera 2' (/dev/video7): is back");
    EXPECT_EQ(machine.open_descriptors, 2) << "nothing is left open when it is unplugged again";
  }
}

TEST(V4l2Sets, AFewBuffersAreEnough) {
  Machine machine;
  machine.plug("/dev/video0", "A")->most_buffers = 3;
  machine.plug("/dev/video2", "B")->most_buffers = 3;
  machine.plugged["/dev/video2"]->phase_s = 0.4 * period_s;
  const auto source = open(machine, {"/dev/video0", "/dev/video2"});
  sensing::FrameSet set;
  std::uint64_t sets = 0;
  for (const double begin_s = machine.now_s; machine.now_s < begin_s + 1;)
    sets += next_set(*source, set);
  EXPECT_GT(sets, 80u);
}

TEST(V4l2Sets, TheCameraKeepsBuffersWhileItsFramesWaitForAnothers) {
  for (const std::uint32_t buffers : {3u, 4u, 6u}) {
    Machine machine;
    const auto camera = machine.plug("/dev/video0", "A");
    camera->most_buffers = buffers;
    const auto late = machine.plug("/dev/video2", "B");
    late->frozen = true;  // for less than the wait for its first frame
    const auto source = open(machine, {"/dev/video0", "/dev/video2"});
    sensing::FrameSet set;
    for (const double begin_s = machine.now_s; machine.now_s < begin_s + 1.5;) {
      EXPECT_FALSE(next_set(*source, set));
      EXPECT_GE(camera->queued.size() + camera->filled.size(), 2u);
    }
    late->frozen = false;
    ASSERT_TRUE(next_set(*source, set));
    EXPECT_LT(machine.now_s - set.time_s, 2 * period_s) << "what waited is not what is there now";
  }
}

TEST(V4l2Sets, CamerasThatAreSlowInTheDarkGiveSetsAllTheSame) {
  // Automatic exposure of 33 and 40 ms at a rate of 90 Hz, half a frame apart; then the light comes back.
  for (const double other_hz : {30.0, 25.0, 90.0}) {
    Machine machine;
    const auto one = machine.plug("/dev/video0", "A"), two = machine.plug("/dev/video2", "B");
    one->rate_hz = 30;
    two->rate_hz = other_hz;
    two->phase_s = 0.5 / 30;
    const auto source = open(machine, {"/dev/video0", "/dev/video2"});
    EXPECT_DOUBLE_EQ(source->cameras()[1].rate_hz, 90) << "as it was asked for";
    sensing::FrameSet set;
    double last_s = machine.now_s, longest_s = 0;
    const auto look = [&](double seconds) {
      for (const double begin_s = machine.now_s; machine.now_s < begin_s + seconds;) {
        if (!next_set(*source, set)) continue;
        longest_s = std::max(longest_s, machine.now_s - last_s);
        last_s = machine.now_s;
        EXPECT_GT(frame_of(set.frames[0]), 0u);
        EXPECT_GT(frame_of(set.frames[1]), 0u);
        EXPECT_LE(std::abs(set.frames[0].time_s - set.frames[1].time_s), 0.021) << "half of the slower one's period";
      }
    };
    const std::string said = stderr_of([&] {
      look(0.3);
      longest_s = 0;
      look(3);
    });
    EXPECT_LT(longest_s, 0.085) << other_hz;
    EXPECT_EQ(said, "");
  }
}

TEST(V4l2Sets, FramesThatNeverFitTogetherAreSaidOnce) {
  Machine machine;
  // Two frames of each at a time, 2 ms apart, alternating.
  for (const char* path : {"/dev/video0", "/dev/video2"}) {
    const auto camera = machine.plug(path, path);
    camera->rate_hz = 500;
    const std::uint64_t first = path == std::string("/dev/video0") ? 0 : 11;
    for (std::uint64_t frame = 0; frame < 60000; ++frame) {
      if ((frame + first) % 22 > 1) camera->skipped.insert(frame);
    }
  }
  const auto source = open(machine, {"/dev/video0", "/dev/video2"});
  sensing::FrameSet set;
  const auto look = [&](double seconds) {
    for (const double begin_s = machine.now_s; machine.now_s < begin_s + seconds;)
      next_set(*source, set);
  };
  EXPECT_EQ(stderr_of([&] { look(0.9); }), "");
  const std::string said = stderr_of([&] { look(3); });
  EXPECT_CONTAINS(said,
                  "the cameras' frames do not fit together: for 1 s, none were captured within 6.1 ms of each other");
  EXPECT_EQ(said.find("do not fit"), said.rfind("do not fit"));
}

TEST(V4l2Sets, WhileACameraIsOpenedAgainTheOthersGoOn) {
  Machine machine;
  machine.plug("/dev/video0", "A");
  const auto camera = machine.plug("/dev/video2", "B");
  const auto source = open(machine, {"/dev/video0", "/dev/video2"});
  sensing::FrameSet set;
  ASSERT_TRUE(next_set(*source, set));
  machine.beside_s = 4;  // a device that does not respond
  const double begin_s = machine.now_s;
  machine.at(begin_s + 0.5, [&] { machine.unplug("/dev/video2"); });
  machine.at(begin_s + 1, [&] { machine.plug("/dev/video2", camera); });
  double longest_s = 0, last_s = begin_s;
  stderr_of([&] {
    while (machine.now_s < begin_s + 12) {
      EXPECT_TRUE(next_set(*source, set));
      longest_s = std::max(longest_s, machine.now_s - last_s);
      last_s = machine.now_s;
    }
  });
  EXPECT_LT(longest_s, 0.09);
  EXPECT_GT(frame_of(set.frames[1]), 0u) << "and it is back";
}

TEST(V4l2Match, NewestThatAllHave) {
  const std::vector<double> a{0.00, 0.01, 0.02}, b{0.004, 0.014}, late{0.004};
  std::vector<std::uint32_t> chosen(2);
  const auto matched = [&](const std::vector<double>& x, const std::vector<double>& y) {
    const std::vector<cameras::Waiting> both{{x}, {y}};
    return cameras::match(both, 0.01, chosen);
  };
  ASSERT_TRUE(matched(a, b));
  EXPECT_EQ(chosen, (std::vector<std::uint32_t>{1, 1}));
  ASSERT_TRUE(matched(a, late));
  EXPECT_EQ(chosen, (std::vector<std::uint32_t>{0, 0}));
  EXPECT_FALSE(matched(a, {}));
  EXPECT_FALSE(matched({0.02}, late));
}

}  // namespace
}  // namespace palpa::driver::v4l2
