// Participants with too few trials, and void trials, as sentences of reports.
#pragma once

#include <string>
#include <vector>

#include "study/analysis.hpp"

namespace palpa::study {

/// Who is left out of the comparison of a pair, and why; what the comparison would be with those of them who used both
/// methods. Empty if nobody is left out.
std::vector<std::string> excluded_lines(const Analysis& analysis, const MethodPair& pair);

/// The void trials of a method by shape, such as "cube 2, pyramid 5". Empty if there are none.
std::string void_text(const Analysis& analysis, const MethodResult& method);

}  // namespace palpa::study
