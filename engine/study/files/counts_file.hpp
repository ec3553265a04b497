// A confusion matrix as CSV: the answers in the first line, then one line per actual shape with its counts.
//
//   actual,cube,semi-sphere,pyramid,prism
//   cube,50,30,9,11
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "study/tables/confusion.hpp"

namespace palpa::study {

struct CountsFile {
  Confusion table;
  std::string warning{};  ///< one line; empty if there is nothing to warn of
};

/// Cells are separated by commas, semicolons or tabs. The rows may have another order than the columns. Throws
/// bad_input, naming the line, if anything is not a count, and if rows and columns do not have the same names.
CountsFile parse_counts(std::string_view text, const std::string& name);
CountsFile read_counts(const std::filesystem::path& file);

}  // namespace palpa::study
