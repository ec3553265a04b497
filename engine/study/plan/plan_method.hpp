// How the foci of a touch are made and played: one method of a study.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "array/amplitudes.hpp"
#include "array/drive_options.hpp"
#include "touch/methods/method.hpp"

namespace palpa::study {

/// The defaults are palpa's.
struct PlanMethod {
  std::string name;
  touch::Method method = touch::Method::cross_section;
  std::uint32_t foci = 10;
  std::optional<std::uint32_t> stride;
  double dwell_s = 1.5e-3, modulation_hz = 200, delta_m = 1.5e-3;
  std::string layout = "paper";  ///< built-in name, or a file; a plan's is resolved from its folder
  bool layout_given = false;     ///< by the plan; otherwise, a run takes that of its array
  /// How drives are computed, as --amplitude, --solver and --constraint say it. Without, as a run does.
  std::optional<array::Weighting> amplitude;
  std::optional<array::Solver> solver;
  std::optional<array::Constraint> constraint;
};

}  // namespace palpa::study
