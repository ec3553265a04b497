// The current activity, seen from another thread.
#include <gtest/gtest.h>

#include "base/activity.hpp"
#include "base/parallel.hpp"

namespace palpa {
namespace {

TEST(Activity, IsSeenWhileItLives) {
  EXPECT_FALSE(doing());
  {
    const Activity outer("checks mesh \"x\"", 7);
    EXPECT_EQ(doing()->what, "checks mesh \"x\"");
    EXPECT_EQ(doing()->total, 7u);
    {
      Activity inner("looks for crossings", 100);
      inner.advance();
      inner.advance(3);
      EXPECT_EQ(doing()->what, "checks mesh \"x\": looks for crossings");
      EXPECT_EQ(doing()->done, 4u);
      inner.reach(1000);
      EXPECT_EQ(doing()->done, 100u) << "never more than all";
    }
    EXPECT_EQ(doing()->what, "checks mesh \"x\"");
  }
  EXPECT_FALSE(doing());
}

TEST(Activity, ManyThreadsAdvanceIt) {
  Activity work("counts", 10'000);
  parallel_chunks(10'000, 10, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      work.advance();
    EXPECT_TRUE(doing());
  });
  EXPECT_EQ(doing()->done, 10'000u);
}

}  // namespace
}  // namespace palpa
