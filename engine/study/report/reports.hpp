// The reports of an analysis, of a comparison of tables, and of a simulation of power: for people as text and as a
// page, for programs as JSON and CSV. The same results give the same bytes.
#pragma once

#include <string>
#include <vector>

#include "study/analysis.hpp"
#include "study/comparison.hpp"
#include "study/power.hpp"

namespace palpa::study {

/// A few lines for a terminal.
std::string analysis_text(const Analysis& analysis);
/// Everything. `palpa study compare` reads the tables back (files/results_file.hpp).
std::string analysis_json(const Analysis& analysis);
/// One row per participant and method.
std::string analysis_csv(const Analysis& analysis);
/// A page with figures.
std::string analysis_html(const Analysis& analysis);

// One table alone has the same reports.

std::string comparison_text(const Comparison& comparison);
std::string comparison_json(const Comparison& comparison, const std::vector<std::string>& left_out);
/// One row per table.
std::string comparison_csv(const Comparison& comparison);
std::string comparison_html(const Comparison& comparison, const std::vector<std::string>& left_out);

std::string power_text(const PowerSetting& setting, const PowerResult& result,
                       const std::vector<OtherCorrelation>& others);
std::string power_json(const PowerSetting& setting, const PowerResult& result,
                       const std::vector<OtherCorrelation>& others);
/// One row per number of participants.
std::string power_csv(const PowerResult& result);
std::string power_html(const PowerSetting& setting, const PowerResult& result,
                       const std::vector<OtherCorrelation>& others);

}  // namespace palpa::study
