// The plan of a study, PLAN.toml (docs/files.md): shapes, methods, counts, and what the ideal observer needs.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "study/files/plan_method.hpp"

namespace palpa::study {

struct PlanShape {
  std::string name;
  std::string model;  ///< file, relative names resolved from the plan's folder
};

/// [study]
struct PlanCounts {
  std::uint32_t participants = 10, trials_per_shape = 10;
  double touch_s = 10;
};

/// [observer]
struct PlanObserver {
  std::vector<double> depths_m{1e-3, 3e-3, 5e-3, 7.5e-3, 10.5e-3, 14e-3};  ///< ascending
  std::uint32_t placements = 12;
  double lateral_m = 2e-3, yaw_rad = 0.261799387799149;  ///< standard deviations
  double crest_n = 16e-3;  ///< force of the single focus on the cube at 3 mm, at its crest
  std::vector<double> other_crests_n{5e-3, 50e-3};
};

/// [fit]: the one measured number.
struct PlanFit {
  std::size_t method = 0;  ///< index into the methods
  double accuracy = 0;
  std::uint32_t trials = 0;
};

struct StudyPlan {
  std::string file, title;
  std::vector<PlanShape> shapes;
  std::vector<PlanMethod> methods;     ///< those of the study
  std::vector<PlanMethod> candidates;  ///< [[candidate]]: only ranked
  PlanCounts counts;
  PlanObserver observer;
  PlanFit fit;

  std::size_t touches() const {
    return (methods.size() + candidates.size()) * shapes.size() * observer.depths_m.size() * observer.placements;
  }
};

/// The most touches of a plan: a few hours of computation.
inline constexpr std::size_t most_planned_touches = 50'000;

/// Throws bad_input naming file, line and key. Models and layouts are not opened.
StudyPlan read_plan(const std::filesystem::path& file);
StudyPlan parse_plan(const std::string& text, const std::string& name);

}  // namespace palpa::study
