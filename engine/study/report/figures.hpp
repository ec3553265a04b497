// The figures of a report, as SVG.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "study/analysis.hpp"
#include "study/power.hpp"
#include "study/tables/measures.hpp"

namespace palpa::study {

/// The accuracy of each participant with each method as bars, and the means with their standard deviations (the paper's
/// Fig. 8).
std::string accuracy_figure(const Analysis& analysis);

/// A confusion matrix: shares as shades, with their numbers.
std::string confusion_figure(const Measures& measures);

/// The mean accuracy in each block of trials.
std::string learning_figure(const Analysis& analysis);

/// The mean depth of the finger in a trial, one curve per shape.
std::string depth_figure(const Analysis& analysis, std::size_t method);

/// Accuracies with their intervals, one row per table.
std::string comparison_figure(const std::vector<Measures>& tables);

/// Power by number of participants, with its interval.
std::string power_figure(const PowerSetting& setting, const PowerResult& result);

}  // namespace palpa::study
