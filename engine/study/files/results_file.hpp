// The confusion matrices in a JSON file of palpa study analyse.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "study/tables/confusion.hpp"

namespace palpa::study {

/// The value of the key "kind" of such a file.
inline constexpr const char* results_kind = "palpa study analyse";

/// Names and tables in the order of the file. Appends what the analysis warned of to `left_out`. Throws bad_input if
/// the file is not such JSON.
std::vector<std::pair<std::string, Confusion>> read_results(const std::filesystem::path& file,
                                                            std::vector<std::string>& left_out);

}  // namespace palpa::study
