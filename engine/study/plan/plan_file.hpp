// Reads the plan of a study, PLAN.toml. docs/study.md lists its keys. Every fault is one line that names file, line and
// key, and what would be right.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "study/plan/plan.hpp"

namespace palpa::study {

/// Throws bad_input naming file, line and key. Models and layouts are not opened.
StudyPlan read_plan(const std::filesystem::path& file);
StudyPlan parse_plan(const std::string& text, const std::string& name);

/// What the name of a model begins with that is one of palpa's own, wherever the plan lies: "palpa:cube.glb". The plan
/// keeps this name. setup::load_plan() knows the file.
inline constexpr std::string_view own_model_prefix = "palpa:";
inline bool is_own_model(std::string_view model) {
  return model.starts_with(own_model_prefix);
}

/// For the simulation. Throws bad_input if the plan has no [fit].
void refuse_without_fit(const StudyPlan& plan);

/// Throws bad_input naming the plan if a model, a layout or the masking sound that it names is not there; bad_usage if
/// one of them is a declared output.
void refuse_missing_files(const StudyPlan& plan);

}  // namespace palpa::study
