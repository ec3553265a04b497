// What waits for most of its time, at the same time.
#pragma once

#include <functional>
#include <future>
#include <vector>

namespace palpa::test {

/// Does all of these, each on a thread of its own, and returns when all are done. Throws what one of them throws. What
/// they make for the whole test, such as scratch folders, is made before.
inline void side_by_side(const std::vector<std::function<void()>>& all) {
  std::vector<std::future<void>> under_way;
  for (const std::function<void()>& one : all)
    under_way.push_back(std::async(std::launch::async, one));
  for (std::future<void>& one : under_way)
    one.get();
}

}  // namespace palpa::test
