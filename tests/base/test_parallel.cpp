#include "base/system/parallel.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <string>
#include <thread>

#include "base/error.hpp"
#include "support/thrown.hpp"

namespace palpa {
namespace {

TEST(Parallel, OfErrorsAtTheSameTimeThatOfTheFirstChunkIsReported) {
  const std::size_t workers = worker_count();
  for (int round = 0; round < 20; ++round) {
    std::atomic<std::size_t> here{0};
    const auto limit = std::chrono::steady_clock::now() + std::chrono::seconds(10);
    const Error error = test::thrown_by([&] {
      parallel_chunks(workers, 1, [&](std::size_t chunk, std::size_t, std::size_t) {
        ++here;
        while (here < workers && std::chrono::steady_clock::now() < limit)
          std::this_thread::yield();
        throw failure("chunk " + std::to_string(chunk));
      });
    });
    EXPECT_STREQ(error.what(), "chunk 0");
  }
}

}  // namespace
}  // namespace palpa
