// The tables of PLAN.toml, one function each.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/files/toml.hpp"
#include "study/plan/plan.hpp"

namespace palpa::study {

/// A file that the plan names, from the plan's folder.
std::string next_to(const std::string& plan, const std::string& file);
/// `name`: a name that reports, logs and tables can hold.
std::string name_of(TomlTable& table);

PlanMethod method_of(TomlTable& table, const std::string& plan);
PlanObserver observer_of(TomlTable& table);
/// What `least_trials` is if the plan does not have it.
inline constexpr std::uint32_t unset_least_trials = ~std::uint32_t{0};
PlanCounts counts_of(TomlTable& table);
PlanFit fit_of(TomlTable& table, const StudyPlan& plan);
PlanRun run_of(TomlTable& table, const StudyPlan& plan);
PlanLevel level_of(TomlTable& table);
/// `plan` has its shapes and counts.
PlanBlock block_of(TomlTable& table, const StudyPlan& plan);
/// The paper's blocks (section IV-C) with the plan's counts: each shape seen and felt, 3 minutes of free touch, one
/// practice, the trials.
std::vector<PlanBlock> default_blocks(const StudyPlan& plan);
/// [texts.LANGUAGE] of each language into the plan.
void texts_of(TomlTable& table, StudyPlan& plan);

}  // namespace palpa::study
