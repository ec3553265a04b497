#include <gtest/gtest.h>

#include <map>
#include <string>

#include "base/error.hpp"
#include "support/thrown.hpp"
#include "sweep/shard.hpp"

namespace palpa::sweep {
namespace {

using Variables = std::map<std::string, std::string>;

Shard env(const Variables& variables) {
  return parse_shard("env", [&](const std::string& name) -> std::optional<std::string> {
    const auto found = variables.find(name);
    if (found == variables.end()) return std::nullopt;
    return found->second;
  });
}

std::string fault_of(const Variables& variables) {
  try {
    env(variables);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Exit::usage);
    return error.what();
  }
  return "none";
}

Variables array(const char* id, const char* least, const char* most, const char* count) {
  return {{"SLURM_ARRAY_TASK_ID", id},
          {"SLURM_ARRAY_TASK_MIN", least},
          {"SLURM_ARRAY_TASK_MAX", most},
          {"SLURM_ARRAY_TASK_COUNT", count}};
}

TEST(SweepShard, APartIsCountedFromZero) {
  EXPECT_EQ(parse_shard("0/1"), (Shard{0, 1}));
  EXPECT_EQ(parse_shard("6/7"), (Shard{6, 7}));
  for (const char* wrong :
       {"7/7", "1/0", "1", "/2", "1/", "-1/2", "1/2/3", "a/b", "0x1/2", "1.0/2", "0/9999999", " 0/1"})
    EXPECT_ERROR(parse_shard(wrong), Exit::usage, std::string("'") + wrong + "' is not a shard i/n");
}

TEST(SweepShard, SchedulersSayWhichPart) {
  EXPECT_EQ(env(array("5", "5", "8", "4")), (Shard{0, 4}));
  EXPECT_EQ(env(array("8", "5", "8", "4")), (Shard{3, 4}));
  EXPECT_EQ(env({{"OMPI_COMM_WORLD_RANK", "1"}, {"OMPI_COMM_WORLD_SIZE", "2"}, {"SLURM_PROCID", "0"}}), (Shard{1, 2}));
  EXPECT_EQ(env({{"PMI_RANK", "2"}, {"PMI_SIZE", "3"}}), (Shard{2, 3}));
  EXPECT_EQ(env({{"SLURM_PROCID", "1"}, {"SLURM_STEP_NUM_TASKS", "4"}, {"SLURM_NTASKS", "8"}}), (Shard{1, 4}));
  EXPECT_EQ(env({{"SLURM_PROCID", "0"}, {"SLURM_NTASKS", "1"}}), (Shard{0, 1}));
}

TEST(SweepShard, WhatWouldLeaveCasesOutIsRefused) {
  EXPECT_NE(fault_of({}).find("none of SLURM_ARRAY_TASK_ID"), std::string::npos);
  EXPECT_NE(fault_of(array("4", "0", "8", "3")).find("give it the step 1 and no gaps, such as --array=0-2"),
            std::string::npos);
  EXPECT_NE(fault_of({{"SLURM_ARRAY_TASK_ID", "1"}}).find("SLURM_ARRAY_TASK_MIN is not set"), std::string::npos);
  Variables several = array("0", "0", "1", "2");
  several["SLURM_STEP_NUM_TASKS"] = "2";
  EXPECT_NE(fault_of(several).find("would compute every case 2 times"), std::string::npos);
  EXPECT_NE(fault_of({{"SLURM_PROCID", "0"}, {"SLURM_NTASKS", "4"}}).find("use srun palpa sweep"), std::string::npos);
  EXPECT_NE(fault_of({{"PMI_RANK", "2"}, {"PMI_SIZE", "two"}}).find("PMI_SIZE is 'two', not a whole number"),
            std::string::npos);
  EXPECT_NE(fault_of({{"PMI_RANK", "2"}, {"PMI_SIZE", "2"}}).find("PMI_RANK is 2 and PMI_SIZE is 2"),
            std::string::npos);
}

}  // namespace
}  // namespace palpa::sweep
