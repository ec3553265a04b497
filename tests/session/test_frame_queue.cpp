// The frames that wait for a recorder.
#include "session/loop/frame_queue.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <thread>

namespace palpa::session {
namespace {

using namespace std::chrono_literals;

sensing::FrameSet frame(std::uint64_t sequence, std::size_t pixels = 100) {
  sensing::FrameSet set;
  set.sequence = sequence;
  set.frames.resize(2);
  for (sensing::DepthFrame& image : set.frames)
    image.depth.assign(pixels, static_cast<std::uint16_t>(sequence));
  return set;
}

std::vector<std::uint64_t> taken(FrameQueue& queue) {
  std::vector<std::uint64_t> sequences;
  for (sensing::FrameSet set; queue.take(set, 0ms);) {
    sequences.push_back(set.sequence);
    EXPECT_EQ(set.frames.at(1).depth.at(7), set.sequence);
  }
  return sequences;
}

TEST(FrameQueue, KeepsTheirOrderAndReplacesTheLastIfItIsFull) {
  FrameQueue queue(3 * 2 * 100 * 2 + 50);  // three frames of two images of a hundred pixels
  for (std::uint64_t round = 0; round < 3; ++round) {
    for (std::uint64_t i = 0; i < 3; ++i)
      EXPECT_FALSE(queue.add(frame(i)));
    EXPECT_TRUE(queue.add(frame(3)));
    EXPECT_TRUE(queue.add(frame(4)));
    EXPECT_EQ(queue.waiting(), 3u);
    EXPECT_EQ(taken(queue), (std::vector<std::uint64_t>{0, 1, 4}));
  }
  EXPECT_FALSE(queue.add(frame(5, 1'000'000))) << "one frame always waits";
  EXPECT_TRUE(queue.add(frame(6)));
  EXPECT_EQ(queue.discard(), 1u);
  EXPECT_EQ(queue.waiting(), 0u);
  EXPECT_FALSE(queue.add(sensing::FrameSet{}));
}

TEST(FrameQueue, IsOverWhenItIsClosedAndEmpty) {
  FrameQueue queue(1 << 20);
  queue.add(frame(1));
  EXPECT_FALSE(queue.wait_empty(0ms));
  EXPECT_FALSE(queue.closed());
  queue.close();
  EXPECT_TRUE(queue.closed());
  EXPECT_FALSE(queue.over());
  EXPECT_TRUE(queue.wait_empty(0ms)) << "nobody waits for a closed queue";
  EXPECT_EQ(taken(queue), std::vector<std::uint64_t>{1});
  EXPECT_TRUE(queue.over());
}

TEST(FrameQueue, PassesEveryFrameFromThreadToThread) {
  FrameQueue queue(1 << 20);
  constexpr std::uint64_t count = 2000;
  std::thread writer([&] {
    for (std::uint64_t i = 0; i < count; ++i) {
      EXPECT_FALSE(queue.add(frame(i, 8)));
      if (i % 100 == 0) {
        EXPECT_TRUE(queue.wait_empty(60s));
      }
    }
    queue.close();
  });
  std::uint64_t next = 0;
  for (sensing::FrameSet set; !queue.over();) {
    if (queue.take(set, 1ms)) {
      EXPECT_EQ(set.sequence, next++);
    }
  }
  writer.join();
  EXPECT_EQ(next, count);
}

}  // namespace
}  // namespace palpa::session
