// A confusion matrix as CSV: the answers in the first line, then one line per actual shape with its counts.
//
//   actual,cube,semi-sphere,pyramid,prism
//   cube,50,30,9,11
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "study/tables/confusion.hpp"

namespace palpa::study {

struct CountsFile {
  Confusion table;
  std::vector<std::string> warnings{};  ///< one line each
};

/// Cells are separated by commas, semicolons or tabs, or by what a first line such as "sep=;" says. Empty cells at the
/// end of a line are no cells. The rows may have another order than the columns. A row or column of sums is left out,
/// and a warning names it. Throws bad_input, naming the line, if anything else is not a count, and if rows and columns
/// do not have the same names.
CountsFile parse_counts(std::string_view text, const std::string& name);
CountsFile read_counts(const std::filesystem::path& file);

}  // namespace palpa::study
