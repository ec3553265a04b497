// What waits for most of its time, at the same time. What it makes for the whole test, such as scratch folders, is made
// before.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <future>
#include <vector>

namespace palpa::test {

/// Does all of these, each on a thread of its own, and returns when all are done. Throws what one of them throws.
inline void side_by_side(const std::vector<std::function<void()>>& all) {
  std::vector<std::future<void>> under_way;
  for (const std::function<void()>& one : all)
    under_way.push_back(std::async(std::launch::async, one));
  for (std::future<void>& one : under_way)
    one.get();
}

/// Does `one` with each case, so many at a time.
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
