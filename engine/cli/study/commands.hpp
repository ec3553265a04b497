// The subcommands of `palpa study`. To add one, declare it here and add it in study.cpp.
#pragma once

#include "cli/command.hpp"

namespace palpa::cli {

void add_study_analyse(Program& program);
void add_study_compare(Program& program);
void add_study_level(Program& program);
void add_study_plan(Program& program);
void add_study_power(Program& program);
void add_study_rehearse(Program& program);
void add_study_run(Program& program);
void add_study_simulate(Program& program);
void add_study_withdraw(Program& program);

}  // namespace palpa::cli
