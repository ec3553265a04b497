// Values and frames on their way from thread to thread.
#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <thread>
#include <vector>

#include "session/loop/frame_queue.hpp"
#include "session/newest.hpp"

namespace palpa::session {
namespace {

using namespace std::chrono_literals;

TEST(Newest, GivesTheReaderTheLatestAndTellsTheWriterWhatItReplaced) {
  Newest<int> newest;
  EXPECT_FALSE(newest.take());
  newest.back() = 1;
  EXPECT_FALSE(newest.publish());
  newest.back() = 2;
  EXPECT_TRUE(newest.publish());
  EXPECT_TRUE(newest.take());
  EXPECT_EQ(newest.front(), 2);
  EXPECT_FALSE(newest.take());
  EXPECT_EQ(newest.front(), 2);
}

TEST(Newest, AWaitingValueOutlivesTheWriter) {
  Newest<int> newest;
  newest.back() = 7;
  newest.publish();
  newest.close();
  EXPECT_FALSE(newest.closed());
  EXPECT_TRUE(newest.take(1s));
  EXPECT_EQ(newest.front(), 7);
  EXPECT_TRUE(newest.closed());
  EXPECT_FALSE(newest.take(10s)) << "must not wait for a writer that is gone";
}

TEST(Newest, NeverTearsAValueAndNeverGoesBack) {
  Newest<std::vector<int>> newest;
  constexpr int last = 20'000;
  std::thread writer([&] {
    for (int i = 1; i <= last; ++i) {
      newest.back().assign(64, i);
      newest.publish();
    }
    newest.close();
  });
  int before = 0;
  while (!newest.closed()) {
    if (!newest.take(100ms)) continue;
    const std::vector<int>& value = newest.front();
    ASSERT_EQ(value, std::vector<int>(64, value[0]));
    ASSERT_GT(value[0], before);
    before = value[0];
  }
  writer.join();
  EXPECT_EQ(before, last);
}

TEST(Newest, AWriterMayWaitUntilItsValueIsTaken) {
  Newest<int> newest;
  EXPECT_TRUE(newest.wait_taken(1ms));
  newest.publish();
  EXPECT_FALSE(newest.wait_taken(1ms));
  std::thread reader([&] { newest.take(60s); });
  EXPECT_TRUE(newest.wait_taken(60s));
  reader.join();
}

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
