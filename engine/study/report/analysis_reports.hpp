// The reports of an analysis: for people as text and as a page, for programs as JSON and CSV. The same analysis gives
// the same bytes.
#pragma once

#include <string>

#include "study/analysis.hpp"

namespace palpa::study {

/// A few lines for a terminal.
std::string analysis_text(const Analysis& analysis);
/// Everything. `palpa study compare` reads the tables back (files/results_file.hpp).
std::string analysis_json(const Analysis& analysis);
/// One row per participant and method.
std::string analysis_csv(const Analysis& analysis);
/// A page with figures.
std::string analysis_html(const Analysis& analysis);

}  // namespace palpa::study
