#include "study/plan/order.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <numeric>
#include <utility>

#include "base/random.hpp"
#include "base/text.hpp"

namespace palpa::study {
namespace {

/// A generator for one block of one participant with one method. The method counts by its place in the plan, so the
/// order of a method's trials does not depend on which method comes first.
Random random_of(const StudyPlan& plan, std::uint32_t participant, std::uint32_t method, std::uint32_t block) {
  std::uint64_t seed = plan.run.seed;
  for (const std::uint64_t part : {std::uint64_t{participant}, std::uint64_t{method}, std::uint64_t{block}})
    seed = Random(seed ^ (part + 1) * 0x9e3779b97f4a7c15u).next();
  return Random(seed);
}

template <typename T>
void shuffle(std::vector<T>& values, Random& random) {
  for (std::size_t i = values.size(); i > 1; --i)
    std::swap(values[i - 1], values[random.below(i)]);
}

/// `repeats` of each shape at random, with no shape twice in a row. Each choice leaves a rest that can be ordered so:
/// no shape may fill more than half of it, and the one just chosen may not need the next place.
std::vector<std::uint32_t> apart(const std::vector<std::uint32_t>& shapes, std::uint32_t repeats, Random& random) {
  std::vector<std::size_t> left(shapes.size(), repeats);
  std::size_t rest = shapes.size() * repeats;
  std::vector<std::uint32_t> order;
  std::size_t last = shapes.size();
  while (rest > 0) {
    std::vector<std::size_t> possible;  // each shape as often as it is left, so that the choice is even over trials
    for (std::size_t s = 0; s < shapes.size(); ++s) {
      if (s == last || left[s] == 0) continue;
      bool fits = true;
      for (std::size_t t = 0; t < shapes.size(); ++t) {
        const std::size_t most = t == s ? (rest - 1) / 2 : rest / 2;
        fits = fits && left[t] - (t == s ? 1 : 0) <= most;
      }
      if (fits) possible.insert(possible.end(), left[s], s);
    }
    last = possible[random.below(possible.size())];
    order.push_back(shapes[last]);
    --left[last];
    --rest;
  }
  return order;
}

/// The shapes of a block in the order in which they are touched.
std::vector<std::uint32_t> touches_of(const PlanBlock& block, Random& random) {
  if (block.apart) return apart(block.shapes, block.repeats, random);
  std::vector<std::uint32_t> shapes;
  for (std::uint32_t repeat = 0; repeat < block.repeats; ++repeat)
    shapes.insert(shapes.end(), block.shapes.begin(), block.shapes.end());
  // Familiarisation and practice are in the order of the plan.
  if (block.kind == BlockKind::trial) shuffle(shapes, random);
  return shapes;
}

}  // namespace

OrderRule default_order(std::size_t methods) {
  return methods == 1 ? OrderRule::fixed : methods == 2 ? OrderRule::halves : OrderRule::williams;
}

std::vector<std::vector<std::uint32_t>> williams_square(std::uint32_t n) {
  std::vector<std::vector<std::uint32_t>> rows;
  for (std::uint32_t row = 0; row < n; ++row) {
    std::vector<std::uint32_t> order;
    for (std::uint32_t place = 0; place < n; ++place) {
      // 0, 1, n-1, 2, n-2, ..., all turned by the row.
      const std::uint32_t base = place % 2 == 1 ? (place + 1) / 2 : (n - place / 2) % n;
      order.push_back((base + row) % n);
    }
    rows.push_back(std::move(order));
  }
  if (n % 2 == 1) {
    for (std::uint32_t row = 0; row < n; ++row)
      rows.emplace_back(rows[row].rbegin(), rows[row].rend());
  }
  return rows;
}

std::vector<std::uint32_t> methods_of(const StudyPlan& plan, std::uint32_t participant) {
  const auto count = static_cast<std::uint32_t>(plan.methods.size());
  std::vector<std::uint32_t> order(count);
  std::iota(order.begin(), order.end(), 0u);
  bool turned = participant % 2 == 0;
  switch (plan.run.order) {
    case OrderRule::fixed:
      return order;
    case OrderRule::williams: {
      const auto square = williams_square(count);
      return square[(participant - 1) % square.size()];
    }
    case OrderRule::halves:
      if (participant <= plan.counts.participants) turned = participant > (plan.counts.participants + 1) / 2;
      break;
    case OrderRule::alternate:
      break;
  }
  if (turned) std::ranges::reverse(order);
  return order;
}

std::vector<Step> order_of(const StudyPlan& plan, std::uint32_t participant) {
  std::vector<Step> steps;
  std::uint32_t round = 0;
  bool first = true;
  for (const std::uint32_t method : methods_of(plan, participant)) {
    for (std::uint32_t b = 0; b < plan.blocks.size(); ++b) {
      const PlanBlock& block = plan.blocks[b];
      if (block.once && !first) continue;
      const Step step{.round = round++, .block = b, .method = method};
      if (block.kind == BlockKind::rest || block.kind == BlockKind::free) {
        steps.push_back(step);
        if (block.kind == BlockKind::free) steps.back().shape = block.shapes.front();
        continue;
      }
      Random random = random_of(plan, participant, method, b);
      for (const std::uint32_t shape : touches_of(block, random)) {
        steps.push_back(step);
        steps.back().shape = shape;
      }
    }
    first = false;
  }
  return steps;
}

std::size_t count_steps(const StudyPlan& plan) {
  std::size_t steps = 0;
  for (const PlanBlock& block : plan.blocks) {
    std::size_t own = block.shapes.size() * block.repeats;
    if (block.kind == BlockKind::rest || block.kind == BlockKind::free) own = 1;
    steps += own * (block.once ? 1 : plan.methods.size());
  }
  return steps;
}

std::string order_csv(const StudyPlan& plan, const std::vector<Step>& steps) {
  std::string csv = "step,kind,method,shape\n";
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const Step& step = steps[i];
    // A free exploration begins with a shape, but the participant chooses.
    const bool named = step.shape && plan.blocks[step.block].kind != BlockKind::free;
    fmt::format_to(std::back_inserter(csv), "{},{},{},{}\n", i + 1, word_of(block_words, plan.blocks[step.block].kind),
                   csv_cell(plan.methods[step.method].name), named ? csv_cell(plan.shapes[*step.shape].name) : "");
  }
  return csv;
}

}  // namespace palpa::study
