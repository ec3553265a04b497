#include <gtest/gtest.h>

#include <thread>
#include <vector>

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

}  // namespace
}  // namespace palpa::session
