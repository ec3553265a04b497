// A tracker whose frames come by UDP.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "base/error.hpp"
#include "base/system/udp.hpp"
#include "sensing/joints/tracker.hpp"
#include "support/captured.hpp"
#include "support/instrumented.hpp"
#include "support/thrown.hpp"
#include "support/tracked_hands.hpp"
#include "support/udp_sender.hpp"

namespace palpa::sensing {
namespace {

using Clock = std::chrono::steady_clock;

std::string frame_at(double time_s) {
  return test::line_of({time_s, {test::pointing_hand({0.1 * time_s, 0.1, 0})}});
}

struct Heard {
  std::uint16_t port = test::free_udp_port();
  std::string name = "udp:" + std::to_string(port);
  std::unique_ptr<Tracker> tracker = open_tracker(name, true);
  test::UdpSender sender{port};
  TrackedFrame frame;
  std::uint64_t number = 99;

  /// Whether a frame comes in this time.
  bool next(double timeout_s = 10) {
    bool came = false;
    EXPECT_TRUE(tracker->next(frame, came, number, timeout_s)) << "it never ends";
    return came;
  }
};

/// The memory of this process.
std::uint64_t resident_bytes() {
  std::ifstream statm("/proc/self/statm");
  std::uint64_t all = 0, resident = 0;
  statm >> all >> resident;
  return resident * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

TEST(UdpTracker, GivesTheNewestFrame) {
  Heard heard;
  heard.sender.send(frame_at(1));
  ASSERT_TRUE(heard.next());
  EXPECT_EQ(heard.frame.time_s, 1);
  EXPECT_EQ(heard.number, 0U);
  ASSERT_EQ(heard.frame.hands.size(), 1U);
  EXPECT_EQ(heard.frame.hands[0], test::pointing_hand({0.1, 0.1, 0}));
  for (const double time_s : {1.01, 1.02, 1.03})
    heard.sender.send(frame_at(time_s));
  ASSERT_TRUE(heard.next());
  EXPECT_EQ(heard.frame.time_s, 1.03);
  EXPECT_EQ(heard.number, 3U) << "two were left out for newer ones";
  heard.sender.send(R"({"t_s": 1.04, "hands": []})");
  ASSERT_TRUE(heard.next()) << "a frame without a hand is a frame";
  EXPECT_TRUE(heard.frame.hands.empty());
  EXPECT_FALSE(heard.next(0.01));
}

TEST(UdpTracker, LeavesOutWhatIsNoFrameAndCountsIt) {
  const std::string said = test::stderr_of([] {
    Heard heard;
    heard.sender.send("hello");
    heard.sender.send(frame_at(2));
    heard.sender.send(std::string(60000, '['));
    ASSERT_TRUE(heard.next()) << "the newest that is a frame";
    EXPECT_EQ(heard.frame.time_s, 2);
    heard.sender.send("");
    heard.sender.send(R"({"event": {"type": "deviceEvent"}})");
    heard.sender.send("{\"version\": 6}");
    EXPECT_FALSE(heard.next(0.01)) << "a Leap's service says more than frames";
    heard.sender.send(frame_at(1.99));
    heard.sender.send(frame_at(2));
    EXPECT_FALSE(heard.next(0.01)) << "they are not newer";
    heard.sender.send(frame_at(0.5));
    ASSERT_TRUE(heard.next()) << "the tracker was started again";
    heard.sender.send("hello again");
    EXPECT_FALSE(heard.next(0.01));
  });
  EXPECT_CONTAINS(said, ": palpa leaves out a datagram that is no frame: the datagram: its JSON");
  EXPECT_CONTAINS(said, ": 3 times, palpa left out a datagram that is no frame\n");
  EXPECT_CONTAINS(said, ": 2 times, palpa left out a frame that is not newer than the one before\n");
}

TEST(UdpTracker, GoesOnAfterItsClockWasSetBack) {
  Heard heard;
  const auto heard_at = [&](double time_s) {
    heard.sender.send(frame_at(time_s));
    return heard.next(0.01);
  };
  heard.sender.send(frame_at(2));
  ASSERT_TRUE(heard.next());
  for (int i = 0; i < 5; ++i)
    EXPECT_FALSE(heard_at(1.7)) << "a clock that stands still";
  EXPECT_FALSE(heard_at(1.71));
  heard.sender.send(frame_at(1.72));
  ASSERT_TRUE(heard.next());
  EXPECT_EQ(heard.frame.time_s, 1.72);
  heard.sender.send(frame_at(1.73));
  ASSERT_TRUE(heard.next());
  EXPECT_EQ(heard.frame.hands.size(), 1U);
  for (const double late_s : {1.71, 1.72}) {
    EXPECT_FALSE(heard_at(late_s)) << "two that were overtaken";
  }
  heard.sender.send(frame_at(1.74));
  ASSERT_TRUE(heard.next());
}

TEST(UdpTracker, LeavesOutHandsOfAClockThatDoesNotRunInSeconds) {
  const std::string said = test::stderr_of([] {
    Heard heard;
    for (int i = 0; i < 2; ++i) {  // how fast a clock runs shows from the third on
      heard.sender.send(frame_at(1e-3 * i));
      ASSERT_TRUE(heard.next());
      EXPECT_EQ(heard.frame.hands.size(), 1U) << i;
    }
    for (int i = 1; i < 6; ++i) {
      heard.sender.send(test::line_of({16.0 * i, {test::pointing_hand({0.1, 0.1, 0})}}));
      ASSERT_TRUE(heard.next());
      EXPECT_TRUE(heard.frame.hands.empty()) << i;
    }
  });
  EXPECT_CONTAINS(said, ": palpa leaves out the hands of frames whose times do not run with this computer's clock: ");
  EXPECT_CONTAINS(said, ": 5 times, palpa left out the hands of frames whose times do not run");
}

TEST(UdpTracker, TakesAllThatWaitedBeforeTheFirstFrame) {
  Heard heard;
  for (int i = 0; i < 80; ++i)  // short ones: the system holds them all
    heard.sender.send("{\"t_s\": " + std::to_string(i) + ", \"hands\": []}");
  ASSERT_TRUE(heard.next());
  EXPECT_EQ(heard.frame.time_s, 79);
  EXPECT_EQ(heard.number, 79U);
}

TEST(UdpTracker, AFloodNeitherBlocksNorGrows) {
  for (const bool frames : {true, false}) {
    const std::string said = test::stderr_of([&] {
      Heard heard;
      std::atomic<bool> ends{false};
      std::thread flood([&] {
        const std::string garbage(20000, 'x');
        for (double time_s = 1; !ends; time_s += 1e-4)
          heard.sender.send(frames ? frame_at(time_s) : garbage);
      });
      std::uint64_t came = 0;
      double longest_s = 0;
      const std::uint64_t before = resident_bytes();
      const Clock::time_point begin = Clock::now();
      // On a busy machine, the flood itself may take a while to begin.
      while (seconds_since(begin) < 1 || (frames && came == 0 && seconds_since(begin) < 120)) {
        const Clock::time_point asked = Clock::now();
        came += heard.next(0.05) ? 1 : 0;
        longest_s = std::max(longest_s, seconds_since(asked));
      }
      const std::uint64_t after = resident_bytes();
      ends = true;
      flood.join();
      EXPECT_EQ(came > 0, frames);
      EXPECT_LT(longest_s, 60) << "it waits 0.05 s";
      if (!test::instrumented()) {
        EXPECT_LT(after, before + (16U << 20));
      }
      if (frames) {
        EXPECT_GE(heard.number + 1, came);
      }
    });
    EXPECT_LT(said.size(), 1000U) << said;
  }
}

TEST(UdpTracker, ListensOnBothAddressesOfTheLoopback) {
  Heard heard;
  std::optional<UdpSender> six;
  try {
    six.emplace("[::1]:" + std::to_string(heard.port), "test", "");
  } catch (const Error&) {
    GTEST_SKIP() << "skipped: no IPv6";
  }
  ASSERT_EQ(six->send(frame_at(1)), UdpSender::Sent::yes);
  ASSERT_TRUE(heard.next());
  EXPECT_EQ(heard.frame.time_s, 1);
  heard.sender.send(frame_at(1.01));
  ASSERT_TRUE(heard.next());
  EXPECT_EQ(heard.frame.time_s, 1.01);
  ASSERT_EQ(six->send(frame_at(1.02)), UdpSender::Sent::yes);
  ASSERT_TRUE(heard.next());
  EXPECT_EQ(heard.frame.time_s, 1.02);

  // One that listens on an address listens on no other.
  const std::uint16_t port = test::free_udp_port();
  const auto own = open_tracker("udp:127.0.0.1:" + std::to_string(port), true);
  EXPECT_NO_THROW(open_tracker("udp:[::1]:" + std::to_string(port), true));
}

/// A name listens on all its addresses, whichever a sender takes.
TEST(UdpTracker, ListensOnAllAddressesOfAName) {
  const std::string port = std::to_string(test::free_udp_port());
  const auto tracker = open_tracker("udp:localhost:" + port, true);
  for (const char* host : {"127.0.0.1:", "[::1]:", "localhost:"}) {
    std::optional<UdpSender> sender;
    try {
      sender.emplace(host + port, "test", "");
    } catch (const Error&) {
      continue;  // no IPv6
    }
    const bool is_of_the_name = sender->send(frame_at(1)) == UdpSender::Sent::yes;
    EXPECT_TRUE(is_of_the_name || host == std::string("[::1]:")) << host;
  }
  EXPECT_ERROR(open_tracker("udp:localhost:" + port, true), Exit::failed, "cannot listen on localhost:");
}

TEST(UdpTracker, ListensOnTheLoopbackUnlessItIsToldOtherwise) {
  const std::uint16_t port = test::free_udp_port();
  const auto own = open_tracker("udp:" + std::to_string(port), true);
  EXPECT_ERROR(open_tracker("udp:127.0.0.1:" + std::to_string(port), true), Exit::failed,
               "cannot listen on 127.0.0.1:");
  // The loopback has more than one address.
  EXPECT_NO_THROW(open_tracker("udp:127.0.0.2:" + std::to_string(port), true));
  for (const char* bad : {"udp:", "udp:port", "udp:0", "udp:65536", "udp:-1", "udp::9000", "udp:127.0.0.1:"})
    EXPECT_ERROR(open_tracker(bad, true), Exit::usage, "joints:udp:9000") << bad;
  EXPECT_ERROR(open_tracker("udp:192.0.2.1:9000", true), Exit::failed, "cannot listen") << "another computer's";
  EXPECT_TRUE(is_live_tracker("udp:9000"));
  EXPECT_FALSE(is_live_tracker("hands.jsonl"));
}

}  // namespace
}  // namespace palpa::sensing
