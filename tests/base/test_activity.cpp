// The current activity, seen from another thread.
#include <gtest/gtest.h>

#include "base/activity.hpp"
#include "base/error.hpp"
#include "base/system/parallel.hpp"
#include "support/thrown.hpp"

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

TEST(Cancellable, EndsWorkBetweenItsChunksAndSteps) {
  std::atomic<bool> stop{false};
  const Cancellable cancellable(stop);
  std::atomic<int> chunks{0};
  const auto work = [&] {
    parallel_chunks(1'000'000, 1, [&](std::size_t, std::size_t, std::size_t) {
      ++chunks;
      stop = true;
    });
  };
  EXPECT_EQ(test::thrown_by(work).code(), Exit::failed);
  EXPECT_LE(chunks, static_cast<int>(worker_count()));
  stop = false;
  Activity steps("counts", 2);
  steps.advance();
  stop = true;
  EXPECT_EQ(test::thrown_by([&] { steps.advance(); }).code(), Exit::failed);
}

}  // namespace
}  // namespace palpa
