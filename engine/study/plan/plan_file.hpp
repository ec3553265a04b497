// Reads the plan of a study, PLAN.toml. docs/study.md lists its keys. Every fault is one line that names file, line and
// key, and what would be right.
#pragma once

#include <filesystem>
#include <string>

#include "study/plan/plan.hpp"

namespace palpa::study {

/// Throws bad_input naming file, line and key. Models and layouts are not opened.
StudyPlan read_plan(const std::filesystem::path& file);
StudyPlan parse_plan(const std::string& text, const std::string& name);

/// For the simulation. Throws bad_input if the plan has no [fit].
void refuse_without_fit(const StudyPlan& plan);

/// Throws bad_input naming the plan if a model, a layout or the masking sound that it names is not there; bad_usage if
/// one of them is a declared output.
void refuse_missing_files(const StudyPlan& plan);

}  // namespace palpa::study
