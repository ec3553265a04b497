// The plan of a study, with the files that it names.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/math.hpp"
#include "geometry/gltf/gltf.hpp"
#include "study/plan/plan.hpp"

namespace palpa::setup {

/// Reads a plan, and finds the models of palpa's own that it names ("palpa:cube.glb"), the SHA-256 of all models,
/// and whether they may ask for a pressure. Warns of study::doubts_of(). Throws bad_usage without a file, otherwise as
/// study::read_plan and study::refuse_missing_files do.
study::StudyPlan load_plan(const std::string& file);

/// The least of what the scene's objects ask for.
struct LeastSound {
  double intensity = 1;                 ///< of a spring, times the root of its largest force
  bool is_spring = false;               ///< the object with that intensity
  std::optional<double> pressure_pa{};  ///< empty: no object requests a pressure
};
/// Depths are those from 0 to `deep_m`.
LeastSound least_sound(const geometry::Scene& scene, double deep_m);
void set_least(study::PlanShape& shape, const LeastSound& least);

/// Reads the models and the masking sound of a plan, as a sitting will. Fills the shapes' intensities. Returns the box
/// around each shape's model (geometry::box_of). Throws bad_input for a model that is no scene with a solid, and for a
/// sound that is no WAV file.
std::vector<Box> try_files(study::StudyPlan& plan);

}  // namespace palpa::setup
