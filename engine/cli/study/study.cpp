#include "cli/commands.hpp"
#include "cli/study/commands.hpp"

namespace palpa::cli {

void add_study(Program& program) {
  add_group(program, "study", "an experiment with people: can they tell the shapes apart?");
  add_study_analyse(program);
  add_study_compare(program);
  add_study_level(program);
  add_study_plan(program);
  add_study_power(program);
  add_study_rehearse(program);
  add_study_run(program);
  add_study_simulate(program);
  add_study_withdraw(program);
}

}  // namespace palpa::cli
