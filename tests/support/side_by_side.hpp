// Runs functions that mostly wait, at the same time. Prepare anything that they share before.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <future>
#include <vector>

namespace palpa::test {

/// Runs all functions, each on its own thread, and returns when all have ended. Rethrows an exception of one of them.
inline void side_by_side(const std::vector<std::function<void()>>& all) {
  std::vector<std::future<void>> under_way;
  for (const std::function<void()>& one : all)
    under_way.push_back(std::async(std::launch::async, one));
  for (std::future<void>& one : under_way)
    one.get();
}

/// Calls `one` with each case, `at_a_time` cases at the same time.
template <typename Case, typename One>
void side_by_side(std::size_t at_a_time, const std::vector<Case>& cases, One one) {
  std::atomic<std::size_t> next{0};
  const auto one_after_the_other = [&] {
    for (std::size_t i = next++; i < cases.size(); i = next++)
      one(cases[i]);
  };
  side_by_side(std::vector<std::function<void()>>(at_a_time, one_after_the_other));
}

}  // namespace palpa::test
