// Computes the cases of a sweep, or a shard of them, into a folder of results (store.hpp). Several processes on one or
// several machines may do so at the same time.
//
//   sweep::Plan plan = sweep::load_plan("plan.toml");
//   sweep::run_sweep(plan, {.out = "results", .shard = {0, 4}});
//   for (const sweep::Row& row : sweep::table_of(plan, "results").rows) ...    (gather.hpp)
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "setup/options.hpp"
#include "sweep/plan.hpp"
#include "sweep/shard.hpp"
#include "sweep/store.hpp"

namespace palpa::sweep {

struct SweepTask {
  std::string out;   ///< the folder
  Shard shard = {};  ///< to compute; the whole plan by default
  /// Instead of a shard: computes whatever no other process with `claim` computes, until nothing is left. Needs a file
  /// system with locks.
  bool claim = false;
  setup::ComputeOptions compute = {};  ///< its seed is not used: cases have their own
  /// If given: the sweep ends soon after it became true. The case that is computed at that time gets no line.
  const std::atomic<bool>* stop = nullptr;
};

struct SweepReport {
  std::uint64_t cases = 0;                          ///< of the plan
  std::uint64_t mine = 0;                           ///< of the shard
  std::uint64_t before = 0;                         ///< of the shard, that had results before
  std::uint64_t done = 0, refused = 0, failed = 0;  ///< computed now, by their ends
  std::uint64_t elsewhere = 0;                      ///< that another process computes at the moment
  /// Every case of the plan that the folder knows was refused: all of the plan, or some whose options fit together.
  bool all_in_vain = false;
  std::string first_fault;       ///< a case that was refused or failed, and why
  std::vector<std::string> ids;  ///< of the shard's cases
  double seconds = 0;
};

/// Called after each case, when its line is in the file. False ends the sweep.
using AfterCase = std::function<bool(const CaseLine& line, std::uint64_t number, std::uint64_t of)>;

/// Computes the cases that have no result yet, the longest first; failed ones of earlier runs last. Continues where an
/// earlier run ended, however it ended. A case that is refused or fails does not end the sweep. Throws bad_input for
/// missing files, or options that are refused in every case, before anything is computed; bad_usage for a folder with
/// results of another version; failure() if a result cannot be written; as gpu::Device does if there is no device, or
/// if it is lost.
SweepReport run_sweep(const Plan& plan, const SweepTask& task, const AfterCase& after = {});

}  // namespace palpa::sweep
