// The cases of a plan: their identifiers, and how they are divided among processes.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sweep/estimate.hpp"
#include "sweep/inputs.hpp"
#include "sweep/plan.hpp"
#include "sweep/shard.hpp"

namespace palpa::sweep {

struct Case {
  std::uint64_t index = 0;  ///< in the plan
  /// 20 hexadecimal digits: a digest of the command, its options, the contents of the files that they name, the kept
  /// results, and palpa's version and commit. It stays the same when the plan gets more values, another order or
  /// another name, and when files get other names.
  std::string id;
  Cost cost;
};

/// All cases in the plan's order. With `costs`, also what they cost.
std::vector<Case> list_cases(const Plan& plan, const Inputs& inputs, bool costs);

/// Throws bad_input if the command would refuse the options of every case, such as those of a plan without skin: with
/// the first case's message. Reads no file. Only the first ten thousand cases are looked at.
void refuse_hopeless(const Plan& plan);

/// The cases of a shard, the longest first; those that take equally long in the plan's order. Each case is in exactly
/// one shard, and all shards take about the same time.
std::vector<Case> deal(std::vector<Case> cases, const Shard& shard);

}  // namespace palpa::sweep
