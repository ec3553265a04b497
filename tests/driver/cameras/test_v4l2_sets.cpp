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
using test::MadeUpCamera;
using test::period_s;
using test::Rig;

TEST(V4l2Sets, FramesOfSeveralCamerasAreWithinHalfAFrame) {
  Rig rig(3);
  rig.cameras[1]->phase_s = 0.7 * period_s;
  rig.cameras[2]->rate_hz = 90.2;  // its clock is fast: it passes through every phase
  rig.cameras[2]->phase_s = 0.4 * period_s;
  rig.begin();
  std::uint64_t sets = 0;
  double last_s = 0;
  rig.longest_gap_s(10, [&] {
    ++sets;
    double oldest_s = rig.set.frames[0].time_s;
    for (const sensing::DepthFrame& frame : rig.set.frames) {
      EXPECT_LE(std::abs(frame.time_s - rig.set.frames[0].time_s), period_s / 2 + cameras::stamp_jitter_s);
      EXPECT_GT(frame_of(frame), 0u);
      oldest_s = std::min(oldest_s, frame.time_s);
    }
    EXPECT_EQ(rig.set.time_s, oldest_s);
    EXPECT_GT(rig.set.time_s, last_s);
    last_s = rig.set.time_s;
    EXPECT_LT(rig.machine.now_s - rig.set.time_s, 1.5 * period_s);
  });
  EXPECT_GT(sets, 890u) << "of 900 frames";
}

TEST(V4l2Sets, ACameraThatStopsIsLeftOutAndStartedAgain) {
  Rig rig(2);
  MadeUpCamera& camera = *rig.cameras[1];
  rig.begin();
  camera.frozen = true;
  const std::string said = stderr_of([&] {
    EXPECT_LT(rig.longest_gap_s(5, [&] { EXPECT_GT(frame_of(rig.set.frames[0]), 0u); }), 0.09) << "the hold is 0.1 s";
    EXPECT_EQ(frame_of(rig.set.frames[1]), 0u) << "what it saw last is not where the hand is now";
    camera.frozen = false;
    EXPECT_LT(rig.longest_gap_s(3), 0.09);
  });
  EXPECT_GT(frame_of(rig.set.frames[1]), 0u);
  EXPECT_GE(camera.starts, 2u);
  EXPECT_CONTAINS(said, "camera 'camera 2' (/dev/video2): gives no frames");
  EXPECT_EQ(said.find("gives no frames"), said.rfind("gives no frames"));
  EXPECT_CONTAINS(said, "camera 'camera 2' (/dev/video2): is back");
}

TEST(V4l2Sets, BackUnderAnotherNumberAfterItWasUnplugged) {
  for (const bool einval : {false, true}) {
    Rig rig(2);
    rig.cameras[1]->eager_einval = einval;
    rig.begin();
    const double begin_s = rig.machine.now_s;
    rig.machine.at(begin_s + 1, [&] { rig.machine.unplug("/dev/video2"); });
    rig.machine.at(begin_s + 2, [&] {
      // Meanwhile, another camera of the same kind takes its name, and the first one returns on another port.
      rig.machine.plug("/dev/video2", "C");
      rig.machine.plug("/dev/video7", "B")->phase_s = 0.002;
    });
    std::uint64_t alone = 0;
    const std::string said = stderr_of([&] {
      const double gap_s = rig.longest_gap_s(4, [&] {
        EXPECT_GT(frame_of(rig.set.frames[0]), 0u);
        alone += frame_of(rig.set.frames[1]) == 0;
      });
      EXPECT_LT(gap_s, 0.1);
    });
    EXPECT_GT(alone, 85u);
    EXPECT_LT(alone, 125u);
    EXPECT_GT(frame_of(rig.set.frames[1]), 0u);
    EXPECT_CONTAINS(said, "camera 'camera 2' (/dev/video2): unplugged; palpa continues without it");
    EXPECT_CONTAINS(said, "camera 'camera 2' (/dev/video7): is back");
    EXPECT_EQ(rig.machine.open_descriptors, 2) << "nothing is left open when it is unplugged again";
  }
}

TEST(V4l2Sets, FramesThatWereLateNeverTakeTheHandBack) {
  Rig rig(2);
  rig.begin();
  rig.cameras[0]->late_s = 0.09;
  double newest_s = 0;
  const auto ascends = [&] {
    EXPECT_GT(rig.set.time_s, newest_s);
    newest_s = rig.set.time_s;
  };
  rig.longest_gap_s(0.07, ascends);  // in the end, the other one alone
  rig.cameras[1]->frozen = true;
  std::uint64_t sets = 0;
  rig.longest_gap_s(0.3, [&] {
    ascends();
    ++sets;
  });
  EXPECT_GT(sets, 10u) << "its frames that are newer are taken";
}

TEST(V4l2Sets, AFewBuffersAreEnough) {
  Rig rig(2);
  for (const auto& camera : rig.cameras)
    camera->most_buffers = 3;
  rig.cameras[1]->phase_s = 0.4 * period_s;
  rig.begin();
  std::uint64_t sets = 0;
  rig.longest_gap_s(1, [&] { ++sets; });
  EXPECT_GT(sets, 80u);
}

TEST(V4l2Sets, TheCameraKeepsBuffersWhileItsFramesWaitForAnothers) {
  for (const std::uint32_t buffers : {3u, 4u, 6u}) {
    Rig rig(2);
    const MadeUpCamera& camera = *rig.cameras[0];
    rig.cameras[0]->most_buffers = buffers;
    rig.cameras[1]->frozen = true;  // for less than the wait for its first frame
    rig.source = test::open(rig.machine, rig.nodes);
    for (const double begin_s = rig.machine.now_s; rig.machine.now_s < begin_s + 1.5;) {
      EXPECT_FALSE(rig.next());
      EXPECT_GE(camera.queued.size() + camera.filled.size(), 2u);
    }
    rig.cameras[1]->frozen = false;
    ASSERT_TRUE(rig.next());
    EXPECT_LT(rig.machine.now_s - rig.set.time_s, 2 * period_s) << "what waited is not what is there now";
  }
}

TEST(V4l2Sets, CamerasThatAreSlowInTheDarkGiveSetsAllTheSame) {
  // Automatic exposure of 33 and 40 ms at a rate of 90 Hz, half a frame apart; then the light comes back.
  for (const double other_hz : {30.0, 25.0, 90.0}) {
    Rig rig(2);
    rig.cameras[0]->rate_hz = 30;
    rig.cameras[1]->rate_hz = other_hz;
    rig.cameras[1]->phase_s = 0.5 / 30;
    rig.source = test::open(rig.machine, rig.nodes);
    EXPECT_DOUBLE_EQ(rig.source->cameras()[1].rate_hz, 90) << "as it was asked for";
    const auto look = [&] {
      const auto& frames = rig.set.frames;
      EXPECT_GT(frame_of(frames[0]), 0u);
      EXPECT_GT(frame_of(frames[1]), 0u);
      EXPECT_LE(std::abs(frames[0].time_s - frames[1].time_s), 0.021) << "half of the slower one's period";
    };
    const std::string said = stderr_of([&] {
      rig.longest_gap_s(0.3, look);
      EXPECT_LT(rig.longest_gap_s(3, look), 0.085) << other_hz;
    });
    EXPECT_EQ(said, "");
  }
}

TEST(V4l2Sets, FramesThatNeverFitTogetherAreSaidOnce) {
  Rig rig(2);
  // Two frames of each at a time, 2 ms apart, alternating.
  for (std::uint64_t c = 0; c < 2; ++c) {
    rig.cameras[c]->rate_hz = 500;
    for (std::uint64_t frame = 0; frame < 60000; ++frame) {
      if ((frame + 11 * c) % 22 > 1) rig.cameras[c]->skipped.insert(frame);
    }
  }
  rig.source = test::open(rig.machine, rig.nodes);
  EXPECT_EQ(stderr_of([&] { rig.longest_gap_s(0.9); }), "");
  const std::string said = stderr_of([&] { rig.longest_gap_s(3); });
  EXPECT_CONTAINS(said,
                  "the cameras' frames do not fit together: for 1 s, none were captured within 6.1 ms of each other");
  EXPECT_EQ(said.find("do not fit"), said.rfind("do not fit"));
}

TEST(V4l2Sets, WhileACameraIsOpenedAgainTheOthersGoOn) {
  Rig rig(2);
  rig.begin();
  rig.machine.beside_s = 4;  // a device that does not respond
  const double begin_s = rig.machine.now_s;
  rig.machine.at(begin_s + 0.5, [&] { rig.machine.unplug("/dev/video2"); });
  rig.machine.at(begin_s + 1, [&] { rig.machine.plug("/dev/video2", rig.cameras[1]); });
  stderr_of([&] { EXPECT_LT(rig.longest_gap_s(12), 0.09); });
  EXPECT_GT(frame_of(rig.set.frames[1]), 0u) << "and it is back";
}

TEST(V4l2Match, TheNewestFramesThatAllHaveAreChosen) {
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
