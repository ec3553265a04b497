// The confusion matrices in a JSON file of palpa study analyse or compare.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "study/tables/confusion.hpp"

namespace palpa::study {

/// The values of the key "kind" of such files.
inline constexpr const char* results_kind = "palpa study analyse";
inline constexpr const char* comparison_kind = "palpa study compare";

/// Names and tables in the order of the file: one table per method of a study, or those that were compared, of which a
/// table of counts is a single one. Appends what the analysis warned of to `left_out`. Throws bad_input if
/// the file is not such JSON.
std::vector<std::pair<std::string, Confusion>> read_results(const std::filesystem::path& file,
                                                            std::vector<std::string>& left_out);

}  // namespace palpa::study
