#include "setup/study_plan.hpp"

#include <fmt/core.h>

#include "base/error.hpp"
#include "base/input_file.hpp"
#include "base/sha256.hpp"
#include "base/text.hpp"
#include "setup/assets.hpp"
#include "study/plan/plan_file.hpp"

namespace palpa::setup {

study::StudyPlan load_plan(const std::string& file) {
  study::StudyPlan plan = study::read_plan(file);
  for (study::PlanShape& shape : plan.shapes) {
    if (!study::is_own_model(shape.model)) continue;
    const std::string own = shape.model.substr(study::own_model_prefix.size());
    try {
      shape.model = find_asset(own);
    } catch (const Error& error) {
      throw bad_input(plan.file, fmt::format("the model of '{}' is {}, but {}", printable(shape.name),
                                             printable(shape.model), error.what()));
    }
  }
  study::refuse_missing_files(plan);
  for (study::PlanShape& shape : plan.shapes)
    shape.model_sha256 = sha256_of_file(shape.model).sha256;
  return plan;
}

}  // namespace palpa::setup
