// The plan of a study, with the files that it names.
#pragma once

#include <string>

#include "study/plan/plan.hpp"

namespace palpa::setup {

/// Reads a plan, and finds the models of palpa's own that it names ("palpa:cube.glb"), and the SHA-256 of all models.
/// Throws as study::read_plan and study::refuse_missing_files do.
study::StudyPlan load_plan(const std::string& file);

}  // namespace palpa::setup
