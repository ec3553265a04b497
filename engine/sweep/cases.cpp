#include "sweep/cases.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <functional>
#include <queue>
#include <utility>

#include "base/activity.hpp"
#include "base/error.hpp"
#include "base/sha256.hpp"
#include "base/version.hpp"
#include "sweep/commands.hpp"

namespace palpa::sweep {

std::vector<Case> list_cases(const Plan& plan, const Inputs& inputs, bool costs) {
  Activity activity("lists the cases of the plan", plan.count());
  Estimator estimator(plan, inputs);
  const std::string kept = plan.keep_everything ? "everything" : fmt::format("{}", fmt::join(plan.results, "\n"));
  const std::string common =
      fmt::format("a case of palpa sweep\n{}\n{}\n{}\n\n", version_and_commit(), plan.command, kept);
  std::vector<Case> cases;
  cases.reserve(plan.count());
  constexpr std::size_t digits = 20;
  for (std::uint64_t i = 0; i < plan.count(); ++i) {
    const std::vector<Setting> settings = plan.settings(i);
    cases.push_back(
        {i, sha256(common + inputs.canonical(settings)).substr(0, digits), costs ? estimator.cost(settings) : Cost()});
    activity.advance();
  }
  return cases;
}

void refuse_hopeless(const Plan& plan) {
  constexpr std::uint64_t most_looks = 10'000;
  const Command& command = command_of(plan.command);
  std::string fault;
  for (std::uint64_t i = 0; i < plan.count(); ++i) {
    if (i == most_looks) return;
    try {
      check_line(*read_line(command, given_by(plan.settings(i))));
      return;
    } catch (const Error& error) {
      if (fault.empty()) fault = error.what();
    }
  }
  const std::uint64_t cases = plan.count();
  throw bad_input(
      plan.file, cases == 1 ? fault : fmt::format("none of the {} cases can be computed; the first: {}", cases, fault));
}

std::vector<Case> deal(std::vector<Case> cases, const Shard& shard) {
  std::ranges::stable_sort(cases, [](const Case& a, const Case& b) { return a.cost.seconds > b.cost.seconds; });
  // The shards by what they have so far, the least first.
  using Load = std::pair<double, std::uint32_t>;
  std::priority_queue<Load, std::vector<Load>, std::greater<>> loads;
  for (std::uint32_t i = 0; i < shard.count; ++i)
    loads.push({0, i});
  std::vector<double> loads_of(shard.count, 0);
  std::vector<Case> mine;
  for (std::size_t begin = 0, end = 0; begin < cases.size(); begin = end) {
    while (end < cases.size() && cases[end].cost.seconds == cases[begin].cost.seconds)
      ++end;
    // Each shard gets equally many of equally long cases, and the rest goes to the shards that have the least.
    // Neighbours in the plan stay together, because they often share a model or a finger in its place.
    const std::size_t each = (end - begin) / shard.count, rest = (end - begin) % shard.count;
    std::vector<std::uint32_t> with_more;
    for (std::size_t i = 0; i < rest; ++i) {
      with_more.push_back(loads.top().second);
      loads.pop();
    }
    // Those that get one more: what all others get, too, needs no count.
    std::ranges::sort(with_more);
    const auto more_before =
        static_cast<std::size_t>(std::ranges::lower_bound(with_more, shard.index) - with_more.begin());
    const bool more = std::ranges::binary_search(with_more, shard.index);
    const std::size_t first = begin + each * shard.index + more_before;
    for (std::size_t k = first; k < first + each + (more ? 1 : 0); ++k)
      mine.push_back(cases[k]);
    for (const std::uint32_t owner : with_more)
      loads.push({loads_of[owner] += cases[begin].cost.seconds, owner});
  }
  return mine;
}

}  // namespace palpa::sweep
