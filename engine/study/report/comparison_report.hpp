// The reports of a comparison of tables. One table alone has the same reports.
#pragma once

#include <string>
#include <vector>

#include "study/comparison.hpp"

namespace palpa::study {

std::string comparison_text(const Comparison& comparison);
std::string comparison_json(const Comparison& comparison, const std::vector<std::string>& left_out);
/// One row per table.
std::string comparison_csv(const Comparison& comparison);
std::string comparison_html(const Comparison& comparison, const std::vector<std::string>& left_out);

}  // namespace palpa::study
