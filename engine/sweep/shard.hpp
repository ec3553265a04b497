// Which shard of a sweep a process computes.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

namespace palpa::sweep {

/// Shard `index` of `count` shards, counted from 0.
struct Shard {
  std::uint32_t index = 0, count = 1;
  bool operator==(const Shard&) const = default;
};

/// A variable of the environment; nullopt if it is not set.
using Environment = std::function<std::optional<std::string>(const std::string& name)>;
/// The process's own.
std::optional<std::string> environment(const std::string& name);

/// "2/8" is the third of eight shards. "env" takes the shard from the variables of a scheduler, the first of:
///   SLURM_ARRAY_TASK_ID minus SLURM_ARRAY_TASK_MIN, of SLURM_ARRAY_TASK_COUNT    a job array, with the step 1
///   OMPI_COMM_WORLD_RANK of OMPI_COMM_WORLD_SIZE                                   OpenMPI's mpirun
///   PMI_RANK of PMI_SIZE                                                           mpirun of MPICH and others
///   SLURM_PROCID of SLURM_STEP_NUM_TASKS                                           srun
/// Throws bad_usage for anything else: no such variable, an array with another step, an array whose tasks start several
/// processes each, a Slurm job of several tasks that was not started by srun.
Shard parse_shard(const std::string& text, const Environment& variable = environment);

}  // namespace palpa::sweep
