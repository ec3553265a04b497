// Participants with too few trials, as sentences of reports.
#pragma once

#include <string>

#include "study/analysis.hpp"

namespace palpa::study {

/// Who is left out of the comparison of a pair, and why; empty if nobody is.
std::string excluded_line(const Analysis& analysis, const MethodPair& pair);
/// What the comparison would be with them; empty if nobody is left out.
std::string with_excluded_line(const MethodPair& pair);

}  // namespace palpa::study
